#include "service/judgement/change.hpp"

#include <algorithm>
#include <cmath>

#include "identification/statistics/betting.hpp"
#include "service/judgement/scores.hpp"

namespace reident {
namespace {

using identification::Index;
using identification::Vector;

double log_error_of(const storage::BlockScore& score) {
  double sum = 0;
  for (std::size_t q = 0; q < score.square.size(); ++q)
    sum += std::log(std::max({score.square[q], score.noise[q], least_square})) / 2;
  return sum / static_cast<double>(score.square.size());
}

}  // namespace

void ChangeFinder::add(const storage::Block& block, const storage::BlockScore& score) {
  const double log_error = log_error_of(score);
  if (!std::isfinite(log_error)) return;
  const Entry entry{phase_of(block), log_error};
  if (!detector_) {
    reference_.push_back(entry);
    if (reference_.size() == reference_blocks) measure_reference();
  } else if (detector_->add(scaled(entry))) {
    last_ = Change{calm_until_.value_or(INT64_MIN), block.range.end};
    reference_.clear();
    detector_.reset();
    return;
  }
  if (!detector_ || detector_->statistic() == 0) calm_until_ = block.range.end;
}

void ChangeFinder::measure_reference() {
  std::array<double, blocks_of_cycle> sums{}, counts{};
  double mean = 0;
  for (const Entry& entry : reference_) {
    sums[entry.phase] += entry.log_error;
    ++counts[entry.phase];
    mean += entry.log_error / static_cast<double>(reference_.size());
  }
  for (std::size_t phase = 0; phase < means_.size(); ++phase)
    means_[phase] = counts[phase] > 0 ? sums[phase] / counts[phase] : mean;
  scale_ = 1;
  Vector left(std::ssize(reference_));
  for (Index i = 0; i < left.size(); ++i) left(i) = scaled(reference_[static_cast<std::size_t>(i)]);
  detector_.emplace(left);
  scale_ = 1 / std::sqrt(identification::dependence({left, 1, 1}));
}

double ChangeFinder::scaled(const Entry& entry) const {
  return scale_ * (entry.log_error - means_[entry.phase]);
}

}  // namespace reident
