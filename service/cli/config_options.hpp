// The configuration that a command works with.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "service/cli/command.hpp"
#include "service/config/config.hpp"
#include "service/dds/dds.hpp"

namespace reident::cli {

inline constexpr const char* default_config_file = "reident.toml";

/// The configuration in `file`, by default reident.toml of the current folder; nullopt where there
/// is none of that name and none was asked for.
std::variant<std::optional<Config>, Refusal> chosen_config(const std::optional<std::string>& file);

/// Where a console listens: what is named here comes before the configuration, and without either
/// it is the default.
std::variant<dds::Endpoint, Refusal> chosen_endpoint(const std::optional<std::string>& file,
                                                     std::optional<std::uint32_t> domain,
                                                     const std::optional<std::string>& partition);

/// Where the service of a configuration is. The files of security are the caller's own
/// (reident --security, REIDENT_SECURITY), or else those that the configuration names.
dds::Endpoint endpoint_of(const Config& config);

/// What to do where Participant::misses_security().
Refusal missing_security(const dds::Endpoint& endpoint);

/// What is wrong with the files of the service's security, such as a certificate that has ended.
/// Empty where nothing is, and where they are another user's alone.
std::string mistake_of_security(const Config& config);

/// The end of an error where no service was heard on a secured domain: mistake_of_security() of the
/// configuration in `file`, or else where to look. Empty on a plain domain.
std::string why_unheard(const dds::Endpoint& endpoint, const std::optional<std::string>& file);

/// "FILE:LINE: what", or "FILE: what" of the file as a whole.
std::string mistake_text(const std::string& file, const ConfigMistake& mistake);

}  // namespace reident::cli
