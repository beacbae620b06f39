// From live frames to the ticks of a model's grid.
//
// The rule is that of identification/samples/grid.hpp: the value of a signal at a tick is its
// latest usable sample at or before it and younger than the sample hold; a sample that is not
// usable ends the sample hold of the one before it. A tick is given out once a frame with a later
// generation time has come, so that samples of the tick's own time that travel in several frames
// are all there. Derived inputs follow from the values of their parameters at the tick. Times of
// samples count as earlier by the model's phase.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "service/model/model_version.hpp"

namespace reident {

/// All inputs and outputs of a model at one tick.
struct Tick {
  std::int64_t number = 0;   // its time is number * period
  identification::Vector u;  // m, all finite
  identification::Vector y;  // p, NaN where the output is missing or not usable
};

/// One thread at a time. Its memory is that of the samples within a sample hold; ticks of a gap
/// cost no time.
class TelemetryTracker {
 public:
  struct Counters {
    std::uint64_t late = 0;         // samples older than a tick that was given out already
    std::uint64_t clock_jumps = 0;  // times that the telemetry's clock was taken to have gone back
  };

  /// Requires a model whose expressions can be read (version_check.hpp).
  explicit TelemetryTracker(const EquipmentModel& model);

  /// Learns the parameter's id where the model needs it. Samples of an id that nobody described are
  /// not kept.
  void describe(const storage::ParameterDescriptor& descriptor);
  /// Parameters that the model needs and whose descriptor has not come yet.
  std::vector<std::string> undescribed() const;

  /// Takes the frame's samples in, and gives out, ascending, the ticks before its generation time
  /// at which every input has a value. Frames of other spacecraft and simulated ones are ignored.
  /// Ticks are never given out twice and never go back, but for a clock that went back: 16 frames
  /// in a row that are too old for any tick show that, and all samples are forgotten. The tick is
  /// lent to `sink` until that returns.
  void add(const storage::TelemetryFrame& frame, const std::function<void(const Tick&)>& sink);

  const Counters& counters() const { return counters_; }

 private:
  struct Held {
    storage::Time time = 0;
    double value = 0;  // NaN: not usable
  };
  struct Channel {
    std::string name;
    bool described = false;
    std::uint32_t parameter = 0;
    std::vector<Held> samples;  // ascending; the first may be older than the next tick
  };

  /// Whether the frame of this time is the one that shows it.
  bool went_back(storage::Time time);
  void restart(storage::Time time);
  void store(const storage::TelemetryFrame& frame, storage::Time time);
  void insert(Channel& channel, Held held);
  /// NaN where there is no usable sample within the sample hold.
  double value_at(const Channel& channel, storage::Time time) const;
  void give_out(std::int64_t tick, const std::function<void(const Tick&)>& sink);
  /// The first tick in [tick, end) at which every parameter of the inputs has a value, or end.
  std::int64_t next_complete(std::int64_t tick, std::int64_t end) const;
  /// next_complete() for one channel.
  std::int64_t next_value(const Channel& channel, std::int64_t tick, std::int64_t end) const;
  /// Forgets what no tick at `time` or later can use.
  void forget_before(storage::Time time);

  std::string spacecraft_;
  storage::Time period_ns_;
  storage::Time sample_hold_ns_;
  storage::Time phase_ns_;
  InputExpressions expressions_;
  std::size_t inputs_;             // channels that the inputs are computed from
  std::vector<Channel> channels_;  // these, then outputs
  std::multimap<std::uint32_t, std::size_t> by_parameter_;
  bool started_ = false;
  storage::Time newest_ = 0;
  std::int64_t next_tick_ = 0;
  int frames_in_the_past_ = 0;  // in a row
  Counters counters_;
  identification::Vector parameters_;  // values of the first channels at the tick
  Tick tick_;
};

}  // namespace reident
