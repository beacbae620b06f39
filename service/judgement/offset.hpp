// What an offset of one sensor explains of a run's errors.
//
// An offset of an output's sensor is a constant in that output's error; so is one of an input's
// sensor, through the model's static gain. Where a derived input is computed from the sensor, its
// effect varies with the other values, as BlockScore::bias_effects says.
#pragma once

#include <cstddef>
#include <vector>

#include "service/judgement/scores.hpp"

namespace reident {

/// Sensors of which the record has effects of their own.
std::size_t offset_effects(const Member& member);

/// Fit of the errors of a run on some blocks by a constant and an effect, for each output.
class OffsetFit {
 public:
  /// `effect` is 0 for the constant alone, k for it and the effect of the k-th sensor.
  explicit OffsetFit(std::size_t effect) : effect_(effect) {}

  /// Takes in a block; one with other effects counts for the constant.
  void add(const storage::BlockScore& score);
  /// The mean squares of a block's errors without what is explained.
  std::vector<double> rest(const storage::BlockScore& score) const;

 private:
  /// Of an output: means, or their sums over rows.
  struct Means {
    double error = 0, effect = 0, effect_square = 0, product = 0;
  };
  Means means_of(const storage::BlockScore& score, std::size_t output) const;

  std::size_t effect_;
  std::vector<Means> sums_;
  double rows_ = 0;
};

}  // namespace reident
