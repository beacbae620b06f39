#include "service/daemon/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "identification/comparison.hpp"
#include "identification/correction.hpp"
#include "service/model/model_json.hpp"

namespace reident {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::RowRange;
using identification::Segment;

constexpr double range_slack = 0.05;

/// A rival that has no output on more than half of the samples is not one.
constexpr double least_common_share = 0.5;

/// Rows of two records at the same ticks.
struct CommonRows {
  std::vector<Index> one, other;
  std::vector<RowRange> stretches;  // of the common rows, without a gap in each
};

CommonRows common_rows(const Record& one, RowRange rows, const Record& other) {
  CommonRows common;
  for (const Segment& a : segments_within(one, rows))
    for (const Segment& b : other.segments) {
      const std::int64_t begin = std::max(a.first_tick, b.first_tick);
      const std::int64_t end = std::min(a.first_tick + a.size(), b.first_tick + b.size());
      if (begin >= end) continue;
      const auto first = static_cast<Index>(common.one.size());
      common.stretches.push_back({first, first + static_cast<Index>(end - begin)});
      for (std::int64_t tick = begin; tick < end; ++tick) {
        common.one.push_back(a.begin + (tick - a.first_tick));
        common.other.push_back(b.begin + (tick - b.first_tick));
      }
    }
  return common;
}

std::vector<RowRange> stretches_of(const Record& record, RowRange rows) {
  std::vector<RowRange> stretches;
  for (const Segment& segment : segments_from(record, rows))
    stretches.push_back({segment.begin, segment.end});
  return stretches;
}

Evidence::Comparison comparison_of(const Matrix& y, const Matrix& rival, const Matrix& candidate,
                                   const std::vector<RowRange>& stretches,
                                   double confidence_percent) {
  Evidence::Comparison result;
  result.rows = y.rows();
  result.mrse_percent = identification::score(y, candidate).mrse();
  result.rival_mrse_percent = identification::score(y, rival).mrse();
  result.reduction_percent = 100 * (1 - result.mrse_percent / result.rival_mrse_percent);
  if (std::isfinite(result.mrse_percent) && std::isfinite(result.rival_mrse_percent))
    if (const auto paired =
            identification::compare_runs(y, rival, candidate, stretches, confidence_percent / 100))
      result.sure_percent = 100 * paired->low;
  return result;
}

/// The candidate against outputs of another run over `record`, where both have rows. `offset`,
/// where it is given, is the other run's mean error, which is taken from it.
std::optional<Evidence::Comparison> against_run(const PreparedWindow& prepared,
                                                const Record& record, const Matrix& outputs,
                                                double confidence_percent,
                                                identification::Vector* offset = nullptr) {
  const Candidate& candidate = *prepared.candidate;
  const RowRange validate = candidate.parts.validate;
  const CommonRows common = common_rows(prepared.data.record, validate, record);
  const double needed = least_common_share * static_cast<double>(validate.size());
  if (static_cast<double>(common.one.size()) < needed) return std::nullopt;
  const Matrix y = prepared.data.record.y(common.one, Eigen::all);
  Matrix rival = outputs(common.other, Eigen::all);
  if (offset != nullptr) {
    *offset = (y - rival).colwise().mean().transpose();
    rival.rowwise() += offset->transpose();
  }
  return comparison_of(y, rival, candidate.y_hat(common.one, Eigen::all), common.stretches,
                       confidence_percent);
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

/// Free runs of the candidate and the champion, each on its own inputs, where both have rows.
struct BothRuns {
  Record record;               // with the candidate's inputs
  std::vector<Index> rows;     // of the record
  Matrix candidate, champion;  // of these rows
};

std::optional<BothRuns> run_both(const storage::Archive& archive, const EquipmentModel& champion,
                                 const PreparedWindow& prepared, storage::TimeRange range) {
  auto seen = KeptWindow(prepared.loaded, 1, prepared.checks).load(archive, range);
  const auto championed = load_window(archive, request_of(champion), range);
  if (!std::holds_alternative<WindowData>(seen) || !std::holds_alternative<WindowData>(championed))
    return std::nullopt;
  BothRuns both{std::move(std::get<WindowData>(seen).record), {}, {}, {}};
  const Record& own = std::get<WindowData>(championed).record;
  CommonRows common = common_rows(both.record, both.record.all(), own);
  both.candidate = free_run(prepared.candidate->model.dynamics, both.record, both.record.all())(
      common.one, Eigen::all);
  both.champion = free_run(champion.dynamics, own, own.all())(common.other, Eigen::all);
  both.rows = std::move(common.one);
  return both;
}

/// The two runs where the champion was validated with inputs that the candidate's window does not
/// hold. Absent where there are too few such samples to tell, or no telemetry of then.
std::optional<Evidence::Champion::Elsewhere> elsewhere(const storage::Archive& archive,
                                                       const EquipmentModel& champion,
                                                       const PreparedWindow& prepared) {
  constexpr std::size_t least_rows = 30;
  const EquipmentModel& candidate = prepared.candidate->model;
  if (!reaches_beyond(champion.inputs, candidate.inputs)) return std::nullopt;
  const auto both = run_both(archive, champion, prepared, champion.validated_on);
  if (!both) return std::nullopt;
  const std::vector<Index> outside = rows_outside(both->record.u, candidate.inputs);
  std::vector<Index> rows, places;
  for (std::size_t i = 0; i < both->rows.size(); ++i)
    if (std::binary_search(outside.begin(), outside.end(), both->rows[i])) {
      rows.push_back(both->rows[i]);
      places.push_back(static_cast<Index>(i));
    }
  if (rows.size() < least_rows) return std::nullopt;
  const Matrix& all_y = both->record.y;
  const Matrix y = all_y(rows, Eigen::all), one = both->candidate(places, Eigen::all),
               other = both->champion(places, Eigen::all);
  Evidence::Champion::Elsewhere result;
  result.rows = y.rows();
  result.mrse_percent = identification::score(y, one).mrse();
  result.champion_mrse_percent = identification::score(y, other).mrse();
  for (Index q = 0; q < y.cols(); ++q) {
    const double range = all_y.col(q).maxCoeff() - all_y.col(q).minCoeff();
    const double rms = std::sqrt((one.col(q) - other.col(q)).squaredNorm() / double(y.rows()));
    const double share = rms == 0 ? 0 : 100 * rms / range;
    result.disagreement_percent = std::max(result.disagreement_percent, share);
  }
  return result;
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

bool same_outputs(const EquipmentModel& one, const EquipmentModel& other) {
  return std::equal(one.outputs.begin(), one.outputs.end(), other.outputs.begin(),
                    other.outputs.end(),
                    [](const Signal& a, const Signal& b) { return a.name == b.name; });
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
  const Matrix y = prepared.data.record.y.middleRows(rows.begin, rows.size());
  const Matrix mean = y.colwise().mean().replicate(y.rows(), 1);
  return comparison_of(y, mean, candidate.y_hat.middleRows(rows.begin, rows.size()),
                       stretches_of(prepared.data.record, rows), confidence_percent);
}

std::optional<Evidence::Comparison> against_simulator(const storage::Archive& archive,
                                                      const PreparedWindow& prepared,
                                                      double confidence_percent) {
  WindowRequest request = prepared.loaded;
  request.inputs.clear();
  request.origin = storage::Origin::simulated;
  const auto loaded = load_window(archive, request, prepared.candidate->model.validated_on);
  const auto* simulated = std::get_if<WindowData>(&loaded);
  if (!simulated) return std::nullopt;
  return against_run(prepared, simulated->record, simulated->record.y, confidence_percent);
}

std::optional<Evidence::Champion> against_champion(const storage::Archive& archive,
                                                   const storage::Registry& registry,
                                                   const PreparedWindow& prepared,
                                                   double confidence_percent) {
  const EquipmentModel& candidate = prepared.candidate->model;
  const auto version = registry.champion(candidate.spacecraft, candidate.equipment);
  if (!version) return std::nullopt;
  Evidence::Champion evidence;
  evidence.version = version->number;
  evidence.window_end = version->window.end;
  EquipmentModel champion;
  try {
    champion = equipment_model_from_json(version->model_json);
  } catch (const std::invalid_argument&) {
    // Damaged in the registry: it cannot be published either, and any good candidate replaces it.
    return evidence;
  }
  if (!same_outputs(champion, candidate)) return std::nullopt;
  const auto compare_over = [&](const Record& record) {
    const Matrix run = free_run(champion.dynamics, record, record.all());
    evidence.comparison = against_run(prepared, record, run, confidence_percent);
    identification::Vector offset;
    evidence.without_offset = against_run(prepared, record, run, confidence_percent, &offset);
    if (evidence.without_offset)
      evidence.unbound = unbound_of(champion, prepared.data.plausibility, offset);
  };
  const WindowRequest request = request_of(champion);
  if (request == prepared.loaded)
    compare_over(prepared.data.record);
  else if (const auto loaded = load_window(archive, request, prepared.attempt.window);
           std::holds_alternative<WindowData>(loaded))
    compare_over(std::get<WindowData>(loaded).record);
  evidence.elsewhere = elsewhere(archive, champion, prepared);
  return evidence;
}

std::optional<Evidence::Champion::Past> in_the_past(const storage::Archive& archive,
                                                    const storage::Registry& registry,
                                                    const PreparedWindow& prepared) {
  constexpr int windows = 4;
  const storage::TimeRange window = prepared.attempt.window;
  const EquipmentModel& candidate = prepared.candidate->model;
  const auto version = registry.champion(candidate.spacecraft, candidate.equipment);
  if (!version) return std::nullopt;
  std::optional<BothRuns> both;
  try {
    both = run_both(archive, equipment_model_from_json(version->model_json), prepared,
                    {window.begin - windows * (window.end - window.begin), window.begin});
  } catch (const storage::Error& error) {
    if (error.kind() != storage::Error::Kind::corrupt) throw;
    return std::nullopt;  // damage long before the window does not hold it up
  }
  const RowRange rows = prepared.candidate->parts.validate;
  if (!both || static_cast<Index>(both->rows.size()) < rows.size()) return std::nullopt;
  const auto rms = [](const Matrix& values) -> Eigen::ArrayXd {
    return (values.colwise().squaredNorm() / double(values.rows())).cwiseSqrt().transpose().array();
  };
  const Eigen::ArrayXd size = rms(prepared.data.record.y.middleRows(rows.begin, rows.size()));
  const Matrix y = both->record.y(both->rows, Eigen::all);
  const auto error = [&](const Matrix& run) { return 100 * (rms(y - run) / size).mean(); };
  return Evidence::Champion::Past{static_cast<std::int64_t>(y.rows()), error(both->candidate),
                                  error(both->champion)};
}

}  // namespace reident
