// The states of one output's dual system, whose inputs are what the output is linear in. Private to
// the library. Nothing here throws.
#pragma once

#include <utility>

#include "identification/numerics/kernels.hpp"
#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// Since C A^j B is linear in B, the regressors of a column of B are the states of
/// x[k+1] = A' x[k] + c' v[k] driven by that column's input. All inputs v at once.
class DualFilters {
 public:
  /// With A (n x n), c (n) and the first states (n x inputs).
  DualFilters(const Matrix& A, const Vector& c, Matrix states)
      : At_(A.transpose()), c_(c), states_(std::move(states)) {}

  /// Takes `count` steps, v by columns of all inputs. Writes the states before each step to `out`,
  /// `stride` doubles after those before.
  void run(const double* v, Index count, double* out, Index stride) {
    run_dual_filters(At_.data(), c_.data(), At_.rows(), states_.cols(), v, count, states_.data(),
                     out, stride);
    // A state that has died out would go on in subnormal numbers, which take a hundred times as
    // long. No sum has digits for it.
    constexpr double died_out = 1e-150;
    states_ = (states_.array().abs() < died_out).select(0, states_);
  }

 private:
  Matrix At_;
  Vector c_;
  Matrix states_;
};

}  // namespace reident::identification
