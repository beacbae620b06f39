#include "service/cli/config_options.hpp"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <unistd.h>

#include <fmt/format.h>

#include "service/security/material.hpp"
#include "service/support/utc_clock.hpp"

namespace reident::cli {
namespace {

/// A service with ports of its own is found by its clients alone: `reident fleet init` has put what
/// makes one beside its configuration. CYCLONEDDS_URI comes first where it is set.
void join_as_client_of(const std::filesystem::path& configuration) {
  std::error_code error;
  const std::filesystem::path file = std::filesystem::absolute(configuration, error).parent_path() /
                                     "cyclonedds" /
                                     (configuration.stem().string() + "-clients.xml");
  if (!error && std::filesystem::exists(file, error))
    ::setenv("CYCLONEDDS_URI", ("file://" + file.string()).c_str(), 0);
}

}  // namespace

std::variant<std::optional<Config>, Refusal> chosen_config(const std::optional<std::string>& file) {
  const std::string path = file.value_or(default_config_file);
  std::error_code error;
  if (!file && !std::filesystem::exists(path, error)) return std::nullopt;
  auto loaded = load_config(path);
  join_as_client_of(path);
  if (auto* config = std::get_if<Config>(&loaded)) return std::move(*config);
  const auto& mistakes = std::get<std::vector<ConfigMistake>>(loaded);
  std::string text = mistake_text(path, mistakes.front());
  if (mistakes.size() > 1)
    text += fmt::format("; reident check-config {} lists {} mistakes", path, mistakes.size());
  return Refusal{text};
}

std::variant<dds::Endpoint, Refusal> chosen_endpoint(const std::optional<std::string>& file,
                                                     std::optional<std::uint32_t> domain,
                                                     const std::optional<std::string>& partition) {
  auto chosen = chosen_config(file);
  if (auto* refusal = std::get_if<Refusal>(&chosen)) return *refusal;
  dds::Endpoint endpoint;
  endpoint.security = security::folder_of_environment();
  if (const auto& config = std::get<std::optional<Config>>(chosen)) endpoint = endpoint_of(*config);
  endpoint.domain = domain.value_or(endpoint.domain);
  endpoint.partition = partition.value_or(endpoint.partition);
  return endpoint;
}

dds::Endpoint endpoint_of(const Config& config) {
  const std::filesystem::path own = security::folder_of_environment();
  return {config.domain, config.partition, own.empty() ? config.security : own};
}

Refusal missing_security(const dds::Endpoint& endpoint) {
  return {fmt::format(
      "domain {} is secured, and this command has no certificate: nothing can be heard; name its "
      "folder with --security FOLDER or REIDENT_SECURITY ('reident security grant' makes one)",
      endpoint.domain)};
}

std::string mistake_of_security(const Config& config) {
  if (config.security.empty()) return {};
  const std::filesystem::path key = config.security / security::file::key;
  if (::access(key.c_str(), R_OK) != 0 && errno == EACCES) return {};
  const auto read = security::read_material(config.security, utc_now());
  const auto* mistakes = std::get_if<std::vector<std::string>>(&read);
  return mistakes ? mistakes->front() : std::string();
}

std::string why_unheard(const dds::Endpoint& endpoint, const std::optional<std::string>& file) {
  if (endpoint.security.empty()) return {};
  const auto chosen = chosen_config(file);
  const auto* config = std::get_if<std::optional<Config>>(&chosen);
  const std::string mistake = config && *config ? mistake_of_security(**config) : std::string();
  if (!mistake.empty()) return "; the service's own files are wrong: " + mistake;
  return "; one whose certificate has ended or was revoked is not heard either: 'reident security "
         "check' of the service's folder says so";
}

std::string mistake_text(const std::string& file, const ConfigMistake& mistake) {
  return mistake.line == 0 ? fmt::format("{}: {}", file, mistake.message)
                           : fmt::format("{}:{}: {}", file, mistake.line, mistake.message);
}

}  // namespace reident::cli
