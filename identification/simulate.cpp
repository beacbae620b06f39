#include "identification/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/kernels.hpp"

namespace reident::identification {
namespace {

/// Runs one segment from `x`; writes its outputs into y_hat from row `out` on.
void run_segment(const StateSpaceModel& model, const Record& record, const Segment& segment,
                 Vector x, Matrix& y_hat, Index out) {
  constexpr Index stretch = 1024;  // of rows at once, so that the work space stays small
  const Index n = model.order(), m = model.inputs(), p = model.outputs();
  Matrix M(n + p, n + m);
  M << model.A, model.B, model.C, model.D;
  Vector work(n + p);
  Matrix du(m, stretch), y(p, stretch);
  for (Index begin = segment.begin; begin < segment.end; begin += stretch) {
    const Index count = std::min(stretch, segment.end - begin);
    for (Index i = 0; i < m; ++i)
      du.row(i).head(count) =
          record.u.col(i).segment(begin, count).transpose().array() - model.u0(i);
    run_state_space(M.data(), n, m, p, du.data(), count, x.data(), work.data(), y.data());
    for (Index q = 0; q < p; ++q)
      y_hat.col(q).segment(out + (begin - segment.begin), count) =
          y.row(q).head(count).transpose().array() + model.y0(q);
  }
}

}  // namespace

Index initial_rows(const StateSpaceModel& model) {
  return std::max<Index>(1, 3 * model.order());
}

Vector estimate_initial_state(const StateSpaceModel& model, const Record& record,
                              const Segment& segment, Index rows) {
  const Index n = model.order(), p = model.outputs();
  const Index count = std::min(rows, segment.size());
  if (n == 0 || count == 0) return Vector::Zero(n);

  // y[k] - (response from the zero state) = C A^k x0
  Matrix forced(count, p);
  run_segment(model, record, {segment.begin, segment.begin + count, segment.first_tick},
              Vector::Zero(n), forced, 0);
  Matrix observability(count * p, n);
  Vector free_response(count * p);
  Matrix CAk = model.C;
  for (Index k = 0; k < count; ++k) {
    observability.middleRows(k * p, p) = CAk;
    free_response.segment(k * p, p) = (record.y.row(segment.begin + k) - forced.row(k)).transpose();
    CAk = (CAk * model.A).eval();
  }
  if (!observability.allFinite() || !free_response.allFinite()) return Vector::Zero(n);
  return observability.completeOrthogonalDecomposition().solve(free_response);
}

Matrix free_run(const StateSpaceModel& model, const Record& record, RowRange rows,
                const std::optional<Vector>& x0) {
  Matrix y_hat(rows.size(), model.outputs());
  Index out = 0;
  for (const Segment& segment : segments_within(record, rows)) {
    const bool given = x0 && out == 0;
    run_segment(model, record, segment,
                given ? *x0 : estimate_initial_state(model, record, segment, initial_rows(model)),
                y_hat, out);
    out += segment.size();
  }
  eigen_assert(out == rows.size());
  return y_hat;
}

Score score(const Matrix& y, const Matrix& y_hat) {
  eigen_assert(y.rows() == y_hat.rows() && y.cols() == y_hat.cols() && y.rows() > 0);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Score result{Vector(y.cols()), Vector(y.cols()), y.rows()};
  for (Index q = 0; q < y.cols(); ++q) {
    const double error = (y.col(q) - y_hat.col(q)).stableNorm();
    const double size = y.col(q).stableNorm();
    const double spread = (y.col(q).array() - y.col(q).mean()).matrix().stableNorm();
    // The mean of a constant may be rounded: its spread is zero all the same.
    const bool constant = y.col(q).maxCoeff() == y.col(q).minCoeff();
    const double mrse = error == 0 ? 0.0 : 100 * error / size;
    double fit = 100 * (1 - error / spread);
    if (constant) fit = error == 0 ? 100.0 : -infinity;
    result.mrse_percent(q) = std::isnan(mrse) ? infinity : mrse;
    result.fit_percent(q) = std::isnan(fit) ? -infinity : fit;
  }
  return result;
}

Score score_free_run(const StateSpaceModel& model, const Record& record, RowRange run,
                     RowRange scored, const std::optional<Vector>& x0) {
  const Matrix y_hat = free_run(model, record, run, x0);
  return score(record.y.middleRows(scored.begin, scored.size()),
               y_hat.middleRows(scored.begin - run.begin, scored.size()));
}

}  // namespace reident::identification
