#include "identification/subspace/ssarx.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "identification/numerics/decompositions.hpp"

namespace reident::identification {
namespace {

/// The rows of a record as the regressions need them: column t of `past` holds z[t-1], z[t-2], ...
/// with z = (u, y), and that of `u` and `y` the rows t, t+1, ... below each other.
struct Regressors {
  Matrix past;                 // (m + p) L x N
  Matrix future_u;             // m f x N
  Matrix future_y;             // p f x N
  std::vector<Index> follows;  // column of the next row, -1 where there is none
};

Regressors regressors_of(const Record& record, RowRange rows, Index past, Index future) {
  const Index m = record.u.cols(), p = record.y.cols(), width = m + p;
  const std::vector<Segment> segments = segments_within(record, rows);
  Index count = 0;
  for (const Segment& segment : segments)
    count += std::max<Index>(0, segment.size() - past - future + 1);
  Regressors found{
      Matrix(width * past, count), Matrix(m * future, count), Matrix(p * future, count), {}};
  Index column = 0;
  for (const Segment& segment : segments)
    for (Index t = segment.begin + past; t + future <= segment.end; ++t, ++column) {
      for (Index i = 0; i < past; ++i) {
        found.past.col(column).segment(i * width, m) = record.u.row(t - 1 - i).transpose();
        found.past.col(column).segment(i * width + m, p) = record.y.row(t - 1 - i).transpose();
      }
      for (Index k = 0; k < future; ++k) {
        found.future_u.col(column).segment(k * m, m) = record.u.row(t + k).transpose();
        found.future_y.col(column).segment(k * p, p) = record.y.row(t + k).transpose();
      }
      found.follows.push_back(t + 1 + future <= segment.end ? column + 1 : -1);
    }
  return found;
}

/// The rows of future outputs without what inputs and outputs since row t have done to them.
Matrix without_since(const Regressors& rows, const Matrix& arx, Index m, Index p, Index future) {
  const Index width = m + p, past = arx.cols() / width;
  Matrix result = rows.future_y;
  for (Index k = 1; k < future; ++k)
    for (Index j = 1; j <= std::min(k, past); ++j) {
      const auto of_lag = arx.middleCols((j - 1) * width, width);
      result.middleRows(k * p, p) -= of_lag.leftCols(m) * rows.future_u.middleRows((k - j) * m, m) +
                                     of_lag.rightCols(p) * rows.future_y.middleRows((k - j) * p, p);
    }
  return result;
}

/// The model whose states are the first n rows of `states`.
std::optional<LoopModel> realised(const Regressors& rows, const Matrix& states, Index n, Index m,
                                  Index p, double period_s) {
  const Index count = states.cols();
  const Matrix X = states.topRows(n);
  const Matrix Y = rows.future_y.topRows(p), U = rows.future_u.topRows(m);
  const Matrix C = solve_pivoted_qr(X.transpose(), Matrix(Y.transpose())).transpose();
  const Matrix E = Y - C * X;
  Matrix known(n + m + p, count), next(n, count);
  Index kept = 0;
  for (Index t = 0; t < count; ++t) {
    const Index follower = rows.follows[static_cast<std::size_t>(t)];
    if (follower < 0) continue;
    known.col(kept) << X.col(t), U.col(t), E.col(t);
    next.col(kept++) = X.col(follower);
  }
  const Matrix found =
      solve_pivoted_qr(known.leftCols(kept).transpose(), Matrix(next.leftCols(kept).transpose()))
          .transpose();
  LoopModel result;
  result.model = {
      found.leftCols(n), found.middleCols(n, m), C,       Matrix::Zero(p, m), found.rightCols(p),
      Vector::Zero(m),   Vector::Zero(p),        period_s};
  const auto variance = log_variance(E);
  if (!variance || !is_well_formed(result.model)) return std::nullopt;
  result.log_variance = *variance;
  return result;
}

}  // namespace

std::optional<double> log_variance(const Matrix& errors) {
  const Matrix covariance = errors * errors.transpose() / double(errors.cols());
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  if (!eigen.converged || !(eigen.values(0) > 0)) return std::nullopt;
  return eigen.values.array().log().sum();
}

std::optional<LoopModel> loop_model(const Record& record, RowRange rows, Index past,
                                    Index max_order) {
  assert(past >= 2 && max_order >= 1);
  const Index m = record.u.cols(), p = record.y.cols(), future = past;
  const Regressors found = regressors_of(record, rows, past, future);
  const Index count = found.past.cols();
  if (count < 3 * found.past.rows()) return std::nullopt;

  const Matrix arx =
      solve_pivoted_qr(found.past.transpose(), Matrix(found.future_y.topRows(p).transpose()))
          .transpose();
  const Matrix outputs = without_since(found, arx, m, p, future);
  // Canonical correlations of the past with these outputs: the states are their past side.
  const Matrix past_basis = orthonormal_basis(found.past.transpose());
  const Matrix output_basis = orthonormal_basis(outputs.transpose());
  const LeftSingular canonical =
      left_singular(past_basis.transpose() * output_basis, SingularVectors::thin);
  const Matrix states = (past_basis * canonical.U).transpose() * std::sqrt(double(count));
  if (!states.allFinite()) return std::nullopt;

  std::optional<LoopModel> best;
  double least = std::numeric_limits<double>::infinity();
  for (Index n = 1; n <= std::min<Index>(max_order, states.rows()); ++n) {
    auto candidate = realised(found, states, n, m, p, record.period_s);
    if (!candidate) continue;
    const double criterion =
        candidate->log_variance + double(n * (m + 2 * p)) * std::log(double(count)) / double(count);
    if (!(criterion < least)) continue;
    least = criterion;
    best = std::move(candidate);
  }
  return best;
}

}  // namespace reident::identification
