#include "tests/trust/outcome_folder.hpp"

#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "service/support/version.hpp"

namespace nlohmann {

template <typename T>
struct adl_serializer<std::optional<T>> {
  static void to_json(json& to, const std::optional<T>& from) { to = from ? json(*from) : json(); }
  static void from_json(const json& from, std::optional<T>& to) {
    to = from.is_null() ? std::nullopt : std::optional(from.get<T>());
  }
};

}  // namespace nlohmann

namespace reident {

namespace storage {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TimeRange, begin, end)
}

namespace trust {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Publication, version, time, judged_on, mrse_percent,
                                   replaced_mrse_percent, resolution_percent)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ChangeScore, kind, begin, mattered, orbits, hindsight_orbits,
                                   worst_ratio, oracle, is_asked)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Attempted, equipment, window, time, trigger, outcome, reason,
                                   version)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DriftRequest, equipment, time)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Extremes, time, low, high)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EquipmentOutcome, equipment, publications, changes, attempts,
                                   drifts, regret, champion, output)

OutcomeFolder::OutcomeFolder(std::filesystem::path folder, std::uint64_t draw, std::string keys)
    : folder_(std::move(folder)),
      made_by_({{"program", program_version()}, {"draw", draw}, {"set", std::move(keys)}}) {
  std::filesystem::create_directories(folder_);
}

std::filesystem::path OutcomeFolder::file_of(int scenario) const {
  return folder_ / (std::to_string(scenario) + ".cbor");
}

std::optional<ScenarioOutcome> OutcomeFolder::find(const LifeGroup& group,
                                                   const Scenario& scenario) const {
  const std::filesystem::path path = file_of(scenario.number);
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  const nlohmann::json kept = nlohmann::json::from_cbor(file, true, false);
  if (kept.is_discarded())
    throw std::runtime_error(path.string() + " is damaged: remove it, and its scenario runs again");
  if (kept.at("made_by") != made_by_)
    throw std::runtime_error(path.string() + " was made by " + kept.at("made_by").dump() +
                             ": name another folder");
  ScenarioOutcome outcome = planned(group, scenario);
  kept.at("equipment").get_to(outcome.equipment);
  return outcome;
}

void OutcomeFolder::keep(const ScenarioOutcome& outcome) const {
  const std::filesystem::path path = file_of(outcome.number), part = path.string() + ".part";
  std::ofstream file(part, std::ios::binary);
  nlohmann::json::to_cbor({{"made_by", made_by_}, {"equipment", outcome.equipment}}, file);
  if (!file.flush()) throw std::runtime_error(part.string() + ": cannot be written");
  std::filesystem::rename(part, path);
}

}  // namespace trust
}  // namespace reident
