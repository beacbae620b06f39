// A network that is cut for a while loses no telemetry: what the middleware has to keep for that
// follows from how long a cut may be and how many frames come meanwhile.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace reident::dds {

/// What a person knows.
struct NetworkCut {
  std::chrono::nanoseconds length{0};  // of the longest cut; 0: the middleware's own settings
  double frames_per_s = 0;             // that a source sends
};

/// What the middleware is given for it.
struct CutSettings {
  /// How long a participant counts on one that it does not hear. Services and sources say it of
  /// themselves: during a cut they stay connected, and go on where they were.
  std::chrono::nanoseconds lease{0};
  /// Frames that a source keeps for a service that connects again, after a cut that was longer than
  /// the lease or after a restart.
  std::int32_t history = 0;
  /// Bytes that may wait at a source for acknowledgement before it is held back.
  std::uint64_t unacknowledged_bytes = 0;
};

/// For a source whose frames have `parameters` samples. Its cut has a length above 0.
CutSettings settings_for(const NetworkCut& cut, std::size_t parameters);

}  // namespace reident::dds
