// The part of a model that is linear once A and C are given, fitted to the simulated output, and
// the refinement of A and C (METHOD.md, sections 6 and 9). Records are of normalised channels,
// whose operating point is zero. Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"
#include "identification/statistics/autoregression.hpp"

namespace reident::identification {

/// A fitted model.
struct Response {
  StateSpaceModel model;  // in normalised channels: u0 = 0; K empty
  Vector x0;              // state at the first row
  double error = 0;       // root mean square over rows of the output error's norm
};

/// What is asked of the normal equations before the regressors themselves are factored: `fast` five
/// digits of the solution, or of the output where that is not determined, `exact` ten.
enum class Accuracy { fast, exact };

/// Fits B, D, y0 and the initial states for A (n x n) and C (p x n) to `rows`; of least norm where
/// the rows do not determine them. Without `direct` D is zero. Requires a stable A. Where the
/// `colours` of the outputs' errors are given, `error` is that of the errors made white.
Response fit_response(const Matrix& A, const Matrix& C, bool direct, const Record& record,
                      RowRange rows, Accuracy accuracy,
                      const std::vector<ErrorColour>& colours = {});

/// Fits like fit_response(), with D, where the outputs are what a known model leaves of them. The
/// solution is that of least squares where the rows determine it with confidence, and near zero
/// where they do not (METHOD.md, section 18). Zero where there are no more rows than unknowns.
Response fit_change(const Matrix& A, const Matrix& C, const Record& record, RowRange rows);

/// Returns what each row's errors have moved the static gain of each input by (rows x m), for each
/// output, where B, D, y0 and the initial states are fitted like fit_response(): what its estimate
/// weighs these errors with, times the errors. A gain's estimate errs by the sum over the rows.
/// Empty where I - A is singular or the rows leave no errors to judge.
std::vector<Matrix> gain_errors_by_row(const Matrix& A, const Matrix& C, bool direct,
                                       const Record& record, RowRange rows);

/// Fits like fit_response(), with A and C moved by at most `steps` Levenberg-Marquardt steps that
/// lower the output error. The result is stable, and no step takes a mode below the least rate,
/// |ln| [1/row] of an eigenvalue.
Response refine_response(const Matrix& A, const Matrix& C, bool direct, const Record& record,
                         RowRange rows, int steps, double least_rate = 0);

/// Returns what the free run of a fit leaves of the outputs (rows x p).
Matrix errors_of(const Response& fit, const Record& record, RowRange rows);

/// Returns the colour of the errors of a fit to `rows`, one for each output.
std::vector<ErrorColour> colours_of(const Response& fit, const Record& record, RowRange rows);

/// Returns what each output errs of a fit to `rows`, as colours of errors that are white.
std::vector<ErrorColour> deviations_of(const Response& fit, const Record& record, RowRange rows);

/// Refines a fit like refine_response(), where the errors have these colours: of the steps each
/// lowers the sum of squares of the errors made white. `error` is that of these.
Response refine_whitened(const Response& fit, bool direct, const Record& record, RowRange rows,
                         int steps, const std::vector<ErrorColour>& colours, double least_rate = 0);

}  // namespace reident::identification
