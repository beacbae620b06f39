#include "tests/trust/suite_config.hpp"

#include <algorithm>
#include <stdexcept>
#include <stdlib.h>

#include <fmt/format.h>

namespace reident::trust {

Config suite_config() {
  constexpr Duration second = 1'000'000'000;
  const std::filesystem::path path = REIDENT_TRUST_CONFIG;
  auto loaded = load_config(path);
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&loaded))
    throw std::runtime_error(
        fmt::format("{}:{}: {}", path.string(), mistakes->front().line, mistakes->front().message));
  Config config = std::get<Config>(std::move(loaded));
  config.durability = storage::Durability::kill;  // the databases are thrown away
  for (EquipmentConfig& equipment : config.spacecraft.front().equipment) {
    equipment.sample_period = suite_period;
    equipment.hold = std::max(equipment.hold, 3 * suite_period);
    equipment.window = 48'000 * second;
    equipment.slide = 18'000 * second;
    equipment.min_interval = equipment.slide / 4;
    equipment.validation_share = 0.4;
    equipment.max_order = 6;
  }
  return config;
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
