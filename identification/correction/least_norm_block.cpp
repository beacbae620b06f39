#include "identification/correction/least_norm_block.hpp"

#include <algorithm>
#include <cmath>

namespace reident::identification {
namespace {

constexpr double end = 1 - 1e-12;  // of the multiplier
constexpr int halvings = 60;

/// With the weights w1 = r, w2 = 1 / r of the rows and the multiplier mu of the determinant, the
/// stationary point of
///   w1 |row 1 of A - M|^2 + w2 |row 2 of A - M|^2 + 2 mu (det M - determinant),  trace M = trace.
/// The Hessian is positive for |mu| < 1, and det M falls there from +inf to -inf: the root is the
/// least of all M.
Eigen::Matrix2d stationary(const Eigen::Matrix2d& A, double r, double trace, double mu) {
  const double curvature = r + 1 / r - 2 * mu;
  Eigen::Matrix2d M;
  M(0, 0) = (r * A(0, 0) + (trace - A(1, 1)) / r - mu * trace) / curvature;
  M(1, 1) = trace - M(0, 0);
  M(0, 1) = (A(0, 1) + mu * A(1, 0) / r) / (1 - mu * mu);
  M(1, 0) = (A(1, 0) + mu * A(0, 1) * r) / (1 - mu * mu);
  return M;
}

/// Where the root is an end mu = +-1 itself (a block whose off-diagonal entries balance there, such
/// as a multiple of I), the off-diagonal entries are only known to lie on the line
///   r M12 - mu M21 = r A12,
/// and the determinant picks the point.
void pick_on_line(Eigen::Matrix2d& M, const Eigen::Matrix2d& A, double r, double mu,
                  double product) {
  const double half = A(0, 1) / 2;
  M(0, 1) = half + std::sqrt(std::max(half * half + mu * product / r, 0.0));
  M(1, 0) = mu * r * (M(0, 1) - A(0, 1));
}

}  // namespace

Eigen::Matrix2d nearest_with_poles(const Eigen::Matrix2d& A, double ratio, double trace,
                                   double determinant) {
  double low = -end, high = end;
  for (int i = 0; i < halvings; ++i) {
    const double middle = (low + high) / 2;
    const Eigen::Matrix2d M = stationary(A, ratio, trace, middle);
    (M(0, 0) * M(1, 1) - M(1, 0) * M(0, 1) > determinant ? low : high) = middle;
  }
  const double mu = (low + high) / 2;
  Eigen::Matrix2d M = stationary(A, ratio, trace, mu);
  const double product = M(0, 0) * M(1, 1) - determinant;  // of the off-diagonal entries
  if (std::abs(mu) > end - 1e-12) pick_on_line(M, A, ratio, mu > 0 ? 1 : -1, product);
  // Rounding in mu is taken back: the poles are exact, the norm is the least but for rounding.
  double& larger = std::abs(M(0, 1)) >= std::abs(M(1, 0)) ? M(0, 1) : M(1, 0);
  double& smaller = &larger == &M(0, 1) ? M(1, 0) : M(0, 1);
  if (larger != 0) smaller = product / larger;
  return M;
}

Eigen::Matrix2d first_row_with_poles(const Eigen::Matrix2d& A, double trace, double determinant) {
  Eigen::Matrix2d M = A;
  M(0, 0) = trace - A(1, 1);
  M(0, 1) = (M(0, 0) * A(1, 1) - determinant) / A(1, 0);
  return M;
}

}  // namespace reident::identification
