#include "identification/subspace/input_response.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/kernels.hpp"
#include "identification/subspace/shift_invariance.hpp"

namespace reident::identification {
namespace {

/// Block rows of the future that B and D are fitted to: more cost much and add little.
constexpr Index longest_response = 20;

/// Least squares of a target row on the rows above it, from their inner products: `sums` before and
/// `removed` what a projection takes away of them. Absent where too few digits would be left.
std::optional<Vector> solve_sums(const Matrix& sums, const Matrix& removed) {
  const Index unknowns = sums.rows() - 1;
  const Vector scale = sums.diagonal().head(unknowns).unaryExpr(
      [](double w) { return w > 0 ? 1 / std::sqrt(w) : 0.0; });
  const Matrix left = (sums - removed).triangularView<Eigen::Lower>();
  const Matrix G = scale.asDiagonal() * left.topLeftCorner(unknowns, unknowns) * scale.asDiagonal();
  constexpr double least_pivot = 1e-5;  // its square is the share of a row that is its own
  const auto cholesky = Cholesky::of(G, least_pivot);
  if (!cholesky) return std::nullopt;
  const Vector right = scale.asDiagonal() * left.row(unknowns).head(unknowns).transpose();
  return Vector(scale.asDiagonal() * cholesky->solve(right));
}

}  // namespace

StateSpaceModel with_response(const Projection& projection, const Matrix& A, const Matrix& C,
                              bool direct, double period_s) {
  const Matrix &L_uu = projection.L().uu, &L_yu = projection.L().yu;
  const Index n = A.rows(), m = projection.inputs(), p = projection.outputs(),
              s = std::min<Index>(projection.horizon(), longest_response), mu = m * s;
  StateSpaceModel model{
      A, Matrix::Zero(n, m), C, Matrix::Zero(p, m), {}, Vector::Zero(m), Vector::Zero(p), period_s};
  if (mu == 0) return model;
  const Matrix gamma = extended_observability(A, C, s);
  const Matrix Q = orthonormal_basis(gamma);
  const Matrix Qt = Q.transpose();
  // Each coordinate of U_f is a short experiment: inputs v, outputs L_yu. Nothing moves before the
  // block row whose input it is.
  const Index unknowns = n * m + (direct ? p * m : 0), height = unknowns + 1;
  Matrix rows = Matrix::Zero(height, mu * p * s);
  Matrix sums = Matrix::Zero(height, height), removed = sums;
  Matrix along_gamma = Matrix::Zero(height, mu * n);
  const Matrix At = A.transpose();
  for (Index j = 0; j < mu; ++j) {
    const Index k0 = j / m, count = s - k0;
    const double* v = L_uu.col(j).data() + k0 * m;
    auto own = rows.middleCols((j * s + k0) * p, count * p);
    for (Index q = 0; q < p; ++q) {
      const Vector c = C.row(q).transpose();
      Matrix states = Matrix::Zero(n, m);
      run_dual_filters(At.data(), c.data(), n, m, v, count, states.data(), own.data() + q * height,
                       p * height);
      for (Index k = 0; direct && k < count; ++k)
        own.col(k * p + q).segment(n * m + q * m, m) = Eigen::Map<const Vector>(v + k * m, m);
    }
    rows.row(unknowns).segment(j * p * s, p * s) = L_yu.col(j).head(p * s).transpose();
    const VectorSequence sequence{own.data(), height, height};
    add_outer_products(sequence, sequence, count * p, Triangle::lower, sums.data());
    add_outer_products(sequence, {Qt.data() + k0 * p * n, n, n}, count * p, Triangle::full,
                       along_gamma.data() + j * n * height);
    along_gamma.row(unknowns).segment(j * n, n).noalias() = Qt * L_yu.col(j).head(p * s);
  }
  const VectorSequence along{along_gamma.data(), height, height};
  add_outer_products(along, along, mu * n, Triangle::lower, removed.data());
  Vector theta;
  if (auto solution = solve_sums(sums, removed)) {
    theta = std::move(*solution);
  } else {
    for (Index j = 0; j < mu; ++j) {
      auto own = rows.middleCols(j * p * s, p * s);
      own -= (own * Q) * Qt;
    }
    theta = solve_least_norm(rows.topRows(unknowns).transpose(),
                             Vector(rows.row(unknowns).transpose()));
  }
  model.B = theta.head(n * m).reshaped(n, m);
  if (direct) model.D = theta.tail(p * m).reshaped(m, p).transpose();
  return model;
}

}  // namespace reident::identification
