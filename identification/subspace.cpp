#include "identification/subspace.hpp"

#include <cmath>
#include <vector>

namespace reident::identification {
namespace {

/// Columns of the factor that hold channels [channel, channel + count) of the block rows
/// [begin, end).
void append_columns(std::vector<Index>& columns, Index width, Index begin, Index end, Index channel,
                    Index count) {
  for (Index k = begin; k < end; ++k)
    for (Index c = 0; c < count; ++c) columns.push_back(1 + k * width + channel + c);
}

}  // namespace

Projection::Projection(const HankelFactor& factor, Index horizon)
    : inputs_(factor.inputs),
      outputs_(factor.outputs),
      horizon_(horizon),
      columns_(factor.columns) {
  const Index m = inputs_, p = outputs_, s = horizon, width = m + p;
  eigen_assert(2 * s <= factor.block_rows);
  std::vector<Index> columns{0};
  append_columns(columns, width, s, 2 * s, 0, m);  // U_f
  append_columns(columns, width, 0, s, 0, m);      // U_p
  append_columns(columns, width, 0, s, m, p);      // Y_p
  append_columns(columns, width, s, 2 * s, m, p);  // Y_f

  const Index size = 1 + 2 * s * width;
  const Matrix ordered = factor.R.topRows(size)(Eigen::all, columns);
  const Matrix T = ordered.householderQr().matrixQR().triangularView<Eigen::Upper>();
  const Index u = 1, w = 1 + m * s, y = w + width * s;
  T_uu_ = T.block(u, u, m * s, m * s);
  T_uy_ = T.block(u, y, m * s, p * s);
  T_uw_ = T.block(u, w, m * s, width * s);
  T_ww_ = T.block(w, w, width * s, width * s);
  T_wy_ = T.block(w, y, width * s, p * s);
  T_yy_ = T.block(y, y, p * s, p * s);
}

Projection::Observability Projection::observability(Weighting weighting) const {
  // Transposed throughout, as the factor is: a row of T' is a row of the Hankel matrix.
  Matrix weighted;  // (W1 O W2)'
  Matrix W1_inverse_transposed;
  switch (weighting) {
    case Weighting::moesp:  // O projected off U_f
      weighted = T_wy_;
      break;
    case Weighting::n4sid: {  // O = L_w W_p itself
      const Matrix L_w = T_ww_.completeOrthogonalDecomposition().solve(T_wy_);
      weighted.resize(T_uw_.rows() + T_ww_.rows(), T_wy_.cols());
      weighted << T_uw_ * L_w, T_ww_ * L_w;
      break;
    }
    case Weighting::cva: {  // W1 = (Y_f projected off U_f)^-1/2
      Matrix stacked(T_wy_.rows() + T_yy_.rows(), T_wy_.cols());
      stacked << T_wy_, T_yy_;
      W1_inverse_transposed =
          stacked.householderQr().matrixQR().topRows(stacked.cols()).triangularView<Eigen::Upper>();
      weighted = W1_inverse_transposed.transpose()
                     .completeOrthogonalDecomposition()
                     .solve(T_wy_.transpose())
                     .transpose();
      break;
    }
  }
  if (weighted.rows() > weighted.cols()) {
    const Matrix reduced =
        weighted.householderQr().matrixQR().topRows(weighted.cols()).triangularView<Eigen::Upper>();
    weighted = reduced;
  }
  const Eigen::JacobiSVD<Matrix> svd(weighted.transpose(), Eigen::ComputeThinU);
  Matrix gamma = svd.matrixU() * svd.singularValues().cwiseSqrt().asDiagonal();
  if (weighting == Weighting::cva) gamma = W1_inverse_transposed.transpose() * gamma;
  return {gamma, svd.singularValues()};
}

Matrix Projection::input_innovations() const {
  const Vector diagonal = T_uu_.diagonal().cwiseAbs() / std::sqrt(double(columns_));
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

}  // namespace

Matrix Projection::noise_covariance(const StateSpaceModel& model) const {
  const Index m = inputs_, p = outputs_, s = horizon_, n = model.order();
  // Coordinates of the rows of the Hankel matrix along the orthonormal rows of U_f, W_p and the
  // first block row of Y_f; all of the past of step s + 1 lies in their span.
  const Index mu = T_uu_.rows(), w = T_ww_.rows(), span = mu + w + p;
  Matrix U_f = Matrix::Zero(m * s, span), Y_f = Matrix::Zero(p * s, span);
  U_f.leftCols(mu) = T_uu_.transpose();
  Y_f.leftCols(mu) = T_uy_.transpose();
  Y_f.middleCols(mu, w) = T_wy_.transpose();
  Matrix Z = Y_f;  // Y_f projected on U_f and W_p
  Y_f.rightCols(p) = T_yy_.topRows(p).transpose();

  const Matrix gamma = extended_observability(model, s);
  const Matrix H = impulse_toeplitz(model, gamma);
  const Index less = (s - 1) * p;
  const Matrix X = gamma.completeOrthogonalDecomposition().solve(Z - H * U_f);
  const Matrix X_next = gamma.topRows(less).completeOrthogonalDecomposition().solve(
      Y_f.bottomRows(less) - H.topLeftCorner(less, (s - 1) * m) * U_f.bottomRows((s - 1) * m));
  Matrix residual(n + p, span);
  residual.topRows(n) = X_next - model.A * X - model.B * U_f.topRows(m);
  residual.bottomRows(p) = Y_f.topRows(p) - model.C * X - model.D * U_f.topRows(m);
  return residual * residual.transpose() / double(columns_);
}

Dynamics shift_invariant(const Matrix& gamma, Index outputs, Index order, Stability stability) {
  const Index rows = gamma.rows() - outputs;
  const Matrix C = gamma.topLeftCorner(outputs, order);
  if (stability == Stability::as_found)
    return {gamma.topLeftCorner(rows, order)
                .colPivHouseholderQr()
                .solve(gamma.bottomLeftCorner(rows, order)),
            C};
  Matrix shifted = Matrix::Zero(gamma.rows(), order);
  shifted.topRows(rows) = gamma.bottomLeftCorner(rows, order);
  return {gamma.leftCols(order).colPivHouseholderQr().solve(shifted), C};
}

}  // namespace reident::identification
