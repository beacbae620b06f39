// Errors of a free run on rows that the model was not fitted to (METHOD.md, section 7, "Folds").
// Private to the library. Nothing here throws.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "identification/fit/output_error_fit.hpp"
#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// A model is fitted on `fit` and scored on `tune`, the rows just before or just after.
struct Fold {
  RowRange fit;
  RowRange tune;

  /// Whether the scored rows follow the fitted ones.
  bool is_forwards() const { return fit.begin < tune.begin; }
  /// Return the fold with no more than so many rows to fit, or to score: those where the two meet.
  Fold with_fit_of(Index rows) const;
  Fold with_tune_of(Index rows) const;
};

/// Returns the four folds of `rows` rows: half of `tune_share` of them is held out at the end, and
/// as much before that, each fitted on what is before it; and so from the beginning. Requires at
/// least 3 rows and a share in (0, 1).
std::vector<Fold> folds_of(Index rows, double tune_share);

/// Parts of the rows held out that errors are summed over, too.
inline constexpr std::size_t error_blocks = 10;

/// What a model errs on the rows held out: mean over outputs of the root mean square over rows,
/// infinite for a model that does not stay finite, sums of squares of as many parts of the rows,
/// and the mean over outputs of the logarithm of the root mean square.
struct HeldOutError {
  double rms = 0;
  std::array<double, error_blocks> squares{};
  double log_rms = 0;
};

/// `recent` is that of the model whose operating point is moved to that of the fitted rows nearest
/// to the rows held out, for outputs whose zero drifts.
struct HeldOutErrors {
  HeldOutError whole;
  HeldOutError recent;
};

/// Returns the errors of a model fitted on the fold's rows, over its rows held out.
HeldOutErrors held_out_errors(const Response& response, const Record& record, const Fold& fold);

/// Returns the errors of a short run: the operating point is that of at most 512 fitted rows.
HeldOutErrors quick_held_out_errors(const StateSpaceModel& model, const Record& record,
                                    const Fold& fold);

/// Returns the error of the mean of the fitted rows as a model, mean over the folds.
double held_out_error_of_constant(const Record& record, const std::vector<Fold>& folds);

/// Returns the mean over the folds of the error of a regression on a straight line in time, the
/// inputs, and their sums from the first row on, which decay by each of the `rates` [1/row], 0 or
/// above. Inputs are held over holes. It takes at most 1000 rows, equally far apart.
double held_out_error_of_sums(const Record& record, const std::vector<Fold>& folds,
                              const std::vector<double>& rates);

/// Returns the mean residual (p) of a fit over the last half (`towards_end`) or the first half of
/// its rows: what its y0 is moved by to the recent operating point.
Vector recent_operating_point(const Matrix& residuals, bool towards_end);

}  // namespace reident::identification
