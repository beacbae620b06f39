// The part of a model that is linear once A and C are given, and the refinement of A and C.
//
//   y[k] = C A^k x0 + sum_{j<k} C A^(k-1-j) B u[j] + D u[k] + y0
//
// is linear in B, D, y0 and in one initial state for each segment, so that these follow from linear
// least squares on the simulated output. What is left of the output error is a function of A and C
// alone, and Levenberg-Marquardt steps lower it (METHOD.md, "Refinement").
#pragma once

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

struct Response {
  StateSpaceModel model;  // in normalised channels: u0 = 0; K empty
  Vector x0;              // state at the first row
  double error = 0;       // root mean square over rows of the output error's norm
};

/// What is asked of the normal equations before the regressors themselves are factored: `fast` some
/// five digits of the solution, or of the output where that is not determined, `exact` ten.
enum class Accuracy { fast, exact };

/// B, D, y0 and the initial states for A (stable) and C over `rows`; of least norm where the rows
/// do not determine them. Without `direct` D is zero.
Response fit_response(const Matrix& A, const Matrix& C, bool direct, const Record& record,
                      RowRange rows, Accuracy accuracy);

/// The same for a target that is what a known model leaves of the output, with D: the least squares
/// solution where the rows tell it, and near zero where they do not. Of each principal component of
/// the regressors the share t^2 / (t^2 + 4) is taken, t being its coefficient over its standard
/// deviation: a generalized ridge regression (A. E. Hoerl, R. W. Kennard, Technometrics 12(1),
/// 1970, section 5). Rows whose errors are correlated count as so many fewer, of all outputs as of
/// the one where they are most, which is on the safe side. Nothing changes where there are no more
/// rows than unknowns.
Response fit_change(const Matrix& A, const Matrix& C, const Record& record, RowRange rows);

/// As fit_response, with A and C moved by at most `steps` Levenberg-Marquardt steps that lower the
/// output error. The result is stable when A is.
Response refine_response(const Matrix& A, const Matrix& C, bool direct, const Record& record,
                         RowRange rows, int steps);

}  // namespace reident::identification
