// Telemetry as a stream of frames: what it has and in which order, whoever publishes or writes it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::satcs {

/// Who sends the frames of a stream, and from which number on it counts them.
struct Sender {
  std::string source;
  storage::Origin origin = storage::Origin::real;
  std::uint64_t first_sequence = 1;
};

/// Where frames come from: a recorded file, the reference spacecraft. It is read once, forward, by
/// one thread at a time.
class FrameStream {
 public:
  virtual ~FrameStream() = default;

  /// What the samples are; whoever sends them on fills in the spacecraft.
  virtual std::vector<storage::ParameterDescriptor> parameters() const = 0;
  /// All of the next frame but its spacecraft, in the order of reception; false when there is none.
  /// The frame's memory is used again. Throws std::runtime_error when the stream breaks.
  virtual bool next(storage::TelemetryFrame& frame) = 0;
  /// The share of the stream that was handed out, in [0, 1].
  virtual double progress() const = 0;
};

}  // namespace reident::satcs
