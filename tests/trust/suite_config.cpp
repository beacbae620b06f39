#include "tests/trust/suite_config.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

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
  config.recent_samples = 20'000;
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

}  // namespace reident::trust
