// The reference spacecraft, and its hand-written simulation, as streams of frames at 1 Hz.
#pragma once

#include <memory>

#include "service/satcs/family.hpp"
#include "service/satcs/frame_stream.hpp"
#include "service/satcs/reference/reference_life.hpp"

namespace reident::satcs {

/// Which flight.
struct ReferenceOptions {
  Family family = Family::power;
  reference::Constants constants;                   // of the power subsystem, before any of `life`
  std::vector<reference::LifeEvent> life;           // events without life_mistake()
  storage::Time start = 1'498'867'200'000'000'000;  // 2017-07-01T00:00:00Z
  std::int64_t duration_ns = 86'400'000'000'000;    // frames with start <= time < start + duration
  std::uint64_t seed = 1;
};

/// The true telemetry of the family's spacecraft; its frames are received when they are generated.
std::unique_ptr<FrameStream> reference_stream(const ReferenceOptions& options, Sender sender);
/// The hand-written simulator's telemetry at the same times.
std::unique_ptr<FrameStream> handwritten_stream(const ReferenceOptions& options, Sender sender);

}  // namespace reident::satcs
