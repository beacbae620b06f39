// A stream of frames as the ground receives it through a FaultInjector.
#pragma once

#include <memory>
#include <vector>

#include "service/satcs/faults/fault_injector.hpp"
#include "service/satcs/frame_stream.hpp"

namespace reident::satcs {

/// Frames in the order of reception, with their senders. Progress is that of the truth.
class FaultyStream : public FrameStream {
 public:
  /// Owns the truth. Throws std::invalid_argument when a fault cannot be applied to it.
  FaultyStream(std::unique_ptr<FrameStream> truth, std::span<const Fault> faults,
               const FaultInjectorOptions& options);

  std::vector<storage::ParameterDescriptor> parameters() const override {
    return truth_->parameters();
  }
  bool next(storage::TelemetryFrame& frame) override;
  double progress() const override { return truth_->progress(); }

 private:
  std::unique_ptr<FrameStream> truth_;
  FaultInjector injector_;
  std::vector<storage::TelemetryFrame> received_;
  std::size_t handed_out_ = 0;  // of those received
  bool truth_ended_ = false;
};

}  // namespace reident::satcs
