// Any text is either a configuration that keeps its own rules, or mistakes with lines of the text.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "service/config/config.hpp"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

bool keeps_its_rules(const reident::EquipmentConfig& equipment) {
  return !equipment.name.empty() && !equipment.inputs.empty() && !equipment.outputs.empty() &&
         equipment.sample_period > 0 && equipment.sample_hold >= equipment.sample_period &&
         equipment.window >= equipment.sample_period && equipment.slide > 0 &&
         equipment.slide <= equipment.window && equipment.slide % equipment.sample_period == 0 &&
         equipment.min_order >= 1 && equipment.min_order <= equipment.max_order;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto parsed = reident::parse_config(text, "/folder");
  if (const auto* config = std::get_if<reident::Config>(&parsed)) {
    require(config->digest.size() == 64 && config->database.is_absolute());
    for (const reident::SpacecraftConfig& spacecraft : config->spacecraft)
      require(
          std::all_of(spacecraft.equipment.begin(), spacecraft.equipment.end(), keeps_its_rules));
    return 0;
  }
  const auto& mistakes = std::get<std::vector<reident::ConfigMistake>>(parsed);
  require(!mistakes.empty());
  const auto lines = static_cast<std::uint32_t>(std::count(text.begin(), text.end(), '\n')) + 1;
  for (const reident::ConfigMistake& mistake : mistakes)
    require(!mistake.message.empty() && mistake.line <= lines);
  return 0;
}
