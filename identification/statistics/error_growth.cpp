#include "identification/statistics/error_growth.hpp"

#include <algorithm>
#include <cmath>

#include "identification/numerics/decompositions.hpp"
#include "identification/statistics/betting.hpp"

namespace reident::identification {

ErrorGrowth::ErrorGrowth(Index phases)
    : phases_(phases), next_weight_(static_cast<double>(cycles_to_measure * phases)) {}

bool ErrorGrowth::add(const BlockError& block) {
  if (detector_ && detector_->add(scaled(block), block.weight)) return true;
  record_.push_back(block);
  weight_ += block.weight;
  if (is_calm() && weight_ >= next_weight_) {
    measure_reference();
    next_weight_ = 2 * weight_;
  }
  return false;
}

/// One for each phase of the cycle, and the size of the outputs.
Vector ErrorGrowth::terms_of(const BlockError& block) const {
  Vector terms = Vector::Zero(phases_ + 1);
  terms(block.phase) = 1;
  terms(phases_) = std::clamp(block.log_output, least_output_, largest_output_) - mean_output_;
  return terms;
}

void ErrorGrowth::measure_reference() {
  const auto n = std::ssize(record_);
  Vector errors(n), outputs(n), weights(n);
  for (Index i = 0; i < n; ++i) {
    const BlockError& block = record_[static_cast<std::size_t>(i)];
    errors(i) = block.log_error;
    outputs(i) = block.log_output;
    weights(i) = block.weight;
  }
  mean_error_ = weights.dot(errors) / weights.sum();
  mean_output_ = weights.dot(outputs) / weights.sum();
  least_output_ = outputs.minCoeff();
  largest_output_ = outputs.maxCoeff();
  Matrix terms(n, phases_ + 1);
  for (Index i = 0; i < n; ++i)
    terms.row(i) = terms_of(record_[static_cast<std::size_t>(i)]).transpose();
  const Vector roots = weights.cwiseSqrt();
  const Vector errors_to_explain = roots.cwiseProduct((errors.array() - mean_error_).matrix());
  coefficients_ = solve_least_norm(roots.asDiagonal() * terms, errors_to_explain);
  scale_ = 1;
  Vector left(n);
  for (Index i = 0; i < n; ++i) left(i) = scaled(record_[static_cast<std::size_t>(i)]);
  detector_.emplace(left, weights, phases_ + 1);
  scale_ = 1 / std::sqrt(Bet({weights.cwiseProduct(left), 1, 1}).dependence());
}

double ErrorGrowth::scaled(const BlockError& block) const {
  return scale_ * (block.log_error - mean_error_ - terms_of(block).dot(coefficients_));
}

}  // namespace reident::identification
