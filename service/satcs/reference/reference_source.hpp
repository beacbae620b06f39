// The reference spacecraft, and its hand-written simulation, as sources of frames at 1 Hz.
#pragma once

#include "service/satcs/frame_source.hpp"
#include "service/satcs/reference/handwritten_eps.hpp"
#include "service/satcs/reference/reference_spacecraft.hpp"

namespace reident::satcs {

/// Which flight.
struct ReferenceOptions {
  reference::Constants constants;                   // before any of `life`
  std::vector<reference::LifeEvent> life;           // events without life_mistake()
  storage::Time start = 1'498'867'200'000'000'000;  // 2017-07-01T00:00:00Z
  std::int64_t duration_ns = 86'400'000'000'000;    // frames with start <= time < start + duration
  std::uint64_t seed = 1;
};

/// `Model` is read and advanced second by second; its frames are received when they are generated.
template <class Model>
class SecondsSource : public FrameSource {
 public:
  std::vector<storage::ParameterDescriptor> parameters() const override { return descriptors_; }
  bool next(storage::TelemetryFrame& frame) override;
  double progress() const override;

 protected:
  SecondsSource(const ReferenceOptions& options, Sender sender,
                std::vector<storage::ParameterDescriptor> descriptors);

 private:
  Model model_;
  Sender sender_;
  std::vector<storage::ParameterDescriptor> descriptors_;
  std::uint64_t frames_;
  std::uint64_t frames_done_ = 0;
};

/// The spacecraft's true telemetry.
class ReferenceSource : public SecondsSource<reference::Spacecraft> {
 public:
  ReferenceSource(const ReferenceOptions& options, Sender sender);
};

/// The hand-written simulator's telemetry at the same times.
class HandwrittenSource : public SecondsSource<HandwrittenEps> {
 public:
  HandwrittenSource(const ReferenceOptions& options, Sender sender);
};

}  // namespace reident::satcs
