#include "identification/simulation/scores.hpp"

#include <cassert>
#include <cmath>
#include <limits>

#include "identification/simulation/free_run.hpp"

namespace reident::identification {

Score score(const Matrix& y, const Matrix& y_hat) {
  assert(y.rows() == y_hat.rows() && y.cols() == y_hat.cols() && y.rows() > 0);
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
