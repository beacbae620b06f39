// Publishes a stream of telemetry as SATCS frames and parameter descriptors: paced, no faster than
// the readers take it, and with a clean end wherever it is stopped.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "service/dds/dds.hpp"
#include "service/dds/network_cut.hpp"
#include "service/satcs/frame_stream.hpp"
#include "service/satcs/unheard_frames.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs {

/// How frames are published.
struct PublisherOptions {
  dds::Endpoint endpoint;
  std::string spacecraft;
  double speed = 1;  // seconds of telemetry a second; infinity: as fast as the readers take it
  /// No frame is written while fewer readers are there, or none of them is an archive (a reader
  /// that keeps all); 0: whoever is there.
  std::uint32_t wait_readers = 1;
  /// How long to wait for the readers, and for their last acknowledgments; absent: for ever.
  std::optional<std::chrono::nanoseconds> wait_timeout;
  /// Frames kept for readers that join late; absent: what the cut needs, or else more than the
  /// middleware ever has on the way, so that a reader that is stopped and started again misses
  /// nothing.
  std::optional<std::int32_t> history;
  dds::NetworkCut cut;  // that loses no frame
  /// How long the frames that are kept stay available after the last one.
  std::chrono::nanoseconds linger{0};
};

/// How a publication ended.
enum class Outcome {
  complete,          // every reader has acknowledged every frame
  stopped,           // asked to stop before that
  no_readers,        // too few readers within the time-out
  not_acknowledged,  // readers did not take everything within the time-out
};
/// "complete", "stopped", "no_readers" or "not_acknowledged".
std::string_view name(Outcome outcome);

/// What was published.
struct PublisherSummary {
  Outcome outcome = Outcome::complete;
  std::uint64_t parameters = 0;
  std::uint64_t frames = 0;
  std::uint64_t samples = 0;
  std::uint64_t invalid_samples = 0;
  // The first and the last frame that was published; 0 when there are none.
  std::uint64_t first_sequence = 0;
  std::uint64_t last_sequence = 0;
  storage::Time first_time = 0;
  storage::Time last_time = 0;
  /// Frames that no archive can have: none listened when they were sent, and when one came they had
  /// left the history, or none came.
  std::uint64_t frames_missed = 0;
  double wall_s = 0;  // time that it took, waiting included
  /// Frames that no reader heard and that cannot be sent again.
  std::vector<LostFrames> lost;
};

/// Publishes all frames of `stream` in its order. Each sender's frames are paced by its own
/// reception times. A stop ends it within some 100 ms, wherever it is; frames that were written
/// till then stay sent. Shows a progress bar on a terminal. Throws dds::Error when the middleware
/// fails, and what the stream throws.
PublisherSummary publish(FrameStream& stream, const PublisherOptions& options,
                         const std::stop_token& stop);

}  // namespace reident::satcs
