// Wall time of the phases of a piece of work, in the order in which they began. It is taken from a
// clock that no adjustment of the system's time moves.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace reident {

/// At most one phase runs at a time. One thread at a time.
class PhaseTimer {
 public:
  /// Ends the running phase and begins another; a name that came before goes on counting.
  void begin(std::string_view phase) {
    end();
    for (std::size_t i = 0; i < phases_.size(); ++i)
      if (phases_[i].first == phase) running_ = i;
    if (running_ == none) {
      running_ = phases_.size();
      phases_.emplace_back(phase, 0.0);
    }
    since_ = Clock::now();
  }

  /// Ends the running phase; has no effect where none runs.
  void end() {
    if (running_ == none) return;
    phases_[running_].second +=
        std::chrono::duration<double, std::milli>(Clock::now() - since_).count();
    running_ = none;
  }

  /// Name and time [ms] of each phase; that of the running one is without its current interval.
  const std::vector<std::pair<std::string, double>>& phases() const { return phases_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::pair<std::string, double>> phases_;
  std::size_t running_ = none;
  Clock::time_point since_;
};

}  // namespace reident
