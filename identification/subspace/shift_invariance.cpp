#include "identification/subspace/shift_invariance.hpp"

#include <cmath>

#include "identification/numerics/decompositions.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

Matrix extended_observability(const Matrix& A, const Matrix& C, Index rows) {
  const Index p = C.rows();
  Matrix gamma(rows * p, A.rows());
  gamma.topRows(p) = C;
  for (Index k = 1; k < rows; ++k)
    gamma.middleRows(k * p, p).noalias() = gamma.middleRows((k - 1) * p, p) * A;
  return gamma;
}

Dynamics shift_invariant(const Matrix& gamma, Index outputs, Index order, Stability stability) {
  const Index rows = gamma.rows() - outputs;
  if (order == 0) return {Matrix(0, 0), Matrix(outputs, 0)};
  const Matrix C = gamma.topLeftCorner(outputs, order);
  if (stability == Stability::as_found)
    return {solve_pivoted_qr(gamma.topLeftCorner(rows, order),
                             Matrix(gamma.bottomLeftCorner(rows, order))),
            C};
  Matrix shifted = Matrix::Zero(gamma.rows(), order);
  shifted.topRows(rows) = gamma.bottomLeftCorner(rows, order);
  return {solve_pivoted_qr(gamma.leftCols(order), shifted), C};
}

std::optional<Matrix> stable_over(const Matrix& A, Index rows) {
  constexpr double inside = 1 - 1e-7;
  if (!A.allFinite()) return std::nullopt;
  const double radius = spectral_radius(A);
  if (radius < 1) return A;
  if (!(std::log(radius) * double(rows) < 1)) return std::nullopt;
  return A * (inside / radius);
}

}  // namespace reident::identification
