#include "service/judgement/run_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

#include "identification/correction/pole_placement_search.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/scores.hpp"
#include "service/windows/window_cache.hpp"
#include "service/windows/window_data.hpp"

namespace reident {

using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::RowRange;
using identification::Segment;
using identification::Vector;

namespace {

/// A signal that stays near a point and leaves it for transients crosses its range whatever the
/// operation: a bus voltage deviates by a thirtieth of it, currents by a tenth and more.
bool is_held(const Vector& values) {
  constexpr double held = 0.05;
  const double range = values.maxCoeff() - values.minCoeff();
  const double mean_square =
      (values.array() - values.mean()).square().sum() / static_cast<double>(values.size());
  return range > 0 && std::sqrt(mean_square) < held * range;
}

struct Share {
  double moved = 0, of = 0;

  void add(double share, double weight) {
    moved += share * weight;
    of += weight;
  }
};

}  // namespace

std::optional<Run> run_beside(const storage::Archive& archive, const EquipmentModel& model,
                              const WindowRequest& request, const Record& record,
                              storage::TimeRange range) {
  const WindowRequest own = request_of(model);
  if (own == request) return Run{record, free_run(model.dynamics, record, record.all())};
  auto loaded = load_window(archive, own, range);
  auto* data = std::get_if<WindowData>(&loaded);
  if (!data) return std::nullopt;
  Matrix outputs = free_run(model.dynamics, data->record, data->record.all());
  return Run{std::move(data->record), std::move(outputs)};
}

PairedRuns paired(const Record& record, RowRange rows, const Matrix& candidate, const Run& rival) {
  PairedRuns runs;
  std::vector<Index> of_rival;
  for (const Segment& a : segments_within(record, rows))
    for (const Segment& b : rival.record.segments) {
      const std::int64_t begin = std::max(a.first_tick, b.first_tick);
      const std::int64_t end = std::min(a.first_tick + a.size(), b.first_tick + b.size());
      if (begin >= end) continue;
      const auto first = static_cast<Index>(runs.rows.size());
      runs.stretches.push_back({first, first + static_cast<Index>(end - begin)});
      for (std::int64_t tick = begin; tick < end; ++tick) {
        runs.rows.push_back(a.begin + (tick - a.first_tick));
        of_rival.push_back(b.begin + (tick - b.first_tick));
      }
    }
  runs.y = record.y(runs.rows, Eigen::all);
  runs.candidate = candidate(runs.rows, Eigen::all);
  runs.rival = rival.outputs(of_rival, Eigen::all);
  return runs;
}

std::optional<RunsOfBoth> run_both(const storage::Archive& archive, const EquipmentModel& candidate,
                                   const EquipmentModel& rival, const WindowRequest& request,
                                   const Checks& checks, storage::TimeRange range,
                                   Duration run_up) {
  const storage::TimeRange longer{range.begin - run_up, range.end};
  auto loaded = WindowCache(request, 1, checks).load(archive, longer);
  auto* data = std::get_if<WindowData>(&loaded);
  if (!data) return std::nullopt;
  Record& record = data->record;
  const auto theirs = run_beside(archive, rival, request, record, longer);
  if (!theirs) return std::nullopt;
  const Index first = first_row_at(record, ticks_of(range, request.period).begin);
  PairedRuns runs = paired(record, {first, record.rows()},
                           free_run(candidate.dynamics, record, record.all()), *theirs);
  const double believed = data->read_coverage > 0 ? data->coverage / data->read_coverage : 1;
  return RunsOfBoth{std::move(record), std::move(runs), believed};
}

double movement(const EquipmentModel& model, const Matrix& u) {
  const auto gain = static_gain(model.dynamics);
  if (!gain || model.inputs.empty()) return 1;
  const std::vector<Signal> visited = with_ranges(model.inputs, u);
  double least = 1;
  for (Index q = 0; q < gain->rows(); ++q) {
    const Signal& output = model.outputs[static_cast<std::size_t>(q)];
    Share all, free;
    for (std::size_t j = 0; j < model.inputs.size(); ++j) {
      const double range = model.inputs[j].high - model.inputs[j].low;
      if (!(range > 0)) continue;
      const auto column = static_cast<Index>(j);
      const double share = std::min(1.0, (visited[j].high - visited[j].low) / range);
      const double effect =
          std::min(std::abs((*gain)(q, column)) * range, output.high - output.low);
      all.add(share, effect);
      if (!is_held(u.col(column))) free.add(share, effect);
    }
    const Share& counted = free.of > 0 ? free : all;
    if (counted.of > 0) least = std::min(least, counted.moved / counted.of);
  }
  return least;
}

std::string still_input(const storage::Archive& archive, const EquipmentModel& model,
                        const Matrix& u) {
  const auto is_switch = [&](const std::string& parameter) {
    const auto described = archive.parameter(model.spacecraft, parameter);
    return described && described->kind == storage::ParameterKind::digital;
  };
  const std::vector<DerivedInput> derived = derived_inputs(model.inputs);
  for (std::size_t j = 0; j < model.inputs.size(); ++j) {
    const Signal& input = model.inputs[j];
    const auto values = u.col(static_cast<Index>(j)).array();
    if (!(input.high > input.low) || (values != values(0)).any()) continue;
    const InputExpressions sources({input.name}, derived);
    if (!std::all_of(sources.parameters().begin(), sources.parameters().end(), is_switch))
      return input.name;
  }
  return {};
}

Evidence::Comparison compare(const PairedRuns& runs, double confidence_percent,
                             identification::Stationarity stationarity) {
  Evidence::Comparison result;
  result.rows = runs.y.rows();
  result.mrse_percent = identification::score(runs.y, runs.candidate).mrse();
  result.rival_mrse_percent = identification::score(runs.y, runs.rival).mrse();
  result.reduction_percent = 100 * (1 - result.mrse_percent / result.rival_mrse_percent);
  if (std::isfinite(result.mrse_percent))
    result.noise_percent = identification::noise_percent(runs.y, runs.candidate, runs.stretches);
  if (std::isfinite(result.mrse_percent) && std::isfinite(result.rival_mrse_percent))
    if (const auto sure =
            identification::compare_runs(runs.y, runs.rival, runs.candidate, runs.stretches,
                                         confidence_percent / 100, stationarity))
      result.sure_percent = 100 * sure->low;
  return result;
}

std::optional<PairedRuns> runs_where_validated(const storage::Archive& archive,
                                               const EquipmentModel& champion,
                                               const EquipmentModel& model, const Checks& checks,
                                               storage::Time end) {
  constexpr double least_share = 0.5;
  const storage::TimeRange validated = champion.validated_on;
  const storage::TimeRange range{validated.begin, std::min(validated.end, end)};
  if (range.end <= range.begin) return std::nullopt;
  const WindowRequest request = request_of(model);
  auto both = run_both(archive, model, champion, request, checks, range);
  const auto ticks = static_cast<double>((validated.end - validated.begin) / request.period);
  if (!both || static_cast<double>(both->runs.rows.size()) < least_share * ticks)
    return std::nullopt;
  return std::move(both->runs);
}

double worst_of_rival(const PairedRuns& runs, Index rows) {
  constexpr Index steps = 8;  // of a stretch
  if (rows < 1 || runs.y.rows() < rows) return 0;
  const Matrix errors = runs.y - runs.rival;
  const auto sizes = runs.y.colwise().norm().array() / std::sqrt(double(runs.y.rows()));
  const auto error_from = [&](Index begin) {
    return (errors.middleRows(begin, rows).colwise().norm().array() / sizes).mean();
  };
  double worst = error_from(runs.y.rows() - rows);
  for (Index begin = 0; begin + rows < runs.y.rows(); begin += std::max<Index>(1, rows / steps))
    worst = std::max(worst, error_from(begin));
  return std::isfinite(worst) ? 100 * worst / std::sqrt(double(rows)) : 0;
}

PairedRuns joined(const PairedRuns& first, const PairedRuns& second) {
  const auto stacked = [](const Matrix& a, const Matrix& b) {
    Matrix both(a.rows() + b.rows(), b.cols());
    both << a, b;
    return both;
  };
  PairedRuns both{first.rows, stacked(first.y, second.y),
                  stacked(first.candidate, second.candidate), stacked(first.rival, second.rival),
                  first.stretches};
  both.rows.insert(both.rows.end(), second.rows.begin(), second.rows.end());
  for (const RowRange& stretch : second.stretches)
    both.stretches.push_back({stretch.begin + first.y.rows(), stretch.end + first.y.rows()});
  return both;
}

double slowest_rows(const EquipmentModel& one, const EquipmentModel& other) {
  return std::max(slowest_time_constant_s(one.dynamics), slowest_time_constant_s(other.dynamics)) /
         one.dynamics.period_s;
}

bool same_inputs(const EquipmentModel& one, const EquipmentModel& other) {
  return one.dynamics.period_s == other.dynamics.period_s &&
         std::equal(one.inputs.begin(), one.inputs.end(), other.inputs.begin(), other.inputs.end(),
                    [](const Signal& a, const Signal& b) {
                      return a.name == b.name && a.expression == b.expression;
                    });
}

bool same_outputs(const EquipmentModel& one, const EquipmentModel& other) {
  return std::equal(one.outputs.begin(), one.outputs.end(), other.outputs.begin(),
                    other.outputs.end(),
                    [](const Signal& a, const Signal& b) { return a.name == b.name; });
}

nlohmann::ordered_json to_json(const Evidence::Comparison& comparison) {
  nlohmann::ordered_json json = {{"rows", comparison.rows},
                                 {"mrse_percent", comparison.mrse_percent},
                                 {"rival_mrse_percent", comparison.rival_mrse_percent},
                                 {"reduction_percent", comparison.reduction_percent}};
  json["sure_reduction_percent"] = comparison.sure_percent
                                       ? nlohmann::ordered_json(*comparison.sure_percent)
                                       : nlohmann::ordered_json(nullptr);
  json["noise_percent"] = comparison.noise_percent;
  return json;
}

}  // namespace reident
