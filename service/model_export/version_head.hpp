// What exported files say of a version in addition to its model.
#pragma once

#include "service/model_export/model_export.hpp"
#include "service/support/time_text.hpp"

namespace reident::model_export {

/// Calls visit(name, value) in the order of the files; values are texts and whole numbers. A new
/// line here appears in JSON and in the MATLAB file; README.md lists both.
template <class Visit>
void visit_head(const ExportedVersion& exported, Visit&& visit) {
  const ModelVersion& version = exported.version;
  visit("spacecraft", version.model.spacecraft);
  visit("equipment", version.model.equipment);
  visit("version", version.number);
  visit("digest", version.digest);
  visit("status", exported.status);
  visit("decided", time_text(version.decided));
  visit("decided_by", version.decided_by);
}

}  // namespace reident::model_export
