// Two runs on the telemetry that both have, and which errs less on it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "identification/samples/record.hpp"
#include "identification/statistics/comparison.hpp"
#include "service/judgement/gate.hpp"
#include "service/model/model_version.hpp"
#include "service/windows/telemetry_checks.hpp"
#include "service/windows/window_data.hpp"
#include "storage/archive/archive.hpp"

namespace reident {

/// Outputs of a model or of the simulator at the rows of a record.
struct Run {
  identification::Record record;
  identification::Matrix outputs;  // one row for each of the record
};

/// The free runs of a model and of another one: through `record`, what is believed of the
/// telemetry in `range` that `request` asks for, where it looks at the same parameters, or else
/// through all telemetry there. Absent where a parameter of it is not described.
std::optional<Run> run_beside(const storage::Archive& archive, const EquipmentModel& model,
                              const WindowRequest& request, const identification::Record& record,
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

/// The free runs of both on what is believed of the telemetry in `range`, for which `request` asks
/// as the candidate does (the rival's on all of its own, where it asks otherwise), begun `run_up`
/// before it. Absent where a parameter of either is not described.
struct RunsOfBoth {
  identification::Record record;  // the candidate's
  PairedRuns runs;
  double believed_share = 1;  // of the telemetry that came, that of `run_up` included
};
std::optional<RunsOfBoth> run_both(const storage::Archive& archive, const EquipmentModel& candidate,
                                   const EquipmentModel& rival, const WindowRequest& request,
                                   const Checks& checks, storage::TimeRange range,
                                   Duration run_up = 0);

/// Share of the ranges of the model's inputs that `u` (N x m, N at least 1) moves over, weighted by
/// what each of them moves the output by, in a steady state and by its own range at most; the
/// smallest one of any output. Inputs that are held near a point count where there are no others.
double movement(const EquipmentModel& model, const identification::Matrix& u);

/// The first input of the model that moved when it was identified and has one value in all of `u`
/// (N x m, N at least 1), and is no switch or computed from switches alone; empty where there is
/// none. A sensor's noise shows in telemetry of hours: what stands still all the time is stuck, or
/// at rest in another operation.
std::string still_input(const storage::Archive& archive, const EquipmentModel& model,
                        const identification::Matrix& u);

Evidence::Comparison compare(const PairedRuns& runs, double confidence_percent,
                             identification::Stationarity stationarity);

/// The free runs of `model` and of the champion on the part of what validated the champion that
/// comes before `end`: where the model's window does not begin before that, telemetry which nothing
/// of it was fitted to or chosen by, but for the champion's A and C where it has these. Absent
/// where less than half is left.
std::optional<PairedRuns> runs_where_validated(const storage::Archive& archive,
                                               const EquipmentModel& champion,
                                               const EquipmentModel& model, const Checks& checks,
                                               storage::Time end);

/// The rival's largest error over so many rows, in steps of an eighth of them, in percent of the
/// outputs over all rows as the MRSE is; 0 where there are fewer, or where that is not finite.
double worst_of_rival(const PairedRuns& runs, identification::Index rows);

/// Both of them, one after the other.
PairedRuns joined(const PairedRuns& first, const PairedRuns& second);

/// Samples of the first in the slowest time constant of the two.
double slowest_rows(const EquipmentModel& one, const EquipmentModel& other);

/// Whether the same rows are inputs of both.
bool same_inputs(const EquipmentModel& one, const EquipmentModel& other);

bool same_outputs(const EquipmentModel& one, const EquipmentModel& other);

nlohmann::ordered_json to_json(const Evidence::Comparison& comparison);

}  // namespace reident
