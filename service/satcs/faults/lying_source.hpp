// A source of frames as the ground receives it through a Liar.
#pragma once

#include <memory>
#include <vector>

#include "service/satcs/faults/lies.hpp"
#include "service/satcs/frame_source.hpp"

namespace reident::satcs {

class LyingSource : public FrameSource {
 public:
  /// Throws std::invalid_argument when a lie cannot be told about the truth.
  LyingSource(std::unique_ptr<FrameSource> truth, std::span<const Lie> lies,
              const LiarOptions& options);

  std::vector<storage::ParameterDescriptor> parameters() const override {
    return truth_->parameters();
  }
  bool next(storage::TelemetryFrame& frame) override;
  double progress() const override { return truth_->progress(); }

 private:
  std::unique_ptr<FrameSource> truth_;
  Liar liar_;
  std::vector<storage::TelemetryFrame> received_;
  std::size_t handed_out_ = 0;  // of those received
  bool truth_ended_ = false;
};

}  // namespace reident::satcs
