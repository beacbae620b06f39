#include "service/satcs/reference_source.hpp"

#include <utility>

namespace reident::satcs {

template <class Model>
SecondsSource<Model>::SecondsSource(const ReferenceOptions& options,
                                    std::vector<storage::ParameterDescriptor> descriptors)
    : model_(options.constants, options.life, options.start, options.seed),
      descriptors_(std::move(descriptors)),
      frames_(static_cast<std::uint64_t>((options.duration_ns + 999'999'999) / 1'000'000'000)) {}

template <class Model>
bool SecondsSource<Model>::next(storage::Time& generation_time,
                                std::vector<storage::Sample>& samples) {
  if (frames_done_ == frames_) return false;
  if (frames_done_ > 0) model_.advance();
  generation_time = model_.time();
  model_.read(samples);
  ++frames_done_;
  return true;
}

template <class Model>
double SecondsSource<Model>::progress() const {
  return static_cast<double>(frames_done_) / static_cast<double>(frames_);
}

template class SecondsSource<reference::Spacecraft>;
template class SecondsSource<HandwrittenEps>;

ReferenceSource::ReferenceSource(const ReferenceOptions& options)
    : SecondsSource(options, reference::telemetry_descriptors({})) {}

HandwrittenSource::HandwrittenSource(const ReferenceOptions& options)
    : SecondsSource(options, handwritten_descriptors({})) {}

}  // namespace reident::satcs
