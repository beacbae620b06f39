#include <set>

#include "service/model/model_json.hpp"
#include "service/model_export/model_export.hpp"

namespace reident::model_export {
namespace {

std::optional<std::string> name_given_twice(const EquipmentModel& model) {
  std::set<std::string> names;
  for (const auto* signals : {&model.inputs, &model.outputs})
    for (const Signal& signal : *signals)
      if (!names.insert(signal.name).second) return signal.name;
  return std::nullopt;
}

}  // namespace

std::optional<std::string> obstacle(const ModelVersion& version) {
  if (!is_well_formed(version.model))
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
