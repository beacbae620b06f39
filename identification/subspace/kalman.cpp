#include "identification/subspace/kalman.hpp"

#include <cassert>

#include "identification/numerics/decompositions.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {
namespace {

constexpr int doublings = 60;
constexpr double accepted_residual = 1e-8;
constexpr double least_rcond = 1e-14;  // of R

struct Noise {
  Matrix Q, S, R;
};

Noise parts(const Matrix& noise, Index n) {
  const Index p = noise.rows() - n;
  return {noise.topLeftCorner(n, n), noise.topRightCorner(n, p), noise.bottomRightCorner(p, p)};
}

Matrix gain_of(const Matrix& A, const Matrix& C, const Noise& noise, const Matrix& P) {
  const Matrix innovation = C * P * C.transpose() + noise.R;
  const Matrix cross = A * P * C.transpose() + noise.S;
  return solve_ldlt_on_right(cross, innovation);
}

double relative_residual(const Matrix& A, const Matrix& C, const Noise& noise, const Matrix& P) {
  const Matrix K = gain_of(A, C, noise, P);
  const Matrix cross = A * P * C.transpose() + noise.S;
  const Matrix residual = A * P * A.transpose() + noise.Q - K * cross.transpose() - P;
  return residual.norm() / (P.norm() + noise.Q.norm());
}

/// Fewer mixtures of the outputs (rows, orthonormal) with all that these hold, where the rest is
/// zero: in the noise and in the states. Absent where there is no such rest.
std::optional<Matrix> independent_mixtures(const Matrix& C, const Matrix& R) {
  constexpr double rounding = 1e-6;  // of C, where the noise has its square root
  const SymmetricEigen found = symmetric_eigen(R);
  if (!found.converged) return std::nullopt;
  const Index p = R.rows();
  const double greatest = found.values(p - 1);
  Index zeros = 0;
  while (zeros < p && !(found.values(zeros) > 10 * least_rcond * greatest)) ++zeros;
  const Matrix rest = found.vectors.leftCols(zeros).transpose() * C;
  if (zeros == 0 || zeros == p || !(rest.norm() <= rounding * C.norm())) return std::nullopt;
  return found.vectors.rightCols(p - zeros).transpose();
}

}  // namespace

std::optional<Matrix> riccati_solution(const Matrix& A, const Matrix& C, const Matrix& noise) {
  const Index n = A.rows();
  assert(noise.rows() == n + C.rows() && noise.cols() == noise.rows());
  const Noise parted = parts(noise, n);
  if (!noise.allFinite()) return std::nullopt;
  const auto R = Cholesky::of(parted.R, 0, least_rcond);
  if (!R) return std::nullopt;

  // With the cross covariance removed: P = F P F' - F P C' (C P C' + R)^-1 C P F' + Q_s.
  const Matrix F = A - parted.S * R->solve(C);
  Matrix H = parted.Q - parted.S * R->solve_transposed(parted.S);
  Matrix E = F.transpose(), G = C.transpose() * R->solve(C);
  const Matrix identity = Matrix::Identity(n, n);
  for (int i = 0; i < doublings; ++i) {
    const auto [WE, WG] = solve_lu(identity + G * H, E, G);
    const Matrix step = E.transpose() * H * WE;
    G += E * WG * E.transpose();
    E = (E * WE).eval();
    H += step;
    H = ((H + H.transpose()) / 2).eval();
    if (!H.allFinite()) return std::nullopt;
    if (step.norm() <= 1e-15 * H.norm()) break;
  }
  if (!(relative_residual(A, C, parted, H) < accepted_residual)) return std::nullopt;
  return H;
}

std::optional<Matrix> kalman_gain(const Matrix& A, const Matrix& C, const Matrix& noise) {
  if (const auto T = independent_mixtures(C, parts(noise, A.rows()).R)) {
    const Index n = A.rows(), k = T->rows();
    Matrix mixed = Matrix::Zero(n + k, n + C.rows());
    mixed.topLeftCorner(n, n).setIdentity();
    mixed.bottomRightCorner(k, C.rows()) = *T;
    const auto K = kalman_gain(A, *T * C, mixed * noise * mixed.transpose());
    if (!K) return std::nullopt;
    return *K * *T;
  }
  const std::optional<Matrix> P = riccati_solution(A, C, noise);
  if (!P) return std::nullopt;
  const Matrix K = gain_of(A, C, parts(noise, A.rows()), *P);
  if (!is_stable(A - K * C)) return std::nullopt;
  return K;
}

}  // namespace reident::identification
