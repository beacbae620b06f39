#include "service/daemon/champion_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "identification/simulate.hpp"
#include "service/daemon/window_data.hpp"
#include "service/model/model_json.hpp"

namespace reident {
namespace {

using identification::Index;

constexpr int reference_blocks = 16;
constexpr double least_coverage = 0.5;
/// Of an output's identified range: smaller errors are rounding.
constexpr double least_error = 1e-9;

Duration period_of(const EquipmentModel& model) {
  return static_cast<Duration>(std::llround(model.dynamics.period_s * 1e9));
}

}  // namespace

ChampionMonitor::ChampionMonitor(std::string spacecraft, std::string equipment)
    : spacecraft_(std::move(spacecraft)), equipment_(std::move(equipment)) {}

void ChampionMonitor::watch(const storage::Archive& archive, const storage::Version& version) {
  version_ = version.number;
  detector_.reset();
  state_tick_.reset();
  try {
    model_ = equipment_model_from_json(version.model_json);
  } catch (const std::invalid_argument&) {  // damaged: it is not published either
    return;
  }
  const storage::TimeRange validated = model_.validated_on;
  const Duration period = period_of(model_);
  block_ = (validated.end - validated.begin) / reference_blocks / period * period;
  next_ = validated.end;
  if (block_ < period * identification::initial_rows(model_.dynamics)) return;
  std::vector<double> errors;
  for (storage::Time begin = validated.begin; begin + block_ <= validated.end; begin += block_)
    if (const auto error = log_error(archive, {begin, begin + block_})) errors.push_back(*error);
  if (errors.size() < std::size_t{identification::ChangeDetector::least_blocks}) return;
  detector_.emplace(
      Eigen::Map<const identification::Vector>(errors.data(), static_cast<Index>(errors.size())));
}

identification::Matrix ChampionMonitor::run(const identification::Record& record,
                                            const identification::Segment& segment) {
  const identification::StateSpaceModel& model = model_.dynamics;
  if (state_tick_ != segment.first_tick)
    state_ = estimate_initial_state(model, record, segment, initial_rows(model));
  identification::Matrix outputs(segment.size(), model.outputs());
  for (Index k = 0; k < segment.size(); ++k) {
    const identification::Vector du = record.u.row(segment.begin + k).transpose() - model.u0;
    outputs.row(k) = (model.C * state_ + model.D * du + model.y0).transpose();
    state_ = (model.A * state_ + model.B * du).eval();
  }
  state_tick_ = segment.first_tick + segment.size();
  return outputs;
}

std::optional<double> ChampionMonitor::log_error(const storage::Archive& archive,
                                                 storage::TimeRange block) {
  const WindowRequest request = request_of(model_);
  std::variant<WindowData, UnknownParameter> loaded = UnknownParameter{};
  try {
    loaded = load_window(archive, request, block);
  } catch (const storage::Error& error) {
    if (error.kind() != storage::Error::Kind::corrupt) throw;
  }
  const auto* data = std::get_if<WindowData>(&loaded);
  if (!data) return std::nullopt;
  const identification::Record& record = data->record;
  double squares = 0;
  for (const identification::Segment& segment : record.segments) {
    const identification::Matrix errors =
        record.y.middleRows(segment.begin, segment.size()) - run(record, segment);
    for (Index q = 0; q < errors.cols(); ++q) {
      const Signal& output = model_.outputs[static_cast<std::size_t>(q)];
      const double range = std::max(output.high - output.low, least_error);
      squares += errors.col(q).squaredNorm() / (range * range);
    }
  }
  if (data->coverage < least_coverage) return std::nullopt;
  const double rms = std::sqrt(squares / static_cast<double>(record.y.size()));
  return std::log(std::max(rms, least_error));
}

std::optional<ChampionMonitor::Drift> ChampionMonitor::look(const storage::Archive& archive,
                                                            const storage::Registry& registry,
                                                            storage::Time reached,
                                                            Duration most_past) {
  const auto made = registry.champion_decision(spacecraft_, equipment_);
  if (!made) return std::nullopt;
  if (made->version != version_)
    watch(archive, *registry.version(spacecraft_, equipment_, made->version));
  if (!detector_) return std::nullopt;
  if (next_ < reached - most_past) next_ += (reached - most_past - next_) / block_ * block_;
  std::optional<Drift> drift;
  for (; next_ + block_ <= reached; next_ += block_) {
    const storage::TimeRange block{next_, next_ + block_};
    const auto error = log_error(archive, block);
    if (error && detector_->add(*error))
      drift = Drift{version_, block.end, std::exp(*error - detector_->mean())};
  }
  return drift;
}

}  // namespace reident
