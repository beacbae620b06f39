#include "service/satcs/reference/reference_stream.hpp"

#include <utility>

#include "service/satcs/platform/handwritten_platform.hpp"
#include "service/satcs/platform/platform_spacecraft.hpp"
#include "service/satcs/reference/handwritten_eps.hpp"
#include "service/satcs/reference/reference_spacecraft.hpp"

namespace reident::satcs {
namespace {

/// `Model` is read and advanced second by second.
template <class Model>
class SecondsStream : public FrameStream {
 public:
  SecondsStream(Model model, const ReferenceOptions& options, Sender sender,
                std::vector<storage::ParameterDescriptor> descriptors)
      : model_(std::move(model)),
        sender_(std::move(sender)),
        descriptors_(std::move(descriptors)),
        frames_(static_cast<std::uint64_t>((options.duration_ns + 999'999'999) / 1'000'000'000)) {}

  std::vector<storage::ParameterDescriptor> parameters() const override { return descriptors_; }

  bool next(storage::TelemetryFrame& frame) override {
    if (frames_done_ == frames_) return false;
    if (frames_done_ > 0) model_.advance();
    frame.source = sender_.source;
    frame.origin = sender_.origin;
    frame.sequence = sender_.first_sequence + frames_done_;
    frame.first_sequence = sender_.first_sequence;
    frame.generation_time = frame.reception_time = model_.time();
    model_.read(frame.samples);
    ++frames_done_;
    return true;
  }

  double progress() const override {
    return static_cast<double>(frames_done_) / static_cast<double>(frames_);
  }

 private:
  Model model_;
  Sender sender_;
  std::vector<storage::ParameterDescriptor> descriptors_;
  std::uint64_t frames_;
  std::uint64_t frames_done_ = 0;
};

template <class Model, class Constants>
std::unique_ptr<FrameStream> stream_of(const Constants& constants, const ReferenceOptions& options,
                                       Sender sender,
                                       std::vector<storage::ParameterDescriptor> descriptors) {
  return std::make_unique<SecondsStream<Model>>(
      Model(constants, options.life, options.start, options.seed), options, std::move(sender),
      std::move(descriptors));
}

}  // namespace

std::unique_ptr<FrameStream> reference_stream(const ReferenceOptions& options, Sender sender) {
  auto descriptors = family_descriptors(options.family, {});
  if (options.family == Family::platform)
    return stream_of<platform::PlatformSpacecraft>(platform::Constants{}, options,
                                                   std::move(sender), std::move(descriptors));
  return stream_of<reference::Spacecraft>(options.constants, options, std::move(sender),
                                          std::move(descriptors));
}

std::unique_ptr<FrameStream> handwritten_stream(const ReferenceOptions& options, Sender sender) {
  auto descriptors = simulated_descriptors(options.family, {});
  if (options.family == Family::platform)
    return stream_of<platform::HandwrittenPlatform>(platform::Constants{}, options,
                                                    std::move(sender), std::move(descriptors));
  return stream_of<HandwrittenEps>(options.constants, options, std::move(sender),
                                   std::move(descriptors));
}

}  // namespace reident::satcs
