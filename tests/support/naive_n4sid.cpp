#include "tests/support/naive_n4sid.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace reident::test {
namespace {

using namespace identification;

/// Rows [first, first + count) of blocks: channels.row(t + k) for the block row k and column t,
/// over the columns t of all segments that are long enough for `span` block rows, centred.
Matrix hankel(const Record& record, const Matrix& channels, Index first, Index count, Index span) {
  Matrix H(count * channels.cols(), 0);
  for (const Segment& segment : record.segments) {
    for (Index t = segment.begin; t + span <= segment.end; ++t) {
      H.conservativeResize(Eigen::NoChange, H.cols() + 1);
      for (Index k = 0; k < count; ++k)
        H.block(k * channels.cols(), H.cols() - 1, channels.cols(), 1) =
            channels.row(t + first + k).transpose();
    }
  }
  const Vector means = H.rowwise().mean();
  return H.colwise() - means;
}

Matrix pseudo_inverse(const Matrix& M) {
  return M.completeOrthogonalDecomposition().pseudoInverse();
}

/// M less its projection on the row space of `on`.
Matrix off(const Matrix& M, const Matrix& on) {
  const Matrix gram = on * on.transpose();
  return M - (M * on.transpose()) * pseudo_inverse(gram) * on;
}

Matrix inverse_square_root(const Matrix& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(symmetric);
  return eigen.operatorInverseSqrt();
}

Matrix power(const Matrix& A, Index exponent) {
  Matrix result = Matrix::Identity(A.rows(), A.cols());
  for (Index i = 0; i < exponent; ++i) result = result * A;
  return result;
}

/// B, D, y0 and x0 of every segment from explicit regressors, one row for each sample.
void fit_inputs(NaiveResult& result, const Record& record) {
  StateSpaceModel& model = result.model;
  const Index n = model.order(), m = record.u.cols(), p = record.y.cols();
  const Index segments = static_cast<Index>(record.segments.size());
  const Index shared = n * m + p * m + p;
  Matrix regressors = Matrix::Zero(p * record.rows(), shared + n * segments);
  Vector target(p * record.rows());
  for (Index s = 0; s < segments; ++s) {
    const Segment& segment = record.segments[static_cast<std::size_t>(s)];
    for (Index t = 0; t < segment.size(); ++t) {
      const Index row = (segment.begin + t) * p;
      for (Index j = 0; j < m; ++j) {
        for (Index past = 0; past < t; ++past)
          regressors.block(row, j * n, p, n) +=
              record.u(segment.begin + past, j) * model.C * power(model.A, t - 1 - past);
        for (Index q = 0; q < p; ++q)
          regressors(row + q, n * m + q * m + j) = record.u(segment.begin + t, j);
      }
      for (Index q = 0; q < p; ++q) regressors(row + q, n * m + p * m + q) = 1;
      regressors.block(row, shared + s * n, p, n) = model.C * power(model.A, t);
      target.segment(row, p) = record.y.row(segment.begin + t).transpose();
    }
  }
  const Vector theta = pseudo_inverse(regressors) * target;
  model.B = theta.head(n * m).reshaped(n, m);
  model.D = theta.segment(n * m, p * m).reshaped(m, p).transpose();
  model.y0 = theta.segment(n * m + p * m, p);
  result.x0 = theta.segment(shared, n);
}

}  // namespace

NaiveResult naive_n4sid(const Record& record, Index order, Index horizon, Weighting weighting) {
  const Index m = record.u.cols(), p = record.y.cols(), s = horizon;
  const Matrix U_p = hankel(record, record.u, 0, s, 2 * s),
               U_f = hankel(record, record.u, s, s, 2 * s);
  const Matrix Y_p = hankel(record, record.y, 0, s, 2 * s),
               Y_f = hankel(record, record.y, s, s, 2 * s);
  Matrix W_p(U_p.rows() + Y_p.rows(), U_p.cols());
  W_p << U_p, Y_p;

  // The oblique projection O = (Y_f off U_f) (W_p off U_f)^+ W_p.
  const Matrix Y_off = off(Y_f, U_f), W_off = off(W_p, U_f);
  const Matrix L_w = (Y_off * W_off.transpose()) * pseudo_inverse(W_off * W_off.transpose());
  Matrix W1 = Matrix::Identity(p * s, p * s), weighted;
  switch (weighting) {
    case Weighting::n4sid:
      weighted = L_w * W_p;
      break;
    case Weighting::moesp:
      weighted = L_w * W_off;
      break;
    case Weighting::cva:
      W1 = inverse_square_root(Y_off * Y_off.transpose());
      weighted = W1 * L_w * W_off;
      break;
  }
  const Eigen::BDCSVD<Matrix> svd(weighted, Eigen::ComputeThinU);
  const Matrix gamma = W1.inverse() * svd.matrixU().leftCols(order);

  NaiveResult result;
  result.singular_values = svd.singularValues();
  StateSpaceModel& model = result.model;
  model.A = pseudo_inverse(gamma.topRows((s - 1) * p)) * gamma.bottomRows((s - 1) * p);
  model.C = gamma.topRows(p);
  model.B = Matrix::Zero(order, m);
  model.D = Matrix::Zero(p, m);
  model.u0 = Vector::Zero(m);
  model.y0 = Vector::Zero(p);
  model.period_s = record.period_s;
  fit_inputs(result, record);
  return result;
}

}  // namespace reident::test
