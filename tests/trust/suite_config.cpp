#include "tests/trust/suite_config.hpp"

#include <stdexcept>
#include <stdlib.h>

#include <fmt/format.h>

namespace reident::trust {

Config suite_config() {
  const std::filesystem::path path = REIDENT_TRUST_CONFIG;
  auto loaded = load_config(path);
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&loaded))
    throw std::runtime_error(
        fmt::format("{}:{}: {}", path.string(), mistakes->front().line, mistakes->front().message));
  return std::get<Config>(std::move(loaded));
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "reident-trust-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("cannot make a folder at " + name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace reident::trust
