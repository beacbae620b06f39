#include "tests/trust/truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "identification/search/identify.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/initial_state.hpp"
#include "service/satcs/family.hpp"
#include "service/satcs/reference/telemetry_point.hpp"
#include "service/support/floor_divide.hpp"
#include "service/windows/candidate.hpp"
#include "service/windows/window_data.hpp"

namespace reident::trust {
namespace {

using identification::Index;
using identification::Matrix;

/// A window of the truth, which has no holes.
WindowData load(const KnownSeries& series, const WindowRequest& request, storage::TimeRange range) {
  auto loaded = load_window(series, request, range);
  if (const auto* unknown = std::get_if<UnknownParameter>(&loaded))
    throw std::logic_error("the truth has no parameter " + unknown->name);
  return std::get<WindowData>(std::move(loaded));
}

const satcs::reference::SensorSpec& sensor_of(const std::string& parameter) {
  if (const auto* point = satcs::find_point(parameter)) return point->sensor;
  throw std::logic_error("no telemetry point " + parameter);
}

}  // namespace

ErrorCurve::ErrorCurve(storage::Time origin, Duration block, std::size_t outputs)
    : origin_(origin), block_(block), outputs_(outputs) {}

std::int64_t ErrorCurve::block_of(storage::Time time) const {
  return floor_divide(time - origin_, block_);
}

ErrorCurve::Sums& ErrorCurve::at(std::int64_t block, std::size_t output) {
  const std::size_t index = static_cast<std::size_t>(block) * outputs_ + output;
  if (sums_.size() <= index) sums_.resize((static_cast<std::size_t>(block) + 1) * outputs_);
  return sums_[index];
}

void ErrorCurve::add(storage::Time first, Duration period, const Matrix& y, const Matrix& errors) {
  for (Index k = 0; k < y.rows(); ++k) {
    const std::int64_t block = block_of(first + k * period);
    if (block < 0) continue;
    for (Index q = 0; q < y.cols(); ++q) {
      Sums& sums = at(block, static_cast<std::size_t>(q));
      const double square = errors(k, q) * errors(k, q);
      sums.squared_errors +=
          std::isfinite(square) ? square : std::numeric_limits<double>::infinity();
      sums.squares += y(k, q) * y(k, q);
    }
  }
}

void ErrorCurve::add(const ErrorCurve& other) {
  if (sums_.size() < other.sums_.size()) sums_.resize(other.sums_.size());
  for (std::size_t i = 0; i < other.sums_.size(); ++i) {
    sums_[i].squared_errors += other.sums_[i].squared_errors;
    sums_[i].squares += other.sums_[i].squares;
  }
}

std::optional<double> ErrorCurve::mrse_percent(std::int64_t first, std::int64_t last) const {
  first = std::max<std::int64_t>(first, 0);
  last = std::min(last, static_cast<std::int64_t>(sums_.size() / outputs_));
  double total = 0;
  for (std::size_t q = 0; q < outputs_; ++q) {
    Sums sums;
    for (std::int64_t block = first; block < last; ++block) {
      const Sums& one = sums_[static_cast<std::size_t>(block) * outputs_ + q];
      sums.squared_errors += one.squared_errors;
      sums.squares += one.squares;
    }
    if (sums.squares == 0) return std::nullopt;
    total += 100 * std::sqrt(sums.squared_errors / sums.squares);
  }
  return total / static_cast<double>(outputs_);
}

Truth::Truth(const KnownSeries& truth, const KnownSeries& simulated,
             const SpacecraftConfig& spacecraft, const EquipmentConfig& equipment,
             storage::TimeRange extent, Duration block)
    : truth_(truth),
      simulated_(simulated),
      spacecraft_(spacecraft.name),
      equipment_(equipment),
      extent_(extent),
      block_(block) {}

ErrorCurve Truth::empty_curve() const {
  return {extent_.begin, block_, equipment_.outputs.size()};
}

const identification::Record& Truth::record_for(const WindowRequest& request) const {
  if (!record_ || record_->first != request)
    record_.emplace(request, load(truth_, request, extent_).record);
  return record_->second;
}

ErrorCurve Truth::free_run(const EquipmentModel& model, storage::TimeRange range) const {
  const WindowRequest request = request_of(model);
  const identification::Record& record = record_for(request);
  const identification::TickRange ticks = ticks_of(range, request.period);
  ErrorCurve curve = empty_curve();
  for (const identification::Segment& segment : segments_within(
           record, {first_row_at(record, ticks.begin), first_row_at(record, ticks.end)})) {
    const identification::RowRange rows{segment.begin, segment.end};
    const identification::Vector x0 =
        estimate_initial_state(model.dynamics, record, {segment}, identification::state_rows);
    const Matrix y = record.y.middleRows(rows.begin, rows.size());
    curve.add(segment.first_tick * request.period, request.period, y,
              y - identification::free_run(model.dynamics, record, rows, x0));
  }
  return curve;
}

ErrorCurve Truth::baseline(storage::TimeRange range) const {
  const WindowRequest request = outputs_alone();
  const identification::Record record = load(truth_, request, range).record;
  const bool has_outputs = std::all_of(
      request.outputs.begin(), request.outputs.end(),
      [this](const auto& name) { return simulated_.parameter(spacecraft_, name).has_value(); });
  ErrorCurve curve = empty_curve();
  if (has_outputs) {
    const identification::Record simulated = load(simulated_, request, range).record;
    for (const identification::Segment& segment : record.segments) {
      const Matrix y = record.y.middleRows(segment.begin, segment.size());
      const Index first = first_row_at(simulated, segment.first_tick);
      const Index rows = std::min(segment.size(), simulated.rows() - first);
      curve.add(segment.first_tick * request.period, request.period, y.topRows(rows),
                y.topRows(rows) - simulated.y.middleRows(first, rows));
    }
    return curve;
  }
  for (const identification::Segment& segment : record.segments) {
    const Matrix y = record.y.middleRows(segment.begin, segment.size());
    curve.add(segment.first_tick * request.period, request.period, y,
              y.rowwise() - record.y.colwise().mean());
  }
  return curve;
}

WindowRequest Truth::outputs_alone() const {
  WindowRequest request = request_of(spacecraft_, equipment_);
  request.inputs.clear();
  request.derived.clear();
  return request;
}

std::vector<Extremes> Truth::output_extremes(storage::TimeRange range, Duration step) const {
  const WindowRequest request = outputs_alone();
  const identification::Record record = load(truth_, request, range).record;
  const Index rows = step / request.period;
  std::vector<Extremes> extremes;
  for (const identification::Segment& segment : record.segments)
    for (Index row = segment.begin; row < segment.end; row += rows) {
      const auto values = record.y.col(0).segment(row, std::min(rows, segment.end - row));
      extremes.push_back({(segment.first_tick + row - segment.begin) * request.period,
                          values.minCoeff(), values.maxCoeff()});
    }
  return extremes;
}

double Truth::resolution_percent(storage::TimeRange range) const {
  const WindowRequest request = outputs_alone();
  const Matrix y = load(truth_, request, range).record.y;
  double total = 0;
  for (Index q = 0; q < y.cols(); ++q) {
    const auto& sensor = sensor_of(request.outputs[static_cast<std::size_t>(q)]);
    const double sigma =
        std::sqrt(sensor.noise * sensor.noise + sensor.quantum() * sensor.quantum() / 12);
    total += 100 * sigma / std::sqrt(y.col(q).squaredNorm() / static_cast<double>(y.rows()));
  }
  return total / static_cast<double>(y.cols());
}

std::optional<EquipmentModel> oracle(const KnownSeries& clean, const SpacecraftConfig& spacecraft,
                                     const EquipmentConfig& equipment, storage::TimeRange window) {
  const WindowData data = load(clean, request_of(spacecraft.name, equipment), window);
  const WindowParts parts = parts_of(data.record.rows(), equipment);
  identification::IdentifyOptions options = options_of(equipment);
  options.tune_rows = parts.tune.size();
  if (parts.identify.size() == 0) return std::nullopt;
  const auto result = identify(data.record, data.record.all(), options);
  const auto* identified = std::get_if<identification::Identified>(&result);
  if (!identified) return std::nullopt;
  EquipmentModel model;
  model.spacecraft = spacecraft.name;
  model.equipment = equipment.name;
  model.inputs = data.inputs;
  model.outputs = data.outputs;
  model.dynamics = identified->model;
  model.sample_hold_ns = equipment.sample_hold;
  return model;
}

}  // namespace reident::trust
