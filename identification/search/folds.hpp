// Errors of a free run on rows that the model was not fitted to.
#pragma once

#include <vector>

#include "identification/fit/output_error_fit.hpp"
#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// A model is fitted on `fit` and scored on `tune`, the rows just before or just after.
struct Fold {
  RowRange fit;
  RowRange tune;

  bool is_forwards() const { return fit.begin < tune.begin; }
  /// With no more than so many rows to fit or to score: those where the two meet.
  Fold with_fit_of(Index rows) const;
  Fold with_tune_of(Index rows) const;
};

/// The four folds of `rows` rows, at least 3: half of `tune_share` of them is held out at the end,
/// and as much before that, each fitted on what lies before it; and the same from the beginning.
std::vector<Fold> folds_of(Index rows, double tune_share);

/// An error is the mean over outputs of the root mean square over the rows held out. `recent` is
/// that of the model whose operating point is moved to that of the fitted rows nearest to them, for
/// outputs whose zero drifts. Infinite for a model that does not stay finite.
struct HeldOutErrors {
  double whole = 0;
  double recent = 0;
};

/// Of a model fitted on the fold's rows, over its rows held out.
HeldOutErrors held_out_errors(const Response& response, const Record& record, const Fold& fold);

/// The same from a short run: the operating point is that of at most 512 fitted rows.
HeldOutErrors quick_held_out_errors(const StateSpaceModel& model, const Record& record,
                                    const Fold& fold);

/// The error of the model that says the mean of the fitted rows, mean over the folds.
double held_out_error_of_constant(const Record& record, const std::vector<Fold>& folds);

/// Mean residual of a fit over the last half (`towards_end`) or the first half of its rows: what
/// its y0 is moved by to the recent operating point.
Vector recent_operating_point(const Matrix& residuals, bool towards_end);

}  // namespace reident::identification
