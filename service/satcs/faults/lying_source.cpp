#include "service/satcs/faults/lying_source.hpp"

#include <utility>

namespace reident::satcs {

LyingSource::LyingSource(std::unique_ptr<FrameSource> truth, std::span<const Lie> lies,
                         const LiarOptions& options)
    : truth_(std::move(truth)), liar_(lies, truth_->parameters(), options) {}

bool LyingSource::next(storage::TelemetryFrame& frame) {
  while (handed_out_ == received_.size()) {
    received_.clear();
    handed_out_ = 0;
    if (truth_ended_) return false;
    storage::TelemetryFrame next_true;
    if (truth_->next(next_true)) {
      liar_.take(std::move(next_true), received_);
    } else {
      truth_ended_ = true;
      liar_.flush(received_);
    }
  }
  std::swap(frame, received_[handed_out_++]);
  return true;
}

}  // namespace reident::satcs
