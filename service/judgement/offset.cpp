#include "service/judgement/offset.hpp"

#include <algorithm>
#include <cmath>

namespace reident {

using storage::BlockScore;

namespace {

/// Numbers of BlockScore::bias_effects for each sensor.
std::size_t stride(const BlockScore& score) {
  return 1 + 2 * score.square.size();
}

/// The sensor's first number; null where the record has none.
const double* effect_in(const BlockScore& score, std::size_t place) {
  const std::size_t first = place * stride(score);
  return first + stride(score) <= score.bias_effects.size() ? &score.bias_effects[first] : nullptr;
}

}  // namespace

bool has_effect(const BlockScore& score, std::size_t place) {
  return effect_in(score, place) != nullptr;
}

SensorPast::SensorPast(std::size_t place, const PhasedScores& scores) : place_(place) {
  if (scores.size() < reference_blocks) return;
  std::array<double, blocks_of_cycle> counts{};
  for (const auto& [phase, score] : scores) {
    means_[phase] += *effect_in(*score, place);
    ++counts[phase];
  }
  for (std::size_t phase = 0; phase < counts.size(); ++phase) {
    if (counts[phase] == 0) return;
    means_[phase] /= counts[phase];
  }
  double square = 0;
  std::size_t cycles = 0;
  for (std::size_t i = blocks_of_cycle; i <= scores.size(); i += blocks_of_cycle, ++cycles) {
    double sum = 0;
    for (std::size_t k = i - blocks_of_cycle; k < i; ++k)
      sum += departure(scores[k].first, *scores[k].second);
    square += sum * sum / (blocks_of_cycle * blocks_of_cycle);
  }
  spread_ = std::sqrt(square / static_cast<double>(cycles - 1));
}

double SensorPast::departure(std::size_t phase, const BlockScore& score) const {
  return *effect_in(score, place_) - means_[phase];
}

void OffsetFit::add(std::size_t phase, const BlockScore& score) {
  sums_.resize(score.mean.size());
  const double* effect = past_ ? effect_in(score, past_->place()) : nullptr;
  if (past_ && !effect) return;
  const auto rows = static_cast<double>(score.rows);
  rows_ += rows;
  if (past_) departure_ += rows * past_->departure(phase, score);
  for (std::size_t q = 0; q < sums_.size(); ++q) {
    sums_[q].error += rows * score.mean[q];
    if (!effect) continue;
    sums_[q].effect_square += rows * effect[1 + 2 * q];
    sums_[q].product += rows * effect[2 + 2 * q];
  }
}

std::vector<double> OffsetFit::rest(const BlockScore& score) const {
  std::vector<double> squares = score.square;
  if (!past_) {
    const double offset = sums_[output_].error / rows_;
    squares[output_] += offset * (offset - 2 * score.mean[output_]);
    return squares;
  }
  const double* effect = effect_in(score, past_->place());
  if (!effect) return squares;
  const double reach = deviations_of_sensor * past_->spread(), moved = departure_ / rows_;
  for (std::size_t q = 0; q < squares.size(); ++q) {
    if (!(sums_[q].effect_square > 0)) continue;
    const double offset =
        std::clamp(-sums_[q].product / sums_[q].effect_square, moved - reach, moved + reach);
    const double explained = -offset * (offset * effect[1 + 2 * q] + 2 * effect[2 + 2 * q]);
    const double unknown = std::max(0.0, explained) * (1 - known_) * (1 - known_);
    squares[q] = std::max(0.0, squares[q] - explained - unknown);
  }
  return squares;
}

}  // namespace reident
