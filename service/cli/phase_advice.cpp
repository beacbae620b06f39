#include "service/cli/phase_advice.hpp"

#include "service/windows/ticks.hpp"
#include "storage/archive/archive.hpp"

namespace reident::cli {

std::vector<std::string> advised_phases(storage::Database& database, const Config& config,
                                        const std::string& spacecraft,
                                        const std::string& equipment) {
  const storage::Archive archive(database);
  const storage::Registry registry(database);
  std::vector<std::string> sentences;
  for (const SpacecraftConfig& craft : config.spacecraft) {
    if (!spacecraft.empty() && spacecraft != craft.name) continue;
    const auto extent = archive.extent(craft.name, storage::Origin::real);
    if (!extent) continue;
    for (const EquipmentConfig& one : craft.equipment) {
      if (!equipment.empty() && equipment != one.name) continue;
      if (auto sentence = advised_phase(archive, registry, craft.name, one, extent->end))
        sentences.push_back(*std::move(sentence));
    }
  }
  return sentences;
}

}  // namespace reident::cli
