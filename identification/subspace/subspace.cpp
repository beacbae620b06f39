#include "identification/subspace/subspace.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/kernels.hpp"

namespace reident::identification {

std::string_view name(Weighting weighting) {
  switch (weighting) {
    case Weighting::n4sid:
      return "n4sid";
    case Weighting::moesp:
      return "moesp";
    case Weighting::cva:
      return "cva";
  }
  return "unknown";
}

namespace {

/// Block rows of the future that B and D are fitted to: more cost much and add little.
constexpr Index longest_response = 20;

/// Lower triangular factor of M M' for M of no more rows than columns.
Matrix lower_factor(const Matrix& M) {
  return triangular_factor(M.transpose()).transpose();
}

/// X L = M for a lower triangular L; of least norm where L is singular to rounding.
Matrix divided(const Matrix& M, const Matrix& L) {
  const auto pivots = L.diagonal().cwiseAbs();
  if (pivots.minCoeff() > 1e-13 * pivots.maxCoeff()) return solve_lower_on_right(M, L);
  return solve_least_norm_on_right(M, L);
}

}  // namespace

Projection::Projection(const HankelFactor& factor)
    : inputs_(factor.inputs),
      outputs_(factor.outputs),
      horizon_(factor.horizon),
      columns_(factor.columns) {
  const Index mu = inputs_ * horizon_, ps = outputs_ * horizon_, past = mu + ps;
  const Index u = 1, w = u + mu, y = w + past;
  L_uu_ = factor.L.block(u, u, mu, mu);
  L_wu_ = factor.L.block(w, u, past, mu);
  L_ww_ = factor.L.block(w, w, past, past);
  L_yu_ = factor.L.block(y, u, ps, mu);
  L_yw_ = factor.L.block(y, w, ps, past);
  L_yy_ = factor.L.block(y, y, ps, ps);
}

Projection::Observability Projection::observability(Weighting weighting) const {
  Matrix weighted;  // W1 O W2
  Matrix W1_inverse;
  switch (weighting) {
    case Weighting::moesp:  // O projected off U_f
      weighted = L_yw_;
      break;
    case Weighting::n4sid: {  // O = L_w W_p itself
      const Matrix L_w = divided(L_yw_, L_ww_);
      weighted.resize(L_yw_.rows(), L_wu_.cols() + L_yw_.cols());
      weighted << L_w * L_wu_, L_yw_;
      break;
    }
    case Weighting::cva: {  // W1 = (Y_f projected off U_f)^-1/2
      Matrix off_inputs(L_yw_.rows(), L_yw_.cols() + L_yy_.cols());
      off_inputs << L_yw_, L_yy_;
      W1_inverse = lower_factor(off_inputs);
      weighted = solve_least_norm(W1_inverse, L_yw_);
      break;
    }
  }
  const auto [U, values] = left_singular(lower_factor(weighted), SingularVectors::thin);
  Matrix gamma = U * values.cwiseSqrt().asDiagonal();
  if (weighting == Weighting::cva) gamma = W1_inverse * gamma;
  return {gamma, values};
}

Matrix Projection::input_innovations() const {
  const Vector diagonal = L_uu_.diagonal().cwiseAbs() / std::sqrt(double(columns_));
  return diagonal.reshaped(inputs_, horizon_).transpose();
}

namespace {

/// [C; C A; ...] of `rows` block rows.
Matrix extended_observability(const StateSpaceModel& model, Index rows) {
  const Index p = model.outputs();
  Matrix gamma(rows * p, model.order());
  gamma.topRows(p) = model.C;
  for (Index k = 1; k < rows; ++k)
    gamma.middleRows(k * p, p).noalias() = gamma.middleRows((k - 1) * p, p) * model.A;
  return gamma;
}

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

StateSpaceModel Projection::with_response(const Matrix& A, const Matrix& C, bool direct,
                                          double period_s) const {
  const Index n = A.rows(), m = inputs_, p = outputs_,
              s = std::min<Index>(horizon_, longest_response), mu = m * s;
  StateSpaceModel model{
      A, Matrix::Zero(n, m), C, Matrix::Zero(p, m), {}, Vector::Zero(m), Vector::Zero(p), period_s};
  if (mu == 0) return model;
  const Matrix gamma = extended_observability(model, s);
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
    const double* v = L_uu_.col(j).data() + k0 * m;
    auto own = rows.middleCols((j * s + k0) * p, count * p);
    for (Index q = 0; q < p; ++q) {
      const Vector c = C.row(q).transpose();
      Matrix states = Matrix::Zero(n, m);
      run_dual_filters(At.data(), c.data(), n, m, v, count, states.data(), own.data() + q * height,
                       p * height);
      for (Index k = 0; direct && k < count; ++k)
        own.col(k * p + q).segment(n * m + q * m, m) = Eigen::Map<const Vector>(v + k * m, m);
    }
    rows.row(unknowns).segment(j * p * s, p * s) = L_yu_.col(j).head(p * s).transpose();
    const VectorSequence sequence{own.data(), height, height};
    add_outer_products(sequence, sequence, count * p, Triangle::lower, sums.data());
    add_outer_products(sequence, {Qt.data() + k0 * p * n, n, n}, count * p, Triangle::full,
                       along_gamma.data() + j * n * height);
    along_gamma.row(unknowns).segment(j * n, n).noalias() = Qt * L_yu_.col(j).head(p * s);
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

Matrix Projection::noise_covariance(const StateSpaceModel& model) const {
  const Index m = inputs_, p = outputs_, s = horizon_, n = model.order();
  // Coordinates of the rows of the Hankel matrix along the orthonormal rows of U_f, W_p and the
  // first block row of Y_f; all of the past of step s + 1 lies in their span.
  const Index mu = L_uu_.rows(), w = L_ww_.rows(), span = mu + w + p;
  Matrix U_f = Matrix::Zero(m * s, span), Y_f = Matrix::Zero(p * s, span);
  U_f.leftCols(mu) = L_uu_;
  Y_f.leftCols(mu) = L_yu_;
  Y_f.middleCols(mu, w) = L_yw_;
  Matrix Z = Y_f;  // Y_f projected on U_f and W_p
  Y_f.rightCols(p) = L_yy_.leftCols(p);

  const Matrix gamma = extended_observability(model, s);
  const Matrix H = impulse_toeplitz(model, gamma);
  const Index less = (s - 1) * p;
  const Matrix X = solve_least_norm(gamma, Matrix(Z - H * U_f));
  const Matrix X_next = solve_least_norm(
      gamma.topRows(less), Matrix(Y_f.bottomRows(less) - H.topLeftCorner(less, (s - 1) * m) *
                                                             U_f.bottomRows((s - 1) * m)));
  Matrix residual(n + p, span);
  residual.topRows(n) = X_next - model.A * X - model.B * U_f.topRows(m);
  residual.bottomRows(p) = Y_f.topRows(p) - model.C * X - model.D * U_f.topRows(m);
  return residual * residual.transpose() / double(columns_);
}

Dynamics shift_invariant(const Matrix& gamma, Index outputs, Index order, Stability stability) {
  const Index rows = gamma.rows() - outputs;
  const Matrix C = gamma.topLeftCorner(outputs, order);
  if (stability == Stability::as_found)
    return {solve_pivoted_qr(gamma.topLeftCorner(rows, order),
                             Matrix(gamma.bottomLeftCorner(rows, order))),
            C};
  Matrix shifted = Matrix::Zero(gamma.rows(), order);
  shifted.topRows(rows) = gamma.bottomLeftCorner(rows, order);
  return {solve_pivoted_qr(gamma.leftCols(order), shifted), C};
}

}  // namespace reident::identification
