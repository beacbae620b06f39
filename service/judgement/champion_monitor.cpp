#include "service/judgement/champion_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "identification/simulation/hole_bridging.hpp"
#include "identification/simulation/initial_state.hpp"
#include "identification/simulation/square_changes.hpp"
#include "service/model/model_json.hpp"
#include "service/support/floor_divide.hpp"
#include "service/support/log.hpp"

namespace reident {
namespace {

using identification::Index;

constexpr int reference_blocks = 16;
/// Blocks that are judged together: half as many as before them, so that a fault in all of them
/// still is the exception.
constexpr int most_together = 8;
constexpr double least_coverage = 0.5;
/// Share of an output's identified range: smaller errors are rounding.
constexpr double least_error = 1e-9;

Duration period_of(const EquipmentModel& model) {
  return static_cast<Duration>(std::llround(model.dynamics.period_s * 1e9));
}

/// First tick at or after a time.
std::int64_t tick_at(storage::Time time, Duration period) {
  return -floor_divide(-time, period);
}

}  // namespace

ChampionMonitor::ChampionMonitor(std::string spacecraft, const EquipmentConfig& equipment)
    : spacecraft_(std::move(spacecraft)),
      equipment_(equipment.name),
      checks_(checks_of(equipment)) {}

void ChampionMonitor::watch(const storage::Archive& archive, const storage::Version& version) {
  detector_.reset();
  state_tick_.reset();
  run_rows_ = 0;
  try {
    model_ = equipment_model_from_json(version.model_json);
    square_errors_ = identification::Vector::Zero(model_.dynamics.outputs());
  } catch (const std::invalid_argument&) {  // damaged: it is not published either
    return;
  }
  const storage::TimeRange validated = model_.validated_on;
  const Duration period = period_of(model_);
  block_ = std::max((validated.end - validated.begin) / reference_blocks / period,
                    identification::initial_rows(model_.dynamics)) *
           period;
  next_ = validated.end;
  since_ = validated.end;
  telemetry_.emplace(request_of(model_), 1, checks_);
  const auto record = believed(archive, validated);
  if (!record) return;
  std::optional<identification::SquareChanges> changes;
  std::vector<double> errors;
  for (storage::Time begin = validated.begin; begin + block_ <= validated.end; begin += block_)
    if (const auto error = log_error(*record, {begin, begin + block_}, changes))
      errors.push_back(*error);
  if (errors.size() < std::size_t{identification::ChangeDetector::least_blocks}) return;
  detector_.emplace(
      Eigen::Map<const identification::Vector>(errors.data(), static_cast<Index>(errors.size())));
}

storage::TimeRange ChampionMonitor::window_of(const Drift& drift,
                                              const EquipmentConfig& equipment) {
  const Duration period = equipment.sample_period;
  const std::int64_t ticks = std::max(equipment.window / 2 / period, least_window_ticks(equipment));
  const storage::Time end =
      std::max(drift.end, drift.since + std::min(equipment.window, ticks * period));
  return {std::max(drift.since, end - equipment.window), end};
}

identification::Matrix ChampionMonitor::run(const identification::Record& record,
                                            const identification::Segment& segment,
                                            std::optional<identification::SquareChanges>& changes) {
  const identification::StateSpaceModel& model = model_.dynamics;
  if (state_tick_ != segment.first_tick) {
    const auto before = segments_within(record, {0, segment.begin});
    std::optional<identification::Vector> bridged;
    if (!before.empty() && state_tick_ == before.back().first_tick + before.back().size()) {
      if (!changes) changes = square_changes(record);
      bridged = state_after_hole(model, record, before.back(), segment, state_,
                                 {*changes, square_errors_ / static_cast<double>(run_rows_)});
    }
    state_ = bridged ? std::move(*bridged)
                     : estimate_initial_state(
                           model, record, segments_within(record, {segment.begin, record.rows()}),
                           identification::state_rows);
  }
  identification::Matrix outputs(segment.size(), model.outputs());
  for (Index k = 0; k < segment.size(); ++k) {
    const identification::Vector du = record.u.row(segment.begin + k).transpose() - model.u0;
    outputs.row(k) = (model.C * state_ + model.D * du + model.y0).transpose();
    state_ = (model.A * state_ + model.B * du).eval();
  }
  state_tick_ = segment.first_tick + segment.size();
  square_errors_ += (record.y.middleRows(segment.begin, segment.size()) - outputs)
                        .colwise()
                        .squaredNorm()
                        .transpose();
  run_rows_ += segment.size();
  return outputs;
}

std::optional<identification::Record> ChampionMonitor::believed(const storage::Archive& archive,
                                                                storage::TimeRange range) {
  std::variant<WindowData, UnknownParameter> loaded = UnknownParameter{};
  try {
    loaded = telemetry_->load(archive, range);
  } catch (const storage::Error& error) {
    if (error.kind() != storage::Error::Kind::corrupt) throw;
  }
  if (auto* data = std::get_if<WindowData>(&loaded)) return std::move(data->record);
  return std::nullopt;
}

std::optional<double> ChampionMonitor::log_error(
    const identification::Record& record, storage::TimeRange block,
    std::optional<identification::SquareChanges>& changes) {
  const Duration period = period_of(model_);
  const identification::RowRange rows{first_row_at(record, tick_at(block.begin, period)),
                                      first_row_at(record, tick_at(block.end, period))};
  double squares = 0;
  for (const identification::Segment& segment : segments_within(record, rows)) {
    const identification::Matrix errors =
        record.y.middleRows(segment.begin, segment.size()) - run(record, segment, changes);
    for (Index q = 0; q < errors.cols(); ++q) {
      const Signal& output = model_.outputs[static_cast<std::size_t>(q)];
      const double range = std::max(output.high - output.low, least_error);
      squares += errors.col(q).squaredNorm() / (range * range);
    }
  }
  const auto ticks = static_cast<double>((block.end - block.begin) / period);
  if (static_cast<double>(rows.size()) < least_coverage * ticks) return std::nullopt;
  const auto values = static_cast<double>(rows.size() * record.y.cols());
  const double rms = std::sqrt(squares / values);
  return std::log(std::max(rms, least_error));
}

std::optional<ChampionMonitor::Drift> ChampionMonitor::look(const storage::Archive& archive,
                                                            const storage::Registry& registry,
                                                            storage::Time reached,
                                                            Duration most_past) {
  const auto made = registry.champion_decision(spacecraft_, equipment_);
  if (!made) return std::nullopt;
  if (made->version != version_) {
    version_ = 0;  // where the archive cannot be read now, it is begun with again
    watch(archive, *registry.version(spacecraft_, equipment_, made->version));
    version_ = made->version;
    if (!detector_)
      log::warning("monitor",
                   "too little can be read of what validated the champion; its drift is not told",
                   {{"equipment", spacecraft_ + "/" + equipment_}, {"version", version_}});
  }
  if (!detector_) return std::nullopt;
  if (next_ < reached - most_past) {
    next_ += (reached - most_past - next_) / block_ * block_;
    if (detector_->statistic() == 0) since_ = next_;
  }
  std::optional<Drift> drift;
  while (next_ + block_ <= reached) {
    const Duration come = std::min<Duration>((reached - next_) / block_, most_together);
    const storage::Time end = next_ + come * block_;
    const auto record = believed(archive, {next_ - (reference_blocks - 1) * block_, end});
    std::optional<identification::SquareChanges> changes;
    for (; next_ < end; next_ += block_) {
      const storage::TimeRange block{next_, next_ + block_};
      const auto error = record ? log_error(*record, block, changes) : std::nullopt;
      if (!error) continue;
      if (detector_->add(*error))
        drift = Drift{version_, since_ + block_, block.end, std::exp(*error - detector_->mean())};
      else if (detector_->statistic() == 0)
        since_ = block.end;
    }
  }
  return drift;
}

}  // namespace reident
