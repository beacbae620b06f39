#include "service/review/stored_version.hpp"

#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "service/model/model_json.hpp"
#include "storage/types/error.hpp"

namespace reident {

std::optional<StoredVersion> stored_version(const history::HistoryReader& history,
                                            const storage::EquipmentName& equipment,
                                            std::int64_t number) {
  auto version = history.version(equipment, number);
  if (!version) return std::nullopt;
  StoredVersion story;
  auto attempt = history.attempt(equipment, number);
  if (!attempt)
    throw storage::Error(storage::Error::Kind::corrupt,
                         "version " + std::to_string(number) + " of " + equipment.spacecraft + "/" +
                             equipment.equipment +
                             " has lost its attempt: the registry is damaged; 'reident verify' "
                             "lists all damage, restore a backup");
  story.attempt = *std::move(attempt);
  story.decisions = history.decisions(equipment, number);
  story.hold = history.hold(equipment);
  story.model = equipment_model_from_json(version->model_json);
  story.digest_matches = model_digest(story.model) == version->digest;
  story.version = *std::move(version);
  return story;
}

std::optional<storage::TimeRange> tuned_on(const storage::Version& version) {
  const nlohmann::ordered_json provenance =
      nlohmann::ordered_json::parse(version.provenance_json, nullptr, false);
  const nlohmann::ordered_json::json_pointer tune("/parts/tune");
  if (!provenance.is_object() || !provenance.contains(tune)) return std::nullopt;
  const nlohmann::ordered_json& part = provenance[tune];
  const auto begin = part.find("begin_ns"), end = part.find("end_ns");
  if (begin == part.end() || end == part.end() || !begin->is_number_integer() ||
      !end->is_number_integer())
    return std::nullopt;
  return storage::TimeRange{begin->get<storage::Time>(), end->get<storage::Time>()};
}

}  // namespace reident
