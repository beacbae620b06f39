#include "tests/trust/suite_config.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "service/config/config_document.hpp"
#include "service/support/time_text.hpp"

namespace reident::trust {
namespace {

std::string read_text(const char* path) {
  std::ostringstream text;
  if (!(text << std::ifstream(path).rdbuf()))
    throw std::runtime_error(fmt::format("{}: cannot be read", path));
  return text.str();
}

const char* path_of(satcs::Family family) {
  return family == satcs::Family::power ? REIDENT_TRUST_CONFIG : REIDENT_TRUST_PLATFORM_CONFIG;
}

void change(toml::table& equipment, satcs::Family family) {
  equipment.insert_or_assign(
      "sample_period",
      duration_text(family == satcs::Family::power ? suite_period : platform_period));
  equipment.insert_or_assign("window", duration_text(48'000 * storage::second_ns));
  equipment.insert_or_assign("slide", duration_text(18'000 * storage::second_ns));
  equipment.insert_or_assign("validation_share", 0.4);
  equipment.insert_or_assign("order", toml::array{1, 6});
}

}  // namespace

std::string suite_toml(const std::vector<std::string>& equipment, satcs::Family family,
                       const std::string& keys) {
  ConfigDocument document = parse_document(read_text(path_of(family)));
  toml::array* all = document.table["spacecraft"][0]["equipment"].as_array();
  if (!all)
    throw std::runtime_error(fmt::format("{}: has no [[spacecraft.equipment]]", path_of(family)));
  document.table["archive"].as_table()->insert_or_assign("database", "reference.db");
  const toml::parse_result set = toml::parse(keys);
  if (!set) throw std::runtime_error(fmt::format("{}: {}", keys, set.error().description()));
  toml::array chosen;
  for (toml::node& node : *all) {
    toml::table& one = *node.as_table();
    const std::string name = one["name"].value_or("");
    if (!equipment.empty() &&
        std::find(equipment.begin(), equipment.end(), name) == equipment.end())
      continue;
    change(one, family);
    for (const auto& [key, value] : set.table()) one.insert_or_assign(key, value);
    chosen.push_back(one);
  }
  *all = std::move(chosen);
  std::ostringstream text;
  text << document.table << '\n';
  return text.str();
}

Config suite_config(satcs::Family family, const std::string& keys) {
  auto parsed = parse_config(suite_toml({}, family, keys), {});
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&parsed))
    throw std::runtime_error(fmt::format("{}: {}", path_of(family), mistakes->front().message));
  Config config = std::get<Config>(std::move(parsed));
  config.durability = storage::Durability::kill;
  config.recent_samples = 20'000;
  return config;
}

}  // namespace reident::trust
