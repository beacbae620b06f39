// The configuration that a command works with.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "service/cli/command.hpp"
#include "service/daemon/config.hpp"

namespace reident::cli {

inline constexpr const char* default_config_file = "reident.toml";

/// The configuration in `file`, by default reident.toml of the current folder; nullopt where there
/// is none of that name and none was asked for.
std::variant<std::optional<Config>, Refusal> chosen_config(const std::optional<std::string>& file);

/// "FILE:LINE: what", or "FILE: what" of the file as a whole.
std::string mistake_text(const std::string& file, const ConfigMistake& mistake);

}  // namespace reident::cli
