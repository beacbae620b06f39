#include <set>

#include "service/model/model_json.hpp"
#include "service/model_export/model_export.hpp"

namespace reident::model_export {
namespace {

using identification::Index;

bool sizes_agree(const EquipmentModel& model) {
  const identification::StateSpaceModel& dynamics = model.dynamics;
  return identification::is_well_formed(dynamics) &&
         dynamics.inputs() == static_cast<Index>(model.inputs.size()) &&
         dynamics.outputs() == static_cast<Index>(model.outputs.size());
}

std::optional<std::string> name_given_twice(const EquipmentModel& model) {
  std::set<std::string> names;
  for (const auto* signals : {&model.inputs, &model.outputs})
    for (const Signal& signal : *signals)
      if (!names.insert(signal.name).second) return signal.name;
  return std::nullopt;
}

}  // namespace

std::optional<std::string> obstacle(const ModelVersion& version) {
  if (!sizes_agree(version.model))
    return "its matrices, signals and period do not fit together, or are not finite";
  if (model_digest(version.model) != version.digest)
    return "its stored model does not match its digest: it was damaged; restore the database from "
           "a "
           "backup";
  if (const auto name = name_given_twice(version.model))
    return "two of its inputs and outputs are called " + *name;
  return std::nullopt;
}

}  // namespace reident::model_export
