// The errors of a simulated output against the measured one. Nothing here throws.
#pragma once

#include <optional>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// One entry an output (p):
///   mrse_q = 100 ||y_q - yhat_q|| / ||y_q||            (the paper's equation 3 for one output)
///   fit_q  = 100 (1 - ||y_q - yhat_q|| / ||y_q - mean(y_q)||)
/// mrse is +inf where y_q is zero and the error is not; fit is -inf where y_q is constant and the
/// error is not. A run that is not finite has +inf and -inf.
struct Score {
  Vector mrse_percent;
  Vector fit_percent;
  Index rows = 0;

  double mrse() const { return mrse_percent.mean(); }
  double fit() const { return fit_percent.minCoeff(); }
};

/// Returns the errors of `y_hat` against `y`. Requires both N x p, N >= 1.
Score score(const Matrix& y, const Matrix& y_hat);

/// Runs the model over `run` as free_run() does, from `x0` (n) where one is given. Returns the
/// errors on the rows `scored`. Requires what free_run() does, and `scored` to be a part of `run`,
/// at least one row.
Score score_free_run(const StateSpaceModel& model, const Record& record, RowRange run,
                     RowRange scored, const std::optional<Vector>& x0 = std::nullopt);

}  // namespace reident::identification
