// The reference spacecraft as a source of frames.
#pragma once

#include "service/satcs/publisher.hpp"
#include "service/satcs/reference_spacecraft.hpp"

namespace reident::satcs {

struct ReferenceOptions {
  reference::Constants constants;
  storage::Time start = 1'498'867'200'000'000'000;  // 2017-07-01T00:00:00Z
  std::int64_t duration_ns = 86'400'000'000'000;    // frames with start <= time < start + duration
  std::uint64_t seed = 1;
};

class ReferenceSource : public FrameSource {
 public:
  explicit ReferenceSource(const ReferenceOptions& options);

  std::vector<storage::ParameterDescriptor> parameters() const override;
  bool next(storage::Time& generation_time, std::vector<storage::Sample>& samples) override;
  double progress() const override;

 private:
  reference::Spacecraft spacecraft_;
  std::uint64_t frames_;
  std::uint64_t frames_done_ = 0;
};

}  // namespace reident::satcs
