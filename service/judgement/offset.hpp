// What an offset of one sensor explains of a run's errors.
//
// An offset of an output's sensor is a constant in that output's error; so is one of an input's
// sensor, through the model's static gain. Where a derived input is computed from the sensor, its
// effect varies with the other values, as BlockScore::bias_effects says; and such a sensor shows in
// its own values how large the offset may be.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "service/judgement/scores.hpp"

namespace reident {

/// Whether the score says what a bias of the sensor `effect`, from 1, does.
bool has_effect(const storage::BlockScore& score, std::size_t effect);

/// The means of such a sensor's values in the cycles of which nobody doubts it.
class SensorPast {
 public:
  /// Nothing is known.
  SensorPast() = default;
  /// Measures the sensor `effect`, from 1, in these blocks of a record, which have its effect;
  /// fewer than reference_blocks say nothing.
  SensorPast(std::size_t effect, const std::vector<std::size_t>& phases,
             const std::vector<const storage::BlockScore*>& scores);

  /// How far its mean on the block is from that of its phase. Requires the effect.
  double departure(std::size_t phase, const storage::BlockScore& score) const;
  /// Deviation of the departures of whole cycles; infinite where nothing is known.
  double spread() const { return spread_; }

 private:
  std::size_t effect_ = 1;
  std::array<double, blocks_of_cycle> means_{};
  double spread_ = std::numeric_limits<double>::infinity();
};

/// Fit of the errors of a run on the blocks of a cycle by an offset: by a constant for each output,
/// or by the effect of a sensor's offset that its past allows, within three of its spreads.
class OffsetFit {
 public:
  /// `past` must outlive it.
  OffsetFit(std::size_t effect, const SensorPast& past) : effect_(effect), past_(&past) {}

  /// Takes in a block; one without the sensor's effect says nothing.
  void add(std::size_t phase, const storage::BlockScore& score);
  /// The mean squares of a block's errors without what is explained.
  std::vector<double> rest(const storage::BlockScore& score) const;

 private:
  struct Sums {
    double error = 0, effect_square = 0, product = 0;
  };

  std::size_t effect_ = 0;
  const SensorPast* past_ = nullptr;
  std::vector<Sums> sums_;  // by output
  double rows_ = 0;
  double departure_ = 0;  // times rows
};

}  // namespace reident
