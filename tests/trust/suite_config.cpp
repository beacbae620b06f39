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

void change(toml::table& equipment) {
  equipment.insert_or_assign("sample_period", duration_text(suite_period));
  equipment.insert_or_assign("window", duration_text(48'000 * storage::second_ns));
  equipment.insert_or_assign("slide", duration_text(18'000 * storage::second_ns));
  equipment.insert_or_assign("validation_share", 0.4);
  equipment.insert_or_assign("order", toml::array{1, 6});
}

}  // namespace

std::string suite_toml(const std::vector<std::string>& equipment) {
  ConfigDocument document = parse_document(read_text(REIDENT_TRUST_CONFIG));
  toml::array* all = document.table["spacecraft"][0]["equipment"].as_array();
  if (!all) throw std::runtime_error(REIDENT_TRUST_CONFIG ": has no [[spacecraft.equipment]]");
  toml::array chosen;
  for (toml::node& node : *all) {
    toml::table& one = *node.as_table();
    const std::string name = one["name"].value_or("");
    if (!equipment.empty() &&
        std::find(equipment.begin(), equipment.end(), name) == equipment.end())
      continue;
    change(one);
    chosen.push_back(one);
  }
  *all = std::move(chosen);
  std::ostringstream text;
  text << document.table << '\n';
  return text.str();
}

Config suite_config() {
  auto parsed = parse_config(suite_toml(), {});
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&parsed))
    throw std::runtime_error(
        fmt::format("{}: {}", REIDENT_TRUST_CONFIG, mistakes->front().message));
  Config config = std::get<Config>(std::move(parsed));
  config.durability = storage::Durability::kill;
  config.recent_samples = 20'000;
  return config;
}

}  // namespace reident::trust
