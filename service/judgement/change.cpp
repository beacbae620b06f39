#include <algorithm>
#include <array>
#include <cmath>

#include "identification/statistics/betting.hpp"
#include "identification/statistics/change_detection.hpp"
#include "service/judgement/league.hpp"

namespace reident {
namespace {

using identification::dependence;
using identification::Index;
using identification::Vector;
using storage::Block;
using storage::BlockScore;
using storage::Time;

/// Cycles of the champion's record that a change is measured against.
constexpr int reference_cycles = 8;

double log_error(const BlockScore& score) {
  double sum = 0;
  for (std::size_t q = 0; q < score.square.size(); ++q)
    sum += std::log(std::max({score.square[q], score.noise[q], least_square})) / 2;
  return sum / static_cast<double>(score.square.size());
}

/// Finds growth of the logarithms of a run's errors, each beside those of its phase of the cycle.
class GrowthDetector {
 public:
  /// Returns whether a change is found. It measures against the first cycles that it is given.
  bool add(std::size_t phase, double log_error) {
    if (!detector_) {
      reference_.push_back({phase, log_error});
      if (std::ssize(reference_) == reference_cycles * blocks_of_cycle) begin();
      return false;
    }
    return detector_->add(scaled(phase, log_error));
  }
  /// Whether nothing speaks for a change.
  bool is_calm() const { return !detector_ || detector_->statistic() == 0; }

 private:
  struct Entry {
    std::size_t phase;
    double log_error;
  };
  void begin() {
    std::array<double, blocks_of_cycle> counts{};
    for (const Entry& entry : reference_) {
      means_[entry.phase] += entry.log_error;
      ++counts[entry.phase];
    }
    for (std::size_t phase = 0; phase < means_.size(); ++phase)
      if (counts[phase] > 0) means_[phase] /= counts[phase];
    Vector left(std::ssize(reference_));
    for (Index i = 0; i < left.size(); ++i) {
      const Entry& entry = reference_[static_cast<std::size_t>(i)];
      left(i) = scaled(entry.phase, entry.log_error);
    }
    detector_.emplace(left);
    scale_ = 1 / std::sqrt(dependence({left, 1, 1}));
  }
  double scaled(std::size_t phase, double log_error) const {
    return scale_ * (log_error - means_[phase]);
  }

  std::vector<Entry> reference_;
  std::array<double, blocks_of_cycle> means_{};
  double scale_ = 1;
  std::optional<identification::ChangeDetector> detector_;
};

}  // namespace

std::optional<Change> change_of(const League& league) {
  if (!league.champion) return std::nullopt;
  std::optional<Change> change;
  GrowthDetector detector;
  Time since = INT64_MIN;
  for (const Block& block : league.blocks) {
    const BlockScore* score = counts(block) ? find(*league.champion, block.range.begin) : nullptr;
    if (!score) continue;
    const double error = log_error(*score);
    if (!std::isfinite(error)) continue;
    const Duration length = block.range.end - block.range.begin;
    const auto phase = static_cast<std::size_t>(block.range.begin / length % blocks_of_cycle);
    if (detector.add(phase, error)) {
      change = Change{since, block.range.end};
      detector = {};
    } else if (detector.is_calm()) {
      since = block.range.end;
    }
  }
  return change;
}

}  // namespace reident
