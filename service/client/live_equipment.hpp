// One equipment along with the satellite: live telemetry in, the model's run, free or following,
// compared with the measured outputs, and versions exchanged on the way.
#pragma once

#include <memory>
#include <optional>

#include "service/client/model_runner.hpp"
#include "service/client/running_score.hpp"
#include "service/client/telemetry_tracker.hpp"

namespace reident {

/// One thread at a time. Versions have to be sound (version_check.hpp).
class LiveEquipment {
 public:
  enum class Mode { free, following };

  /// Runs once the parameters were described, and enough ticks with all inputs and outputs came to
  /// estimate the state from.
  explicit LiveEquipment(const ModelVersion& version, Mode mode = Mode::free);

  /// Any descriptor; those that the model does not need are ignored.
  void describe(const storage::ParameterDescriptor& descriptor) { tracker_.describe(descriptor); }
  /// Any frame, in the order of reception; runs the ticks that it completes.
  void add(const storage::TelemetryFrame& frame);

  /// Runs `next` from the next tick on; the errors count from zero again. Where its signals,
  /// period and sample hold are those of the version that runs, the output continues: the swap is
  /// returned. Otherwise the run starts over with it, and the parameters must be described again.
  std::optional<ModelRunner::Swap> adopt(const ModelVersion& next);

  const ModelVersion& version() const { return runner_.model()->version(); }
  /// Errors against the measured outputs since the version was adopted.
  identification::Score score() const { return score_.score(); }
  /// Ticks at which an input was outside the identified range, since the version was adopted.
  std::uint64_t ticks_outside() const { return ticks_outside_; }
  /// Whether the last tick was corrected by measured outputs.
  bool is_following() const { return runner_.is_following(); }
  /// Times that the run had to start over because ticks were missing.
  std::uint64_t gaps() const { return gaps_; }
  const TelemetryTracker& tracker() const { return tracker_; }

 private:
  void run(const Tick& tick);
  /// After a hole the state is unknown: it is estimated from as many measured ticks as the
  /// identification's scores take, and where no output is measured the run starts at the operating
  /// point.
  void seed(const Tick& tick);
  void run_anew(const ModelVersion& version);
  void forget_state();

  Mode mode_;
  Declaration declaration_;
  TelemetryTracker tracker_;
  ModelRunner runner_;
  RunningScore score_;
  std::optional<std::int64_t> last_tick_;
  bool running_ = false;
  identification::Vector y_;
  identification::Matrix seed_u_, seed_y_;  // rows that a state is estimated from
  identification::Index seeded_ = 0;        // of these rows, the ones that are filled in
  identification::Index seed_ticks_ = 0;    // since the hole, measured or not
  std::uint64_t ticks_outside_ = 0;
  std::uint64_t gaps_ = 0;
};

}  // namespace reident
