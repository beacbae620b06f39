#include "identification/subspace/noise_covariance.hpp"

#include "identification/numerics/decompositions.hpp"
#include "identification/subspace/shift_invariance.hpp"

namespace reident::identification {
namespace {

/// The lower triangular block-Toeplitz matrix of D, C B, C A B, ...
Matrix impulse_toeplitz(const StateSpaceModel& model, const Matrix& gamma) {
  const Index m = model.inputs(), p = model.outputs(), rows = gamma.rows() / p;
  Matrix H = Matrix::Zero(rows * p, rows * m);
  const Matrix markov = gamma * model.B;
  for (Index j = 0; j < rows; ++j) {
    H.block(j * p, j * m, p, m) = model.D;
    const Index below = (rows - j - 1) * p;
    H.block((j + 1) * p, j * m, below, m) = markov.topRows(below);
  }
  return H;
}

}  // namespace

Matrix noise_covariance(const Projection& projection, const StateSpaceModel& model) {
  const auto& [L_uu, L_wu, L_ww, L_yu, L_yw, L_yy] = projection.L();
  const Index m = projection.inputs(), p = projection.outputs(), s = projection.horizon();
  const Index n = model.order();
  // Coordinates of the rows of the Hankel matrix along the orthonormal rows of U_f, W_p and the
  // first block row of Y_f; all of the past of step s + 1 lies in their span.
  const Index mu = L_uu.rows(), w = L_ww.rows(), span = mu + w + p;
  Matrix U_f = Matrix::Zero(m * s, span), Y_f = Matrix::Zero(p * s, span);
  U_f.leftCols(mu) = L_uu;
  Y_f.leftCols(mu) = L_yu;
  Y_f.middleCols(mu, w) = L_yw;
  Matrix Z = Y_f;  // Y_f projected on U_f and W_p
  Y_f.rightCols(p) = L_yy.leftCols(p);

  const Matrix gamma = extended_observability(model.A, model.C, s);
  const Matrix H = impulse_toeplitz(model, gamma);
  const Index less = (s - 1) * p;
  const Matrix X = solve_least_norm(gamma, Matrix(Z - H * U_f));
  const Matrix X_next = solve_least_norm(
      gamma.topRows(less), Matrix(Y_f.bottomRows(less) - H.topLeftCorner(less, (s - 1) * m) *
                                                             U_f.bottomRows((s - 1) * m)));
  Matrix residual(n + p, span);
  residual.topRows(n) = X_next - model.A * X - model.B * U_f.topRows(m);
  residual.bottomRows(p) = Y_f.topRows(p) - model.C * X - model.D * U_f.topRows(m);
  return residual * residual.transpose() / double(projection.columns());
}

}  // namespace reident::identification
