// Free run of a model over a record, and the errors of a run.
#pragma once

#include <optional>
#include <vector>

#include "identification/record.hpp"
#include "identification/state_space.hpp"

namespace reident::identification {

/// Outputs (rows.size() x p) of the model driven by the record's inputs alone. A segment's initial
/// state is the least-squares estimate from its first `initial_rows(model)` outputs; the first
/// segment starts from `x0` where one is given. Values may be non-finite for an unstable model.
Matrix free_run(const StateSpaceModel& model, const Record& record, RowRange rows,
                const std::optional<Vector>& x0 = std::nullopt);

/// Rows that the estimate of an initial state looks at: three times the order, at least one.
Index initial_rows(const StateSpaceModel& model);

/// Rows that the state at the beginning of a run is estimated from where there is no hurry; more
/// would say little of it.
constexpr Index state_rows = 500;

/// Least-squares initial state at `segment.begin` from the outputs of the segment's first `rows`
/// rows (all of them where the segment is shorter), minimum norm where they do not determine it.
Vector estimate_initial_state(const StateSpaceModel& model, const Record& record,
                              const Segment& segment, Index rows);

/// Errors of a simulated output against the measured one, one entry an output:
///   mrse_q = 100 ||y_q - yhat_q|| / ||y_q||            (the paper's equation 3 for one output)
///   fit_q  = 100 (1 - ||y_q - yhat_q|| / ||y_q - mean(y_q)||)
/// mrse is +inf where y_q is zero and the error is not; fit is -inf where y_q is constant and the
/// error is not.
struct Score {
  Vector mrse_percent;
  Vector fit_percent;
  Index rows = 0;

  double mrse() const { return mrse_percent.mean(); }
  double fit() const { return fit_percent.minCoeff(); }
};

/// Both matrices N x p, N >= 1.
Score score(const Matrix& y, const Matrix& y_hat);

/// Runs the model over `run` (state carried through each segment) and scores the rows in `scored`,
/// a part of `run`.
Score score_free_run(const StateSpaceModel& model, const Record& record, RowRange run,
                     RowRange scored, const std::optional<Vector>& x0 = std::nullopt);

}  // namespace reident::identification
