#include "service/judgement/change.hpp"

#include <algorithm>
#include <cmath>

namespace reident {

using storage::Block;
using storage::BlockScore;

namespace {

/// Mean logarithm of the roots of `squares`, none below the noise.
double mean_log_root(const std::vector<double>& squares, const std::vector<double>& noise) {
  double sum = 0;
  for (std::size_t q = 0; q < squares.size(); ++q)
    sum += std::log(std::max({squares[q], noise[q], least_square})) / 2;
  return sum / static_cast<double>(squares.size());
}

/// Share of the outputs' mean squares beyond what noise makes.
double share_above(const std::vector<double>& noise, const std::vector<double>& output_square) {
  double sum = 0;
  for (std::size_t q = 0; q < noise.size(); ++q)
    if (const double silent = deviations_of_sensor * deviations_of_sensor * noise[q];
        output_square[q] > silent)
      sum += 1 - silent / output_square[q];
  return sum / static_cast<double>(noise.size());
}

/// Whether the errors, as the mean over the outputs, exceed those of a constant at the mean of the
/// outputs so far.
bool fail(const Sums& errors, const Sums& so_far) {
  const auto variance = so_far.y_square / so_far.rows - (so_far.y / so_far.rows).square();
  return (errors.error / errors.rows / variance).log().sum() > 0;
}

}  // namespace

std::optional<storage::Time> ChangeFinder::Errors::add(const Block& block,
                                                       const BlockScore& score) {
  begins.push_back(block.range.begin);
  if (growth.add({static_cast<identification::Index>(phase_of(block)),
                  mean_log_root(score.square, score.noise),
                  mean_log_root(block.output_square, score.noise),
                  share_above(score.noise, block.output_square)}))
    return *(begins.end() - growth.blocks_since());
  if (growth.is_calm()) begins.clear();
  return std::nullopt;
}

void ChangeFinder::begin_anew(storage::Time since, storage::Time found) {
  const Change change{since, found, last_ ? last_->since : INT64_MIN};
  *this = {};
  last_ = change;
}

void ChangeFinder::add(const Block& block, const BlockScore& score, int regime, int mode) {
  if (!std::isfinite(mean_log_root(score.square, score.noise))) return;
  so_far_.add(block, score.square);
  AllErrors& all = modes_[mode];
  all.sums.add(block, score.square);
  if (!all.since) all.since = all.errors.add(block, score);
  if (!all.since && all.errors.growth.is_calm()) all.sums = {};
  if (const auto since = regimes_[regime].add(block, score))
    return begin_anew(*since, block.range.end);
  if (!all.since || all.sums.blocks < blocks_of_cycle) return;
  if (fail(all.sums, so_far_)) return begin_anew(*all.since, block.range.end);
  all.sums = {};
}

}  // namespace reident
