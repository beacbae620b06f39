// Free run of a model over a record, and the errors of a run.
#pragma once

#include <optional>
#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Rows that the state at the beginning of a run is estimated from where there is no hurry; more
/// would say little of it. Fewer leave noise in the slow states, which stays for as long as these
/// last.
constexpr Index state_rows = 500;

/// Outputs (rows.size() x p) of the model driven by the record's inputs alone. It starts from `x0`
/// where one is given, and else from the least-squares estimate from the first `state_rows`
/// outputs, as it does after a hole that state_after_hole does not bridge. Values may be non-finite
/// for an unstable model.
Matrix free_run(const StateSpaceModel& model, const Record& record, RowRange rows,
                const std::optional<Vector>& x0 = std::nullopt);

/// Squares of signals' changes from one row to the next, one entry a signal.
struct SquareChanges {
  Vector mean;
  Vector usual;  // the median, over that of the square of a unit normal: without rare steps
};
/// Of N x m signals within the stretches; 0 where no two rows follow each other.
SquareChanges square_changes(const Matrix& signals, const std::vector<RowRange>& stretches);
/// Of the record's inputs.
SquareChanges square_changes(const Record& record);

/// How uncertain a run is.
struct RunNoise {
  SquareChanges input_changes;
  Vector square_errors;  // p, means over the run so far
};

/// State (n) at the first row of the segment `after` of a run that has come to the state `x` at the
/// tick behind the segment `before`. The run goes through the hole between them with interpolated
/// inputs, which are off by about as much as inputs usually change from tick to tick, by half of
/// what they differ at its ends, and in longer holes by steps that do not show there; what that
/// makes uncertain of the state is estimated from the first `state_rows` outputs behind the hole:
/// least squares with the one as the prior and the run's errors as the noise (a step of a Kalman
/// smoother). Slow states so come from the run, and fast ones from the outputs. A run that began
/// anew behind each hole, or took much from the outputs there, would never show that it drifts.
/// Absent where the hole is longer than 60 ticks and than a hundredth of the record's rows.
std::optional<Vector> state_after_hole(const StateSpaceModel& model, const Record& record,
                                       const Segment& before, const Segment& after, const Vector& x,
                                       const RunNoise& noise);

/// Rows that an estimate of the initial state needs: three times the order, at least one.
Index initial_rows(const StateSpaceModel& model);

/// Least-squares initial state at the first row of `segments`, which are of the record and ascend,
/// from the outputs of the first `rows` rows, minimum norm where they do not determine it. Holes
/// that state_after_hole bridges are gone through as uncertainly as there, so that a run which
/// begins just before one does not rest on the few rows there; rows behind a longer one, or further
/// than twice `rows` ticks away, are not used.
Vector estimate_initial_state(const StateSpaceModel& model, const Record& record,
                              const std::vector<Segment>& segments, Index rows);

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
