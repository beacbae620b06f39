#include "service/judgement/change.hpp"

#include <algorithm>
#include <cmath>

#include "identification/numerics/decompositions.hpp"
#include "identification/statistics/betting.hpp"
#include "service/judgement/scores.hpp"

namespace reident {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Vector;

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

void ChangeFinder::add(const storage::Block& block, const storage::BlockScore& score) {
  const Entry entry{phase_of(block), mean_log_root(score.square, score.noise),
                    mean_log_root(block.output_square, score.noise),
                    share_above(score.noise, block.output_square)};
  if (!std::isfinite(entry.log_error)) return;
  if (!detector_) {
    reference_.push_back(entry);
    reference_weight_ += entry.weight;
    if (reference_weight_ >= double{reference_blocks}) measure_reference();
  } else if (detector_->add(scaled(entry), entry.weight)) {
    last_ = Change{calm_until_.value_or(INT64_MIN), block.range.end};
    reference_.clear();
    reference_weight_ = 0;
    detector_.reset();
    return;
  }
  if (!detector_ || detector_->statistic() == 0) calm_until_ = block.range.end;
}

/// One for each phase of the cycle, and the size.
ChangeFinder::Terms ChangeFinder::terms_of(const Entry& entry) const {
  Terms terms = Terms::Zero();
  terms(static_cast<Index>(entry.phase)) = 1;
  terms(blocks_of_cycle) = std::clamp(entry.log_size, least_size_, largest_size_) - mean_size_;
  return terms;
}

void ChangeFinder::measure_reference() {
  const auto n = std::ssize(reference_);
  Vector errors(n), sizes(n), weights(n);
  for (Index i = 0; i < n; ++i) {
    const Entry& entry = reference_[static_cast<std::size_t>(i)];
    errors(i) = entry.log_error;
    sizes(i) = entry.log_size;
    weights(i) = entry.weight;
  }
  mean_error_ = weights.dot(errors) / weights.sum();
  mean_size_ = weights.dot(sizes) / weights.sum();
  least_size_ = sizes.minCoeff();
  largest_size_ = sizes.maxCoeff();
  Matrix terms(n, Terms::SizeAtCompileTime);
  for (Index i = 0; i < n; ++i)
    terms.row(i) = terms_of(reference_[static_cast<std::size_t>(i)]).transpose();
  const Vector roots = weights.cwiseSqrt();
  const Vector errors_to_explain = roots.cwiseProduct((errors.array() - mean_error_).matrix());
  coefficients_ = identification::solve_least_norm(roots.asDiagonal() * terms, errors_to_explain);
  scale_ = 1;
  Vector left(n);
  for (Index i = 0; i < n; ++i) left(i) = scaled(reference_[static_cast<std::size_t>(i)]);
  detector_.emplace(left, weights, Terms::SizeAtCompileTime);
  scale_ = 1 / std::sqrt(identification::dependence({weights.cwiseProduct(left), 1, 1}));
}

double ChangeFinder::scaled(const Entry& entry) const {
  return scale_ * (entry.log_error - mean_error_ - terms_of(entry).dot(coefficients_));
}

}  // namespace reident
