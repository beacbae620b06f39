#include "service/cli/config_options.hpp"

#include <filesystem>

#include <fmt/format.h>

namespace reident::cli {

std::variant<std::optional<Config>, Refusal> chosen_config(const std::optional<std::string>& file) {
  const std::string path = file.value_or(default_config_file);
  std::error_code error;
  if (!file && !std::filesystem::exists(path, error)) return std::nullopt;
  auto loaded = load_config(path);
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
  if (const auto& config = std::get<std::optional<Config>>(chosen))
    endpoint = {config->domain, config->partition};
  endpoint.domain = domain.value_or(endpoint.domain);
  endpoint.partition = partition.value_or(endpoint.partition);
  return endpoint;
}

std::string mistake_text(const std::string& file, const ConfigMistake& mistake) {
  return mistake.line == 0 ? fmt::format("{}: {}", file, mistake.message)
                           : fmt::format("{}:{}: {}", file, mistake.line, mistake.message);
}

}  // namespace reident::cli
