#include "service/satcs/reference/reference_source.hpp"

#include <utility>

namespace reident::satcs {

template <class Model>
SecondsSource<Model>::SecondsSource(const ReferenceOptions& options, Sender sender,
                                    std::vector<storage::ParameterDescriptor> descriptors)
    : model_(options.constants, options.life, options.start, options.seed),
      sender_(std::move(sender)),
      descriptors_(std::move(descriptors)),
      frames_(static_cast<std::uint64_t>((options.duration_ns + 999'999'999) / 1'000'000'000)) {}

template <class Model>
bool SecondsSource<Model>::next(storage::TelemetryFrame& frame) {
  if (frames_done_ == frames_) return false;
  if (frames_done_ > 0) model_.advance();
  frame.source = sender_.source;
  frame.origin = sender_.origin;
  frame.sequence = sender_.first_sequence + frames_done_;
  frame.generation_time = frame.reception_time = model_.time();
  model_.read(frame.samples);
  ++frames_done_;
  return true;
}

template <class Model>
double SecondsSource<Model>::progress() const {
  return static_cast<double>(frames_done_) / static_cast<double>(frames_);
}

template class SecondsSource<reference::Spacecraft>;
template class SecondsSource<HandwrittenEps>;

ReferenceSource::ReferenceSource(const ReferenceOptions& options, Sender sender)
    : SecondsSource(options, std::move(sender), reference::telemetry_descriptors({})) {}

HandwrittenSource::HandwrittenSource(const ReferenceOptions& options, Sender sender)
    : SecondsSource(options, std::move(sender), handwritten_descriptors({})) {}

}  // namespace reident::satcs
