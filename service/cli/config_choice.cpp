#include "service/cli/config_choice.hpp"

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
  return Refusal{fmt::format("{}:{}: {}; reident check-config {} lists every mistake", path,
                             mistakes.front().line, mistakes.front().message, path)};
}

}  // namespace reident::cli
