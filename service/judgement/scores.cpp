#include "service/judgement/scores.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace reident {

using storage::Block;
using storage::BlockScore;

std::size_t phase_of(const Block& block) {
  const storage::Time length = std::max<storage::Time>(1, block.range.end - block.range.begin);
  const storage::Time place = block.range.begin / length % blocks_of_cycle;  // may be negative
  return static_cast<std::size_t>(place + blocks_of_cycle) % blocks_of_cycle;
}

bool counts(const Block& block) {
  return block.rows > 0 && block.believed >= most;
}

const BlockScore* find(const std::vector<BlockScore>& scores, storage::Time begin) {
  if (scores.empty() || begin < scores.front().begin || begin > scores.back().begin) return nullptr;
  // Behind the blocks of before, a record has hardly a hole.
  const auto last = scores.end() - 1;
  const auto length = scores.size() > 1 ? last->begin - (last - 1)->begin : 1;
  auto found = last - std::min(last - scores.begin(), (last->begin - begin) / length);
  if (found->begin != begin)
    found = std::ranges::lower_bound(scores, begin, {}, &BlockScore::begin);
  return found->begin == begin && found->rows > 0 ? &*found : nullptr;
}

void Scores::add(Squares squares) {
  cycle_.push_back(std::move(squares));
  if (cycle_.size() > blocks_of_cycle) cycle_.pop_front();
  const std::size_t outputs = cycle_.back().size();
  double sum = 0;
  for (std::size_t q = 0; q < outputs; ++q) sum += score(q);
  values_.push_back(sum / static_cast<double>(outputs));
}

double Scores::score(std::size_t q) const {
  const auto [one, other] = cycle_.back()[q];
  if (!std::isfinite(one)) return -largest_score;
  if (!std::isfinite(other)) return largest_score;
  double both = 0;
  for (const Squares& block : cycle_)
    if (const double sum = block[q].first + block[q].second; std::isfinite(sum)) both += sum;
  return std::clamp((other - one) / both * static_cast<double>(cycle_.size()), -largest_score,
                    largest_score);
}

void Sums::add(const Block& block, const std::vector<double>& square, double weight) {
  const auto array = [](const std::vector<double>& values) {
    return Eigen::Map<const Eigen::ArrayXd>(values.data(), std::ssize(values));
  };
  if (error.size() == 0) error = y = y_square = Eigen::ArrayXd::Zero(std::ssize(square));
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
  const Eigen::ArrayXd share = (error / (y_square - y.square() / rows)).sqrt();
  return share.size() == 0 ? 100 : 100 * (1 - share.maxCoeff<Eigen::PropagateNaN>());
}

void Comparison::add(std::size_t place, const Block& block, const BlockScore& of_one,
                     const BlockScore& of_other, const std::vector<double>& square_of_other) {
  if (square_of_other.empty()) return;
  Scores::Squares squares;
  for (std::size_t q = 0; q < square_of_other.size(); ++q) {
    const double noise = std::max(std::min(of_one.noise[q], of_other.noise[q]), least_square);
    squares.emplace_back(std::max(of_one.square[q], noise), std::max(square_of_other[q], noise));
  }
  blocks.push_back(place);
  scores.add(std::move(squares));
  one.add(block, of_one.square);
  other.add(block, square_of_other);
}

}  // namespace reident
