#include "service/judgement/offset.hpp"

#include <algorithm>
#include <cmath>

namespace reident {

using storage::BlockScore;

namespace {

constexpr std::size_t numbers_of_effect = 3;  // for each output
/// Variance of an effect over its square, below which it is a constant.
constexpr double constant = 1e-9;

}  // namespace

std::size_t offset_effects(const Member& member) {
  std::size_t most = 0;
  for (const BlockScore& score : member.scores)
    if (!score.square.empty())
      most = std::max(most, score.bias_effects.size() / numbers_of_effect / score.square.size());
  return most;
}

OffsetFit::Means OffsetFit::means_of(const BlockScore& score, std::size_t output) const {
  Means means{score.mean[output]};
  if (effect_ == 0) return means;
  const std::size_t place = numbers_of_effect * ((effect_ - 1) * score.square.size() + output);
  if (place + numbers_of_effect > score.bias_effects.size()) return means;
  means.effect = score.bias_effects[place];
  means.effect_square = score.bias_effects[place + 1];
  means.product = score.bias_effects[place + 2];
  return means;
}

void OffsetFit::add(const BlockScore& score) {
  sums_.resize(score.mean.size());
  const auto rows = static_cast<double>(score.rows);
  for (std::size_t q = 0; q < sums_.size(); ++q) {
    const Means means = means_of(score, q);
    sums_[q].error += rows * means.error;
    sums_[q].effect += rows * means.effect;
    sums_[q].effect_square += rows * means.effect_square;
    sums_[q].product += rows * means.product;
  }
  rows_ += rows;
}

std::vector<double> OffsetFit::rest(const BlockScore& score) const {
  std::vector<double> squares = score.square;
  for (std::size_t q = 0; q < squares.size(); ++q) {
    const Means& all = sums_[q];
    const double mean = all.effect / rows_, square = all.effect_square / rows_;
    const double variance = square - mean * mean;
    const double gain = variance > constant * square
                            ? (all.product / rows_ - mean * all.error / rows_) / variance
                            : 0;
    const double offset = all.error / rows_ - gain * mean;
    const Means here = means_of(score, q);
    squares[q] += offset * (offset - 2 * here.error);
    if (gain != 0)
      squares[q] +=
          gain * (gain * here.effect_square - 2 * here.product + 2 * offset * here.effect);
  }
  return squares;
}

}  // namespace reident
