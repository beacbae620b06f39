#include "service/judgement/offset.hpp"

#include <algorithm>
#include <cmath>

namespace reident {

using storage::BlockScore;

SensorPast::SensorPast(std::size_t place, std::size_t biases, const PhasedScores& scores)
    : place_(place), biases_(biases) {
  if (scores.size() < reference_blocks) return;
  std::array<double, blocks_of_cycle> counts{};
  for (const auto& [phase, score] : scores) {
    means_[phase] += *effect_in(*score);
    ++counts[phase];
  }
  if (std::ranges::count(counts, 0) > 0) return;
  for (std::size_t phase = 0; phase < counts.size(); ++phase) means_[phase] /= counts[phase];
  double square = 0;
  for (std::size_t i = blocks_of_cycle; i <= scores.size(); i += blocks_of_cycle) {
    double sum = 0;
    for (std::size_t k = i - blocks_of_cycle; k < i; ++k)
      sum += departure(scores[k].first, *scores[k].second);
    square += sum * sum / (blocks_of_cycle * blocks_of_cycle);
  }
  spread_ = std::sqrt(square / static_cast<double>(scores.size() / blocks_of_cycle - 1));
}

OffsetFit::Effect OffsetFit::effect_on(std::size_t output, const BlockScore& score) const {
  Effect effect{0, 0, score.square[output]};
  if (!past_ && output == output_) effect.head<2>() << 1, -score.mean[output];
  if (const double* known = past_ ? past_->effect_in(score) : nullptr)
    effect.head<2>() << known[1 + 2 * output], known[2 + 2 * output];
  return effect;
}

void OffsetFit::add(std::size_t phase, const BlockScore& score) {
  sums_.resize(score.mean.size(), Effect::Zero());
  if (past_ && !past_->effect_in(score)) return;
  const auto rows = static_cast<double>(score.rows);
  rows_ += rows;
  if (past_) departure_ += rows * past_->departure(phase, score);
  for (std::size_t q = 0; q < sums_.size(); ++q) sums_[q] += rows * effect_on(q, score);
}

double OffsetFit::offset_in(std::size_t output) const {
  const Effect& effect = sums_[output];
  if (!(effect[0] > 0)) return 0;
  const double offset = -effect[1] / effect[0];
  if (!past_) return offset;
  const double reach = deviations_of_sensor * past_->spread(), moved = departure_ / rows_,
               low = std::max<double>(moved - reach, direction_ > 0 ? 0 : -INFINITY),
               high = std::min<double>(moved + reach, direction_ < 0 ? 0 : INFINITY);
  return low <= high ? std::clamp(offset, low, high) : 0;
}

double OffsetFit::offset() const {
  double offset = 0, most_explained = 0;
  for (std::size_t q = 0; q < sums_.size(); ++q) {
    const double found = offset_in(q), share = explained(found, sums_[q]) / sums_[q][2];
    if (share > most_explained) offset = found, most_explained = share;
  }
  return offset;
}

std::vector<double> OffsetFit::rest(const BlockScore& score) const {
  std::vector<double> squares = score.square;
  for (std::size_t q = 0; q < squares.size(); ++q)
    squares[q] = std::max(0.0, squares[q] - explained(offset_in(q), effect_on(q, score)));
  return squares;
}

}  // namespace reident
