#include "identification/simulation/segment_run.hpp"

#include <algorithm>

#include "identification/numerics/kernels.hpp"
#include "identification/simulation/nearly_empty.hpp"

namespace reident::identification {
namespace {

/// As run_state_space(), to the last bit.
void run_nearly_empty(const Eigen::SparseMatrix<double>& M, const Matrix& inputs, Index count,
                      Vector& x, Matrix& y) {
  Vector from(M.cols()), to(M.rows());
  for (Index k = 0; k < count; ++k) {
    from << x, inputs.col(k);
    to.noalias() = M * from;
    x = to.head(x.size());
    y.col(k) = to.tail(y.rows());
  }
}

}  // namespace

Vector run_segment(const StateSpaceModel& model, const Record& record, const Segment& segment,
                   Vector x, Matrix& y_hat, Index out) {
  constexpr Index tile_rows = 1024;  // at once, so that the work space stays small
  const Index n = model.order(), m = model.inputs(), p = model.outputs();
  Matrix M(n + p, n + m);
  M << model.A, model.B, model.C, model.D;
  const auto sparse = nearly_empty(M);
  Vector work(n + p);
  Matrix du(m, tile_rows), y(p, tile_rows);
  for (Index begin = segment.begin; begin < segment.end; begin += tile_rows) {
    const Index count = std::min(tile_rows, segment.end - begin);
    for (Index i = 0; i < m; ++i)
      du.row(i).head(count) =
          record.u.col(i).segment(begin, count).transpose().array() - model.u0(i);
    if (sparse)
      run_nearly_empty(*sparse, du, count, x, y);
    else
      run_state_space(M.data(), n, m, p, du.data(), count, x.data(), work.data(), y.data());
    for (Index q = 0; q < p; ++q)
      y_hat.col(q).segment(out + (begin - segment.begin), count) =
          y.row(q).head(count).transpose().array() + model.y0(q);
  }
  return x;
}

}  // namespace reident::identification
