#include "service/satcs/faults/fault_injector.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "service/satcs/faults/fault_stage.hpp"

namespace reident::satcs {

class FaultInjector::Stages {
 public:
  Stages(std::span<const Fault> faults, std::span<const storage::ParameterDescriptor> parameters,
         const FaultInjectorOptions& options) {
    for (const Fault& fault : faults) {
      if (auto error = obstacle(fault, parameters)) throw std::invalid_argument(error->message);
      const bool of_frames = facts(fault.kind).subject == FaultFacts::Subject::frames;
      stages_.push_back(
          {fault.when, of_frames ? frame_fault(fault, options) : sample_fault(fault, parameters)});
    }
  }

  void take(storage::TelemetryFrame&& frame, std::vector<storage::TelemetryFrame>& received) {
    const storage::Time now = frame.generation_time;
    flights_.clear();
    flights_.push_back({now, frame.reception_time, std::move(frame)});
    for (const Stage& stage : stages_) {
      // All flights of a frame have its true time.
      if (now < stage.when.begin || now >= stage.when.end) continue;
      passed_.clear();
      for (Flight& flight : flights_) stage.fault->pass(std::move(flight), passed_);
      flights_.swap(passed_);
    }
    // Among equal keys the first that was inserted comes first.
    for (Flight& flight : flights_) on_the_way_.emplace(flight.arrival, std::move(flight.frame));
    release(on_the_way_.upper_bound(now), received);
  }

  void flush(std::vector<storage::TelemetryFrame>& received) {
    release(on_the_way_.end(), received);
  }

 private:
  struct Stage {
    storage::TimeRange when;
    std::unique_ptr<FaultStage> fault;
  };
  using OnTheWay = std::multimap<storage::Time, storage::TelemetryFrame>;

  void release(OnTheWay::iterator until, std::vector<storage::TelemetryFrame>& received) {
    for (auto next = on_the_way_.begin(); next != until; ++next)
      received.push_back(std::move(next->second));
    on_the_way_.erase(on_the_way_.begin(), until);
  }

  std::vector<Stage> stages_;
  std::vector<Flight> flights_, passed_;
  OnTheWay on_the_way_;  // by arrival
};

FaultInjector::FaultInjector(std::span<const Fault> faults,
                             std::span<const storage::ParameterDescriptor> parameters,
                             const FaultInjectorOptions& options)
    : stages_(std::make_unique<Stages>(faults, parameters, options)) {}
FaultInjector::~FaultInjector() = default;
FaultInjector::FaultInjector(FaultInjector&&) noexcept = default;
FaultInjector& FaultInjector::operator=(FaultInjector&&) noexcept = default;

void FaultInjector::take(storage::TelemetryFrame&& frame,
                         std::vector<storage::TelemetryFrame>& received) {
  stages_->take(std::move(frame), received);
}

void FaultInjector::flush(std::vector<storage::TelemetryFrame>& received) {
  stages_->flush(received);
}

}  // namespace reident::satcs
