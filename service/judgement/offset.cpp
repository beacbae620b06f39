#include "service/judgement/offset.hpp"

#include <algorithm>
#include <cmath>

namespace reident {

using storage::BlockScore;

const double* effect_in(const BlockScore& score, std::size_t place) {
  const std::size_t numbers = 1 + 2 * score.square.size(), first = place * numbers;
  return first + numbers <= score.bias_effects.size() ? &score.bias_effects[first] : nullptr;
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

OffsetFit::Effect OffsetFit::effect_on(std::size_t output, const BlockScore& score) const {
  Effect effect{0, 0, score.square[output]};
  if (!past_ && output == output_) effect.head<2>() << 1, -score.mean[output];
  if (const double* known = past_ ? effect_in(score, past_->place()) : nullptr)
    effect.head<2>() << known[1 + 2 * output], known[2 + 2 * output];
  return effect;
}

void OffsetFit::add(std::size_t phase, const BlockScore& score) {
  sums_.resize(score.mean.size(), Effect::Zero());
  if (past_ && !effect_in(score, past_->place())) return;
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
  const double reach = deviations_of_sensor * past_->spread(), moved = departure_ / rows_;
  return std::clamp(offset, moved - reach, moved + reach);
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
  for (std::size_t q = 0; q < squares.size(); ++q) {
    const double known = explained(offset_in(q), effect_on(q, score));
    const double unknown = std::max(0.0, known) * (1 - known_) * (1 - known_);
    squares[q] = std::max(0.0, squares[q] - known - unknown);
  }
  return squares;
}

}  // namespace reident
