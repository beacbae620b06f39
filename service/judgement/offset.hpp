// What an offset of one sensor explains of a run's errors.
//
// An offset of an output's sensor is a constant in that output's error. One of an input's sensor
// has the effect that BlockScore::bias_effects says, and its own values show how large it may be.
// Where the effect is no multiple of the offset, it has one of its sizes, which is scaled.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "service/judgement/scores.hpp"
#include "service/windows/member_run.hpp"

namespace reident {

/// Scores of blocks with the places of these in their cycles.
using PhasedScores = std::vector<std::pair<std::size_t, const storage::BlockScore*>>;

/// The means of an inputs' sensor in the cycles of which nobody doubts it.
class SensorPast {
 public:
  /// Measures the sensor of the bias at `place` of so many in these blocks of a record, which have
  /// its effect; fewer than reference_blocks say nothing.
  SensorPast(std::size_t place, std::size_t biases, const PhasedScores& scores);

  const double* effect_in(const storage::BlockScore& score) const {
    return bias_effect_in(score, place_, biases_);
  }
  /// How far its mean on the block is from that of its phase. Requires the effect.
  double departure(std::size_t phase, const storage::BlockScore& score) const {
    return *effect_in(score) - means_[phase];
  }
  /// Deviation of the departures of whole cycles; infinite where nothing is known.
  double spread() const { return spread_; }

 private:
  std::size_t place_, biases_;
  std::array<double, blocks_of_cycle> means_{};
  double spread_ = std::numeric_limits<double>::infinity();
};

/// Fit of the errors of a run by an offset of one sensor: the same one on all blocks.
class OffsetFit {
 public:
  /// An output's sensor adds a constant to that output.
  explicit OffsetFit(std::size_t output) : output_(output) {}
  /// An inputs' sensor may be off as far as its past allows, within three of its spreads, in the
  /// `direction` of its bias (SensorBias). `past` must outlive the fit.
  OffsetFit(const SensorPast& past, int direction) : past_(&past), direction_(direction) {}

  /// Takes in a block; one without the sensor's effect says nothing.
  void add(std::size_t phase, const storage::BlockScore& score);
  /// The mean squares of a block's errors without what is explained.
  std::vector<double> rest(const storage::BlockScore& score) const;
  /// How far the sensor would read too high, in its unit; 0 where that explains nothing. The output
  /// whose error it explains most says so.
  double offset() const;

 private:
  /// Mean square of what one unit of the offset takes from an output's error, its mean product with
  /// the error, and the error's mean square.
  using Effect = Eigen::Array3d;

  static double explained(double offset, const Effect& effect) {
    return -offset * (offset * effect[0] + 2 * effect[1]);
  }
  Effect effect_on(std::size_t output, const storage::BlockScore& score) const;
  double offset_in(std::size_t output) const;

  std::size_t output_ = 0;
  const SensorPast* past_ = nullptr;  // null where the sensor is the output's
  int direction_ = 0;
  std::vector<Effect> sums_;         // by output, times rows
  double rows_ = 0, departure_ = 0;  // times rows
};

}  // namespace reident
