#include "service/judgement/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "identification/correction/pole_placement_search.hpp"
#include "identification/simulation/scores.hpp"
#include "service/judgement/run_comparison.hpp"
#include "service/model/model_json.hpp"
#include "service/windows/provenance.hpp"

namespace reident {
namespace {

using identification::Index;
using identification::Matrix;
using identification::RowRange;
using identification::Segment;
using identification::Stationarity;

constexpr double range_slack = 0.05;

/// A rival that has no output on more than half of the samples is not one.
constexpr double least_common_share = 0.5;

/// The candidate against another run, where both have rows. `offset`, where it is given, is the
/// other run's mean error, which is taken from it.
std::optional<Evidence::Comparison> against_run(const PreparedWindow& prepared, const Run& rival,
                                                double confidence_percent,
                                                identification::Vector* offset = nullptr) {
  const Candidate& candidate = *prepared.candidate;
  const RowRange validate = candidate.parts.validate;
  PairedRuns runs = paired(prepared.data.record, validate, candidate.y_hat, rival);
  const double needed = least_common_share * static_cast<double>(validate.size());
  if (static_cast<double>(runs.rows.size()) < needed) return std::nullopt;
  if (offset != nullptr) {
    *offset = (runs.y - runs.rival).colwise().mean().transpose();
    runs.rival.rowwise() += offset->transpose();
  }
  return compare(runs, confidence_percent, Stationarity::stationary);
}

bool is_outside(const Signal& signal, double value) {
  const double slack = range_slack * (signal.high - signal.low);
  return value < signal.low - slack || value > signal.high + slack;
}

bool reaches_beyond(const std::vector<Signal>& champion, const std::vector<Signal>& candidate) {
  return champion.size() != candidate.size() ||
         !std::equal(champion.begin(), champion.end(), candidate.begin(),
                     [](const Signal& a, const Signal& b) {
                       return a.name == b.name && !is_outside(b, a.low) && !is_outside(b, a.high);
                     });
}

/// Root mean square, of the range in percent.
double rms_percent(const Matrix& differences, Index column, double range) {
  const double rms = std::sqrt(differences.col(column).squaredNorm() / double(differences.rows()));
  return rms == 0 ? 0 : 100 * rms / range;
}

/// The inputs (N x m) of the candidate's validation part.
Matrix validation_inputs(const PreparedWindow& prepared) {
  const RowRange rows = prepared.candidate->parts.validate;
  return prepared.data.record.u.middleRows(rows.begin, rows.size());
}

/// The candidate's inputs, in the ranges that its validation part visits.
std::vector<Signal> visited(const PreparedWindow& prepared) {
  return with_ranges(prepared.candidate->model.inputs, validation_inputs(prepared));
}

/// The two runs on the samples in `stretch` with inputs that the candidate was not validated with.
/// Absent where there are too few such samples to tell, or no telemetry of then. `offset` is the
/// champion's mean error where the candidate was validated.
std::optional<Evidence::Champion::Elsewhere> elsewhere(const storage::Archive& archive,
                                                       const EquipmentModel& champion,
                                                       const PreparedWindow& prepared,
                                                       const identification::Vector& offset,
                                                       storage::TimeRange stretch) {
  constexpr std::size_t least_rows = 30;
  const EquipmentModel& candidate = prepared.candidate->model;
  const auto there =
      run_both(archive, candidate, champion, prepared.loaded, prepared.checks, stretch);
  if (!there) return std::nullopt;
  const identification::Record& record = there->record;
  const PairedRuns& both = there->runs;
  const std::vector<Index> outside = rows_outside(record.u, visited(prepared));
  std::vector<Index> places;
  for (std::size_t i = 0; i < both.rows.size(); ++i)
    if (std::binary_search(outside.begin(), outside.end(), both.rows[i]))
      places.push_back(static_cast<Index>(i));
  if (places.size() < least_rows) return std::nullopt;
  const Matrix y = both.y(places, Eigen::all), one = both.candidate(places, Eigen::all),
               other = both.rival(places, Eigen::all);
  Evidence::Champion::Elsewhere result;
  result.rows = y.rows();
  result.mrse_percent = identification::score(y, one).mrse();
  result.champion_mrse_percent = identification::score(y, other).mrse();
  const Matrix apart = one - other;
  const Matrix apart_but_for_offset = apart.rowwise() - offset.transpose();
  for (Index q = 0; q < y.cols(); ++q) {
    const double range = record.y.col(q).maxCoeff() - record.y.col(q).minCoeff();
    const double disagreement = rms_percent(apart, q, range);
    result.disagreement_percent = std::max(result.disagreement_percent, disagreement);
    result.without_offset_percent =
        std::max(result.without_offset_percent,
                 std::min(disagreement, rms_percent(apart_but_for_offset, q, range)));
  }
  return result;
}

/// Where the champion was validated, or all over its window, whichever they differ more in.
std::optional<Evidence::Champion::Elsewhere> elsewhere(const storage::Archive& archive,
                                                       const EquipmentModel& champion,
                                                       const PreparedWindow& prepared,
                                                       const identification::Vector& offset,
                                                       bool all_over_its_window) {
  if (!reaches_beyond(champion.inputs, visited(prepared))) return std::nullopt;
  const storage::TimeRange validated = champion.validated_on;
  const auto there = elsewhere(archive, champion, prepared, offset, validated);
  if (!all_over_its_window) return there;
  const auto anywhere = elsewhere(archive, champion, prepared, offset,
                                  {champion.identified_from.begin, validated.end});
  if (!there || !anywhere) return there ? there : anywhere;
  return anywhere->disagreement_percent > there->disagreement_percent ? anywhere : there;
}

/// Of an input's range: a bias of its sensor that no limit would show.
constexpr double unseen_bias_share = 0.1;

/// Parameters of the champion, bound by no relation, of which a bias could be what makes its mean
/// error: outputs, and inputs that a small bias of would do it.
std::vector<std::string> unbound_of(const EquipmentModel& champion, const Plausibility& checked,
                                    const identification::Vector& offset) {
  std::vector<std::string> suspects = signal_names(champion.outputs);
  const auto gain = static_gain(champion.dynamics);
  std::vector<std::string> inputs;
  for (std::size_t j = 0; j < champion.inputs.size(); ++j) {
    const Signal& input = champion.inputs[j];
    const double bias = unseen_bias_share * (input.high - input.low);
    if (!gain ||
        (bias * gain->col(static_cast<Index>(j)).cwiseAbs().array() >= offset.cwiseAbs().array())
            .any())
      inputs.push_back(input.name);
  }
  const InputExpressions expressions(inputs, derived_inputs(champion.inputs));
  suspects.insert(suspects.end(), expressions.parameters().begin(), expressions.parameters().end());
  std::erase_if(suspects, [&checked](const std::string& name) {
    return std::find(checked.bound.begin(), checked.bound.end(), name) != checked.bound.end();
  });
  return suspects;
}

/// What the simulator's own telemetry says of the outputs.
std::optional<Run> simulator_run(const storage::Archive& archive, WindowRequest request,
                                 storage::TimeRange range) {
  request.inputs.clear();
  request.origin = storage::Origin::simulated;
  auto loaded = load_window(archive, request, range);
  auto* data = std::get_if<WindowData>(&loaded);
  if (!data) return std::nullopt;
  Matrix outputs = data->record.y;
  return Run{std::move(data->record), std::move(outputs)};
}

}  // namespace

std::vector<Index> rows_outside(const Matrix& u, const std::vector<Signal>& inputs) {
  std::vector<Index> rows;
  for (Index row = 0; row < u.rows(); ++row)
    for (std::size_t i = 0; i < inputs.size(); ++i)
      if (is_outside(inputs[i], u(row, static_cast<Index>(i)))) {
        rows.push_back(row);
        break;
      }
  return rows;
}

Evidence::Comparison against_mean(const PreparedWindow& prepared, double confidence_percent) {
  const Candidate& candidate = *prepared.candidate;
  const RowRange rows = candidate.parts.validate;
  const identification::Record& record = prepared.data.record;
  PairedRuns runs;
  runs.y = record.y.middleRows(rows.begin, rows.size());
  runs.candidate = candidate.y_hat.middleRows(rows.begin, rows.size());
  runs.rival = runs.y.colwise().mean().replicate(runs.y.rows(), 1);
  for (const Segment& segment : segments_from(record, rows))
    runs.stretches.push_back({segment.begin, segment.end});
  return compare(runs, confidence_percent, Stationarity::stationary);
}

std::optional<Evidence::Comparison> against_simulator(const storage::Archive& archive,
                                                      const PreparedWindow& prepared,
                                                      double confidence_percent) {
  const auto simulated =
      simulator_run(archive, prepared.loaded, prepared.candidate->model.validated_on);
  if (!simulated) return std::nullopt;
  return against_run(prepared, *simulated, confidence_percent);
}

std::optional<Evidence::Champion> against_champion(const storage::Archive& archive,
                                                   const storage::Registry& registry,
                                                   const PreparedWindow& prepared,
                                                   double confidence_percent,
                                                   double margin_percent) {
  const EquipmentModel& candidate = prepared.candidate->model;
  const auto version = registry.champion(candidate.spacecraft, candidate.equipment);
  if (!version) return std::nullopt;
  Evidence::Champion evidence;
  evidence.version = version->number;
  evidence.window_end = version->window.end;
  // Damaged in the registry: it cannot be published either, and any good candidate replaces it.
  if (mistake_in(*version)) return evidence;
  const EquipmentModel champion = equipment_model_from_json(version->model_json);
  if (!same_outputs(champion, candidate)) return evidence;
  evidence.validated_mrse_percent = champion.validation.mrse();
  evidence.slowest_rows = slowest_rows(candidate, champion);
  identification::Vector offset =
      identification::Vector::Zero(static_cast<Index>(champion.outputs.size()));
  if (const auto run = run_beside(archive, champion, prepared.loaded, prepared.data.record,
                                  prepared.attempt.window)) {
    evidence.comparison = against_run(prepared, *run, confidence_percent);
    evidence.without_offset = against_run(prepared, *run, confidence_percent, &offset);
    if (same_inputs(champion, candidate)) {
      evidence.movement = movement(champion, validation_inputs(prepared));
      evidence.still = still_input(archive, champion, prepared.data.record.u);
    }
    if (evidence.without_offset)
      evidence.unbound = unbound_of(champion, prepared.data.plausibility, offset);
  }
  if (evidence.comparison && evidence.comparison->sure_percent > 0.0 &&
      !is_left_behind(evidence.comparison->rival_mrse_percent, evidence.validated_mrse_percent))
    if (const auto runs = runs_where_validated(archive, champion, candidate, prepared.checks,
                                               prepared.attempt.window.begin))
      evidence.where_validated = compare(*runs, confidence_percent, Stationarity::stationary);
  const bool may_gain_a_constant_alone =
      evidence.without_offset && !(evidence.without_offset->sure_percent > 0.0);
  if (!evidence.comparison || !(evidence.comparison->reduction_percent <= margin_percent))
    evidence.elsewhere = elsewhere(archive, champion, prepared, offset, may_gain_a_constant_alone);
  return evidence;
}

}  // namespace reident
