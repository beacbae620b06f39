#include "identification/subspace/shift_invariance.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/schur_blocks.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {
namespace {

Index slow_modes(const ComplexVector& modes, double least_rate) {
  return std::count_if(modes.begin(), modes.end(), [least_rate](const std::complex<double>& mode) {
    return std::abs(std::log(mode)) < least_rate;
  });
}

std::optional<Dynamics> stable_over(Dynamics dynamics, double radius, Index rows) {
  constexpr double inside = 1 - 1e-7;
  if (radius < 1) return dynamics;
  if (!(std::log(radius) * double(rows) < 1)) return std::nullopt;
  dynamics.A *= inside / radius;
  return dynamics;
}

}  // namespace

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

Dynamics without_slow_modes(const Dynamics& dynamics, double least_rate) {
  SchurBlocks blocks(dynamics.A);
  Index kept = 0, rows = 0;
  for (Index block = 0; block < blocks.count(); ++block) {
    if (std::abs(std::log(blocks.eigenvalue(block))) < least_rate) continue;
    rows += blocks.size(block);
    for (Index at = block; at > kept; --at) blocks.swap_with_next(at - 1);
    ++kept;
  }
  return {blocks.T().topLeftCorner(rows, rows), dynamics.C * blocks.Q().leftCols(rows)};
}

std::optional<Dynamics> shift_invariant_within(const ModeLimits& limits, const Matrix& gamma,
                                               Index outputs, Index order, Stability stability) {
  // Each output may drift by itself.
  const Index most =
      limits.least_rate > 0 ? std::min(order + outputs, gamma.cols() - outputs) : order;
  for (Index columns = order; columns <= most; ++columns) {
    Dynamics found = shift_invariant(gamma, outputs, columns, stability);
    if (order == 0) return found;
    if (!found.A.allFinite()) return std::nullopt;
    const ComplexVector modes = eigenvalues(found.A);
    if (!modes.allFinite()) return std::nullopt;
    const Index slow = slow_modes(modes, limits.least_rate);
    if (columns - slow < order) continue;
    if (columns - slow > order) return std::nullopt;  // a pair came in
    if (slow == 0) return stable_over(std::move(found), modes.cwiseAbs().maxCoeff(), limits.rows);
    Dynamics fast = without_slow_modes(found, limits.least_rate);
    if (fast.A.rows() != order) return std::nullopt;
    const double radius = spectral_radius(fast.A);
    return stable_over(std::move(fast), radius, limits.rows);
  }
  return std::nullopt;
}

}  // namespace reident::identification
