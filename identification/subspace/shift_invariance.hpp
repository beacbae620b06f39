// From the extended observability matrix Γ = [C; CA; ...] to A and C, and back (METHOD.md,
// section 5). Nothing here throws.
#pragma once

#include <optional>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// A (n x n) and C (p x n) of a model.
struct Dynamics {
  Matrix A, C;
};

/// Whether A is taken as least squares give it.
enum class Stability {
  as_found,
  enforced,  // a zero block row below makes A stable (METHOD.md, section 7), at the price of a bias
             // where the last block row of Γ is not small
};

/// Returns the A that shifts the first `order` columns of `gamma` up by one block row of `outputs`
/// rows, by least squares, and the C above; both empty for the order 0. Requires order <=
/// gamma.rows() - outputs.
Dynamics shift_invariant(const Matrix& gamma, Index outputs, Index order,
                         Stability stability = Stability::as_found);

/// Modes that a model may have.
struct ModeLimits {
  /// A mode that grows by less than e over so many rows is taken for one that integrates; A then
  /// has a spectral radius below 1.
  Index rows = 0;
  /// |ln| [1/row] of an eigenvalue, at least.
  double least_rate = 0;
};

/// Returns the dynamics on the invariant subspace of the modes that have the rate.
Dynamics without_slow_modes(const Dynamics& dynamics, double least_rate);

/// Returns the dynamics of `order` modes within the limits: those of the fewest columns of `gamma`
/// that have so many modes of the least rate, without the slower ones. Absent where no columns have
/// them, or a mode grows by more. Requires order <= gamma.rows() - outputs.
std::optional<Dynamics> shift_invariant_within(const ModeLimits& limits, const Matrix& gamma,
                                               Index outputs, Index order, Stability stability);

/// Returns Γ of `rows` >= 1 block rows (p rows x n).
Matrix extended_observability(const Matrix& A, const Matrix& C, Index rows);

}  // namespace reident::identification
