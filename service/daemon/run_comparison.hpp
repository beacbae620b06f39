// Two runs on the telemetry that both have, and which errs less on it.
#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "identification/record.hpp"
#include "service/daemon/gate.hpp"
#include "service/daemon/plausibility.hpp"
#include "service/model/model_version.hpp"
#include "storage/archive.hpp"

namespace reident {

/// Outputs of a model or of the simulator at the rows of a record.
struct Run {
  identification::Record record;
  identification::Matrix outputs;  // one row for each of the record
};

/// The model's free run through what is believed of the telemetry in `range`. Absent where a
/// parameter of it is not described.
std::optional<Run> run_on_believed(const storage::Archive& archive, const EquipmentModel& model,
                                   const Checks& checks, storage::TimeRange range);

/// The model's free run through all telemetry in `range`. Absent as above.
std::optional<Run> run_on_all(const storage::Archive& archive, const EquipmentModel& model,
                              storage::TimeRange range);

/// Two runs at the ticks at which both have a row.
struct PairedRuns {
  std::vector<identification::Index> rows;          // of the candidate's record
  identification::Matrix y, candidate, rival;       // of these rows
  std::vector<identification::RowRange> stretches;  // of these rows, without a gap in each
};

/// `candidate` has an output at each row of `record`, of which only `rows` are looked at.
PairedRuns paired(const identification::Record& record, identification::RowRange rows,
                  const identification::Matrix& candidate, const Run& rival);

Evidence::Comparison compare(const PairedRuns& runs, double confidence_percent);

nlohmann::ordered_json to_json(const Evidence::Comparison& comparison);

}  // namespace reident
