#include "service/satcs/faults/faulty_stream.hpp"

#include <utility>

namespace reident::satcs {

FaultyStream::FaultyStream(std::unique_ptr<FrameStream> truth, std::span<const Fault> faults,
                           const FaultInjectorOptions& options)
    : truth_(std::move(truth)), injector_(faults, truth_->parameters(), options) {}

bool FaultyStream::next(storage::TelemetryFrame& frame) {
  while (handed_out_ == received_.size()) {
    received_.clear();
    handed_out_ = 0;
    if (truth_ended_) return false;
    storage::TelemetryFrame next_true;
    if (truth_->next(next_true)) {
      injector_.take(std::move(next_true), received_);
    } else {
      truth_ended_ = true;
      injector_.flush(received_);
    }
  }
  std::swap(frame, received_[handed_out_++]);
  return true;
}

}  // namespace reident::satcs
