// Two states: the feedback of least norm (METHOD.md, section 12). Private to the library.
#pragma once

#include <Eigen/Core>

namespace reident::identification {

/// Returns the M of the given trace and determinant for which the rows of A - M, divided by sigma_1
/// and sigma_2, have the least sum of squares: with inputs diag(sigma) the feedback diag(1 / sigma)
/// (A - M) then leaves M of A. `ratio` is sigma_2 / sigma_1, in (0, 1].
Eigen::Matrix2d nearest_with_poles(const Eigen::Matrix2d& A, double ratio, double trace,
                                   double determinant);

/// Returns the only such M where sigma_2 is zero: the second row stays. Requires A(1, 0) != 0.
Eigen::Matrix2d first_row_with_poles(const Eigen::Matrix2d& A, double trace, double determinant);

}  // namespace reident::identification
