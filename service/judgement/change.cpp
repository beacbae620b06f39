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

bool ChangeFinder::Errors::add(const Block& block, const BlockScore& score) {
  const bool grows = growth.add({static_cast<identification::Index>(phase_of(block)),
                                 mean_log_root(score.square, score.noise),
                                 mean_log_root(block.output_square, score.noise),
                                 share_above(score.noise, block.output_square)});
  if (!grows && growth.is_calm()) calm_until = block.range.end;
  return grows;
}

bool ChangeFinder::AllErrors::add(const Block& block, const BlockScore& score) {
  sums.add(block, score.square);
  have_grown = have_grown || errors.add(block, score);
  if (!have_grown && errors.growth.is_calm()) sums = {};
  return have_grown;
}

void ChangeFinder::begin_anew(storage::Time since, storage::Time found) {
  const Change change{since, found, last_ ? last_->since : INT64_MIN};
  *this = {};
  last_ = change;
}

void ChangeFinder::add(const Block& block, const BlockScore& score, int regime, int mode) {
  if (!std::isfinite(mean_log_root(score.square, score.noise))) return;
  so_far_.add(block, score.square);
  Errors& of_regime = regimes_[regime];
  AllErrors& all = modes_[mode];
  const bool grow_in_regime = of_regime.add(block, score), grow = all.add(block, score);
  if (grow_in_regime) return begin_anew(of_regime.calm_until, block.range.end);
  if (!grow || all.sums.blocks < blocks_of_cycle) return;
  if (fail(all.sums, so_far_)) return begin_anew(all.errors.calm_until, block.range.end);
  all.sums = {};
}

}  // namespace reident
