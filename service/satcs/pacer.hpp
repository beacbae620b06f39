// When each frame is due, for a telemetry source that runs at a multiple of real time.
#pragma once

#include <chrono>
#include <optional>

#include "storage/types/telemetry.hpp"

namespace reident::satcs {

/// The pace of one sender's frames. It does not wait by itself, and `now` is given: tests need no
/// clock.
class Pacer {
 public:
  using Clock = std::chrono::steady_clock;

  /// `speed` > 0: seconds of telemetry a second; infinity for as fast as the readers take it.
  explicit Pacer(double speed) : speed_(speed) {}

  /// The instant at which the frame of this time is due, `now` at the earliest. A source that is
  /// more than a second late, or whose time jumps back, goes on at its speed from here.
  Clock::time_point due(storage::Time time, Clock::time_point now);

 private:
  struct Anchor {
    storage::Time time;
    Clock::time_point instant;
  };
  double speed_;
  std::optional<Anchor> anchor_;
};

}  // namespace reident::satcs
