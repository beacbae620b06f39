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

/// Returns A (n x n) with a spectral radius below 1 where it grows by less than e over so many
/// rows: they cannot tell it from equipment that integrates. Absent where it grows by more.
std::optional<Matrix> stable_over(const Matrix& A, Index rows);

/// Returns Γ of `rows` >= 1 block rows (p rows x n).
Matrix extended_observability(const Matrix& A, const Matrix& C, Index rows);

}  // namespace reident::identification
