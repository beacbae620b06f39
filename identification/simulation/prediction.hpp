// Prediction by the innovations form: the model corrected by the measured outputs up to a row, and
// run from there on its inputs alone.
//
//   xh[k+1] = A xh[k] + B (u[k] - u0) + K (y[k] - yh[k]),   yh[k] = C xh[k] + D (u[k] - u0) + y0
//
// Both it and the free run start each segment from the same state. Their difference d = xh - x_free
// follows from the free run's residual e = y - y_free alone, and gives the prediction for any
// number of steps without another run:
//
//   d[k+1] = (A - K C) d[k] + K e[k],   d = 0 at the first row of a segment
//   y[t | t - h] = y_free[t] + C A^(h-1) d[t - h + 1]
//
// (L. Ljung, "System Identification", 2nd edition, Prentice Hall, 1999, section 3.2).
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

class Predictor {
 public:
  /// Of a model with K, over the rows of `y_free` (N x p), its free run over `run`. The rows of the
  /// record are finite there.
  Predictor(const StateSpaceModel& model, const Record& record, RowRange run, Matrix y_free);

  /// Outputs (N x p) as they are foretold `steps` >= 1 rows before, from the outputs up to there. A
  /// row closer than that to the start of its segment is foretold from the segment's initial state,
  /// so that predictions of any number of steps are of the same rows.
  Matrix outputs(Index steps) const;

 private:
  Matrix A_, C_;
  Matrix y_free_;
  Matrix d_;  // n x N
  std::vector<RowRange> stretches_;
};

}  // namespace reident::identification
