#include "service/satcs/pacer.hpp"

#include <cmath>

namespace reident::satcs {

Pacer::Clock::time_point Pacer::due(storage::Time time, Clock::time_point now) {
  if (std::isinf(speed_)) return now;
  if (anchor_) {
    const double ahead_s = static_cast<double>(time - anchor_->time) * 1e-9 / speed_;
    // A wait that no clock can hold is as good as a year.
    const auto wait = std::chrono::duration<double>(std::min(ahead_s, 3.2e7));
    const auto due = anchor_->instant + std::chrono::duration_cast<Clock::duration>(wait);
    if (due >= now) return due;
    if (now - due <= std::chrono::seconds(1)) return now;
  }
  anchor_ = Anchor{time, now};
  return now;
}

}  // namespace reident::satcs
