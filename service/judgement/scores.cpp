#include "service/judgement/scores.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace reident {

using storage::Block;
using storage::BlockScore;

Member member_of_scores(std::int64_t version, storage::TimeRange window,
                        std::vector<BlockScore> scores) {
  const auto record = std::ranges::lower_bound(scores, window.begin, {}, &BlockScore::begin);
  Member member{version, window, {record, scores.end()}, {}};
  scores.erase(record, scores.end());
  member.earlier = std::move(scores);
  return member;
}

std::size_t phase_of(const Block& block) {
  const storage::Time length = std::max<storage::Time>(1, block.range.end - block.range.begin);
  const storage::Time phase = block.range.begin / length % blocks_of_cycle;
  return static_cast<std::size_t>(phase < 0 ? phase + blocks_of_cycle : phase);
}

bool counts(const Block& block) {
  return block.rows > 0 && block.believed >= most;
}

const BlockScore* find(const std::vector<BlockScore>& scores, storage::Time begin) {
  const auto found = std::ranges::lower_bound(scores, begin, {}, &BlockScore::begin);
  const bool is_there = found != scores.end() && found->begin == begin && found->rows > 0;
  return is_there ? &*found : nullptr;
}

Squares squares_of(const BlockScore& one, const BlockScore& other) {
  Squares squares;
  for (std::size_t q = 0; q < one.square.size(); ++q) {
    const double noise = std::max(std::min(one.noise[q], other.noise[q]), least_square);
    squares.one.push_back(std::max(one.square[q], noise));
    squares.other.push_back(std::max(other.square[q], noise));
  }
  return squares;
}

void Scores::add(Squares squares) {
  cycle_.push_back(std::move(squares));
  if (cycle_.size() > blocks_of_cycle) cycle_.pop_front();
  const std::size_t outputs = cycle_.back().one.size();
  double sum = 0;
  for (std::size_t q = 0; q < outputs; ++q) sum += score(q);
  values_.push_back(sum / static_cast<double>(outputs));
}

double Scores::score(std::size_t q) const {
  const double one = cycle_.back().one[q], other = cycle_.back().other[q];
  if (!std::isfinite(one)) return -largest_score;
  if (!std::isfinite(other)) return largest_score;
  double both = 0;
  for (const Squares& block : cycle_)
    if (std::isfinite(block.one[q] + block.other[q])) both += block.one[q] + block.other[q];
  return std::clamp((other - one) / both * static_cast<double>(cycle_.size()), -largest_score,
                    largest_score);
}

void Sums::add(const Block& block, const std::vector<double>& square, double weight) {
  error.resize(square.size(), 0);
  y.resize(square.size(), 0);
  y_square.resize(square.size(), 0);
  weight *= static_cast<double>(block.rows);
  for (std::size_t q = 0; q < square.size(); ++q) {
    error[q] += weight * square[q];
    y[q] += weight * block.output_mean[q];
    y_square[q] += weight * block.output_square[q];
  }
  rows += weight;
}

double Sums::mrse_percent() const {
  double sum = 0;
  for (std::size_t q = 0; q < error.size(); ++q) sum += std::sqrt(error[q] / y_square[q]);
  return error.empty() ? 0 : 100 * sum / static_cast<double>(error.size());
}

double Sums::fit_percent() const {
  double worst = 0;
  for (std::size_t q = 0; q < error.size(); ++q)
    if (const double of_output = std::sqrt(error[q] / (y_square[q] - y[q] * y[q] / rows));
        !(of_output <= worst))
      worst = of_output;
  return 100 * (1 - worst);
}

void Comparison::add(std::size_t place, const Block& block, const BlockScore& of_one,
                     const BlockScore& of_other) {
  blocks.push_back(place);
  scores.add(squares_of(of_one, of_other));
  one.add(block, of_one.square);
  other.add(block, of_other.square);
}

void Comparison::add(std::size_t place, const Block& block, const BlockScore& of_one,
                     const std::vector<double>& square_of_other) {
  if (square_of_other.empty()) return;
  BlockScore rival = of_one;
  rival.square = square_of_other;
  add(place, block, of_one, rival);
}

}  // namespace reident
