#include "service/judgement/change.hpp"

#include <algorithm>
#include <cmath>

#include "service/judgement/scores.hpp"

namespace reident {
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

}  // namespace

void ChangeFinder::add(const storage::Block& block, const storage::BlockScore& score, int regime) {
  const double log_error = mean_log_root(score.square, score.noise);
  if (!std::isfinite(log_error)) return;
  Errors& errors = regimes_[regime];
  if (!errors.growth.add({static_cast<identification::Index>(phase_of(block)), log_error,
                          mean_log_root(block.output_square, score.noise),
                          share_above(score.noise, block.output_square)})) {
    if (errors.growth.is_calm()) errors.calm_until = block.range.end;
    return;
  }
  last_ = Change{errors.calm_until, block.range.end, last_ ? last_->since : INT64_MIN};
  regimes_.clear();
}

}  // namespace reident
