#include "service/satcs/reference_source.hpp"

namespace reident::satcs {

ReferenceSource::ReferenceSource(const ReferenceOptions& options)
    : spacecraft_(options.constants, options.start, options.seed),
      frames_(static_cast<std::uint64_t>((options.duration_ns + 999'999'999) / 1'000'000'000)) {}

std::vector<storage::ParameterDescriptor> ReferenceSource::parameters() const {
  return reference::telemetry_descriptors({});
}

bool ReferenceSource::next(storage::Time& generation_time, std::vector<storage::Sample>& samples) {
  if (frames_done_ == frames_) return false;
  if (frames_done_ > 0) spacecraft_.advance();
  generation_time = spacecraft_.time();
  spacecraft_.read(samples);
  ++frames_done_;
  return true;
}

double ReferenceSource::progress() const {
  return static_cast<double>(frames_done_) / static_cast<double>(frames_);
}

}  // namespace reident::satcs
