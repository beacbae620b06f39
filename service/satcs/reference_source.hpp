// The reference spacecraft, and its hand-written simulation, as sources of frames at 1 Hz.
#pragma once

#include "service/satcs/handwritten_eps.hpp"
#include "service/satcs/publisher.hpp"
#include "service/satcs/reference_spacecraft.hpp"

namespace reident::satcs {

struct ReferenceOptions {
  reference::Constants constants;                   // before any of `life`
  std::vector<reference::LifeEvent> life;           // events without life_mistake()
  storage::Time start = 1'498'867'200'000'000'000;  // 2017-07-01T00:00:00Z
  std::int64_t duration_ns = 86'400'000'000'000;    // frames with start <= time < start + duration
  std::uint64_t seed = 1;
};

/// `Model` is read and advanced second by second.
template <class Model>
class SecondsSource : public FrameSource {
 public:
  std::vector<storage::ParameterDescriptor> parameters() const override { return descriptors_; }
  bool next(storage::Time& generation_time, std::vector<storage::Sample>& samples) override;
  double progress() const override;

 protected:
  SecondsSource(const ReferenceOptions& options,
                std::vector<storage::ParameterDescriptor> descriptors);

 private:
  Model model_;
  std::vector<storage::ParameterDescriptor> descriptors_;
  std::uint64_t frames_;
  std::uint64_t frames_done_ = 0;
};

class ReferenceSource : public SecondsSource<reference::Spacecraft> {
 public:
  explicit ReferenceSource(const ReferenceOptions& options);
};

class HandwrittenSource : public SecondsSource<HandwrittenEps> {
 public:
  explicit HandwrittenSource(const ReferenceOptions& options);
};

}  // namespace reident::satcs
