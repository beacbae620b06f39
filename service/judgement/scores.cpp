#include "service/judgement/scores.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace reident {

using Eigen::ArrayXd;
using storage::Block;
using storage::BlockScore;

namespace {

Eigen::Map<const ArrayXd> array(const std::vector<double>& values) {
  return {values.data(), std::ssize(values)};
}

}  // namespace

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
  if (error.size() == 0) error = y = y_square = ArrayXd::Zero(std::ssize(square));
  weight *= static_cast<double>(block.rows);
  error += weight * array(square);
  y += weight * array(block.output_mean);
  y_square += weight * array(block.output_square);
  rows += weight;
  ++blocks;
}

double Sums::mrse_percent() const {
  return error.size() == 0 ? 0 : 100 * (error > 0).select(error / y_square, 0.0).sqrt().mean();
}

double Sums::fit_percent() const {
  const ArrayXd share = (error / (y_square - y.square() / rows)).sqrt();
  return share.size() == 0 ? 100 : 100 * (1 - share.maxCoeff<Eigen::PropagateNaN>());
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
