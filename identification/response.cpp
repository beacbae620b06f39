#include "identification/response.hpp"

#include <cmath>

namespace reident::identification {
namespace {

/// Regressors of one segment, one block of rows an output. Since C A^j B is linear in B, the row of
/// B(i, j) is found from the dual system x[k+1] = A' x[k] + c' u_j[k]: one simulation of order n
/// for each pair of output and input gives the regressors of all n entries of a column of B.
class Regressors {
 public:
  Regressors(const Matrix& A, const Matrix& C, const Record& record)
      : A_(A), At_(A.transpose()), C_(C), record_(record) {}

  Index shared() const { return inputs() * order() + outputs() * (inputs() + 1); }
  Index columns() const { return shared() + order(); }

  /// Columns: B by columns, D by rows, y0, x0; then the measured output.
  Matrix of(const Segment& segment, Index q) const {
    const Index n = order(), m = inputs(), p = outputs(), N = segment.size();
    Matrix phi = Matrix::Zero(N, columns() + 1);
    const Vector c = C_.row(q).transpose();
    Vector x(n), next(n);
    for (Index j = 0; j < m; ++j) {
      x.setZero();
      for (Index k = 0; k < N; ++k) {
        phi.row(k).segment(j * n, n) = x.transpose();
        next.noalias() = At_ * x;
        next += c * record_.u(segment.begin + k, j);
        x.swap(next);
      }
    }
    phi.middleCols(m * n + q * m, m) = record_.u.middleRows(segment.begin, N);
    phi.col(m * n + p * m + q).setOnes();
    x = c;
    for (Index k = 0; k < N; ++k) {
      phi.row(k).segment(shared(), n) = x.transpose();
      next.noalias() = At_ * x;
      x.swap(next);
    }
    phi.col(columns()) = record_.y.col(q).segment(segment.begin, N);
    return phi;
  }

  Index order() const { return A_.rows(); }
  Index inputs() const { return record_.u.cols(); }
  Index outputs() const { return C_.rows(); }

 private:
  const Matrix& A_;
  Matrix At_;
  const Matrix& C_;
  const Record& record_;
};

Matrix triangular(const Matrix& rows) {
  const Index size = std::min(rows.rows(), rows.cols());
  return rows.householderQr().matrixQR().topRows(size).triangularView<Eigen::Upper>();
}

}  // namespace

Response fit_response(const Matrix& A, const Matrix& C, const Record& record, RowRange rows) {
  const Regressors regressors(A, C, record);
  const Index n = regressors.order(), m = regressors.inputs(), p = regressors.outputs();
  const Index shared = regressors.shared();

  // Each segment has an initial state of its own: it is eliminated within the segment, and what
  // remains says something about the shared unknowns.
  Matrix total(0, shared + 1);
  Matrix first;  // the rows of the first segment that determine its initial state
  for (const Segment& segment : segments_within(record, rows)) {
    Matrix stacked(0, n + shared + 1);
    for (Index q = 0; q < p; ++q) {
      const Matrix phi = regressors.of(segment, q);
      Matrix ordered(phi.rows(), phi.cols());
      ordered << phi.middleCols(shared, n), phi.leftCols(shared), phi.rightCols(1);
      Matrix both(stacked.rows() + ordered.rows(), ordered.cols());
      both << stacked, ordered;
      stacked = triangular(both);
    }
    const Index own = std::min(n, stacked.rows());
    if (first.rows() == 0) first = stacked.topRows(own);
    Matrix both(total.rows() + stacked.rows() - own, shared + 1);
    both << total, stacked.bottomRightCorner(stacked.rows() - own, shared + 1);
    total = triangular(both);
  }

  const Vector theta =
      total.leftCols(shared).completeOrthogonalDecomposition().solve(total.col(shared));
  Vector x0 = Vector::Zero(n);
  if (first.rows() > 0) {
    x0 = first.leftCols(n).completeOrthogonalDecomposition().solve(
        first.col(n + shared) - first.middleCols(n, shared) * theta);
  }
  StateSpaceModel model{A, Matrix(n, m), C, Matrix(p, m), {}, Vector::Zero(m), {}, record.period_s};
  model.B = Eigen::Map<const Matrix>(theta.data(), n, m);
  model.D = Eigen::Map<const Matrix>(theta.data() + n * m, m, p).transpose();
  model.y0 = theta.tail(p);
  return {model, x0};
}

}  // namespace reident::identification
