#include "service/satcs/faults/lies.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "service/satcs/faults/lie_stage.hpp"

namespace reident::satcs {

class Liar::Stages {
 public:
  Stages(std::span<const Lie> lies, std::span<const storage::ParameterDescriptor> parameters,
         const LiarOptions& options) {
    for (const Lie& lie : lies) {
      if (auto error = obstacle(lie, parameters)) throw std::invalid_argument(error->message);
      const bool of_frames = facts(lie.kind).subject == LieFacts::Subject::frames;
      stages_.push_back(
          {lie.when, of_frames ? frame_lie(lie, options) : sample_lie(lie, parameters)});
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
      for (Flight& flight : flights_) stage.lie->pass(std::move(flight), passed_);
      flights_.swap(passed_);
    }
    // Of equal keys the first that was inserted comes first.
    for (Flight& flight : flights_) on_the_way_.emplace(flight.arrival, std::move(flight.frame));
    release(on_the_way_.upper_bound(now), received);
  }

  void flush(std::vector<storage::TelemetryFrame>& received) {
    release(on_the_way_.end(), received);
  }

 private:
  struct Stage {
    storage::TimeRange when;
    std::unique_ptr<LieStage> lie;
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

Liar::Liar(std::span<const Lie> lies, std::span<const storage::ParameterDescriptor> parameters,
           const LiarOptions& options)
    : stages_(std::make_unique<Stages>(lies, parameters, options)) {}
Liar::~Liar() = default;
Liar::Liar(Liar&&) noexcept = default;
Liar& Liar::operator=(Liar&&) noexcept = default;

void Liar::take(storage::TelemetryFrame&& frame, std::vector<storage::TelemetryFrame>& received) {
  stages_->take(std::move(frame), received);
}

void Liar::flush(std::vector<storage::TelemetryFrame>& received) {
  stages_->flush(received);
}

}  // namespace reident::satcs
