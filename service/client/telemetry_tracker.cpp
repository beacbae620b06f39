#include "service/client/telemetry_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace reident {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
// So many frames in a row that are too old to serve any tick: the clock went back.
constexpr int frames_that_prove_a_jump = 16;
// Years 1823 to 2116; sums of two such times fit in 64 bits.
constexpr storage::Time sane_time = storage::Time{1} << 62;

std::int64_t tick_at_or_after(storage::Time time, storage::Time period) {
  return time / period + (time % period > 0 ? 1 : 0);
}

bool is_usable(const storage::Sample& sample) {
  return storage::is_usable(sample.quality) && std::isfinite(sample.value);
}

}  // namespace

TelemetryTracker::TelemetryTracker(const EquipmentModel& model)
    : spacecraft_(model.spacecraft),
      period_ns_(std::max<storage::Time>(1, std::llround(model.dynamics.period_s * 1e9))),
      sample_hold_ns_(model.sample_hold_ns),
      phase_ns_(model.phase_ns.value_or(0)),
      expressions_(signal_names(model.inputs), derived_inputs(model.inputs)),
      inputs_(expressions_.parameters().size()),
      parameters_(static_cast<identification::Index>(inputs_)) {
  for (const std::string& name : expressions_.parameters()) {
    channels_.push_back({name, false, 0, {}});
  }
  for (const Signal& output : model.outputs) channels_.push_back({output.name, false, 0, {}});
  tick_.u.resize(static_cast<identification::Index>(model.inputs.size()));
  tick_.y.resize(static_cast<identification::Index>(model.outputs.size()));
}

void TelemetryTracker::describe(const storage::ParameterDescriptor& descriptor) {
  if (descriptor.spacecraft != spacecraft_) return;
  by_parameter_.clear();
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    Channel& channel = channels_[c];
    if (channel.name == descriptor.name) {
      if (channel.described && channel.parameter != descriptor.id) channel.samples.clear();
      channel.described = true;
      channel.parameter = descriptor.id;
    }
    if (channel.described) by_parameter_.emplace(channel.parameter, c);
  }
}

std::vector<std::string> TelemetryTracker::undescribed() const {
  std::vector<std::string> names;
  for (const Channel& channel : channels_) {
    if (!channel.described) names.push_back(channel.name);
  }
  return names;
}

void TelemetryTracker::add(const storage::TelemetryFrame& frame,
                           const std::function<void(const Tick&)>& sink) {
  if (frame.spacecraft != spacecraft_ || frame.origin != storage::Origin::real) return;
  if (frame.generation_time > sane_time || frame.generation_time < -sane_time) {
    ++counters_.clock_jumps;
    return;
  }
  const storage::Time time = frame.generation_time - phase_ns_;
  if (!started_ || went_back(time)) restart(time);
  newest_ = std::max(newest_, time);
  store(frame, time);

  const std::int64_t end = tick_at_or_after(newest_, period_ns_);
  for (std::int64_t tick = next_tick_; tick < end; ++tick) {
    tick = next_complete(tick, end);
    if (tick < end) give_out(tick, sink);
  }
  next_tick_ = std::max(next_tick_, end);
  forget_before(next_tick_ * period_ns_);
}

void TelemetryTracker::give_out(std::int64_t tick, const std::function<void(const Tick&)>& sink) {
  tick_.number = tick;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const double value = value_at(channels_[c], tick * period_ns_);
    const auto i = static_cast<identification::Index>(c < inputs_ ? c : c - inputs_);
    (c < inputs_ ? parameters_ : tick_.y)(i) = value;
  }
  expressions_.evaluate(parameters_, tick_.u);
  if (tick_.u.allFinite()) sink(tick_);
}

bool TelemetryTracker::went_back(storage::Time time) {
  const bool useless = time + sample_hold_ns_ < next_tick_ * period_ns_ - period_ns_;
  frames_in_the_past_ = useless ? frames_in_the_past_ + 1 : 0;
  if (frames_in_the_past_ < frames_that_prove_a_jump) return false;
  ++counters_.clock_jumps;
  return true;
}

void TelemetryTracker::restart(storage::Time time) {
  for (Channel& channel : channels_) channel.samples.clear();
  started_ = true;
  frames_in_the_past_ = 0;
  newest_ = time;
  next_tick_ = tick_at_or_after(time, period_ns_);
}

void TelemetryTracker::store(const storage::TelemetryFrame& frame, storage::Time time) {
  for (const storage::Sample& sample : frame.samples) {
    const auto [begin, end] = by_parameter_.equal_range(sample.parameter);
    for (auto entry = begin; entry != end; ++entry) {
      if (time <= (next_tick_ - 1) * period_ns_) ++counters_.late;
      insert(channels_[entry->second], {time, is_usable(sample) ? sample.value : nan});
    }
  }
}

void TelemetryTracker::insert(Channel& channel, Held held) {
  const auto place =
      std::upper_bound(channel.samples.begin(), channel.samples.end(), held.time,
                       [](storage::Time time, const Held& other) { return time < other.time; });
  if (place != channel.samples.begin() && std::prev(place)->time == held.time) {
    // A sample that comes twice is one sample; a usable value is better than none.
    if (std::isnan(std::prev(place)->value)) std::prev(place)->value = held.value;
    return;
  }
  channel.samples.insert(place, held);
}

double TelemetryTracker::value_at(const Channel& channel, storage::Time time) const {
  double value = nan;
  for (const Held& held : channel.samples) {
    if (held.time > time) break;
    value = time - held.time < sample_hold_ns_ ? held.value : nan;
  }
  return value;
}

std::int64_t TelemetryTracker::next_complete(std::int64_t tick, std::int64_t end) const {
  std::size_t complete = 0;  // inputs in a row that have a value at `tick`
  for (std::size_t c = 0; complete < inputs_ && tick < end; c = (c + 1) % inputs_) {
    const std::int64_t next = next_value(channels_[c], tick, end);
    complete = next == tick ? complete + 1 : 1;
    tick = next;
  }
  return tick;
}

std::int64_t TelemetryTracker::next_value(const Channel& channel, std::int64_t tick,
                                          std::int64_t end) const {
  while (tick < end && std::isnan(value_at(channel, tick * period_ns_))) {
    const auto next = std::find_if(
        channel.samples.begin(), channel.samples.end(),
        [&](const Held& held) { return held.time > tick * period_ns_ && !std::isnan(held.value); });
    if (next == channel.samples.end()) return end;
    // A later sample that is not usable, or a sample hold below the period, may still leave it
    // empty.
    tick = std::max(tick + 1, tick_at_or_after(next->time, period_ns_));
  }
  return std::min(tick, end);
}

void TelemetryTracker::forget_before(storage::Time time) {
  for (Channel& channel : channels_) {
    const auto later = std::find_if(channel.samples.begin(), channel.samples.end(),
                                    [time](const Held& held) { return held.time > time; });
    if (later == channel.samples.begin()) continue;
    channel.samples.erase(channel.samples.begin(), std::prev(later));
  }
}

}  // namespace reident
