// The state of a stored model at a time, from archived telemetry.
#pragma once

#include <string>
#include <variant>

#include "service/model/model_version.hpp"
#include "storage/types/sample_reader.hpp"

namespace reident {

struct ModelState {
  storage::Time time = 0;    // of the tick that x belongs to
  identification::Vector x;  // n
};

/// Returns the state at the last tick at or before `time` at which all parameters are valid. It is
/// estimated from the rows without a hole before it, at most `identification::state_rows`. Returns
/// the reason where there are too few.
std::variant<ModelState, std::string> state_at(const storage::SampleReader& archive,
                                               const EquipmentModel& model, storage::Time time);

}  // namespace reident
