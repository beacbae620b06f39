// Whether outputs follow rows of an input that stand out: a sensor that spikes is told from pulses
// of the equipment by what they do. Nothing here throws.
#pragma once

#include <array>
#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// How much of what a model says that movements of an input do is in the outputs.
struct Followed {
  double share = 1;      // 1: all of it; 0: nothing
  double deviation = 0;  // its standard error
};

/// Returns what two parts of an input's movements do, as those of some rows and the rest. `errors`
/// (N x p) are those of a model, and `effects` (N x p each) what its outputs have of each part. A
/// share is one more than the coefficient of the regression of the errors on the effects, where all
/// are less what the errors before explain (burg_coefficients()), and outputs are weighed by what
/// is left. The standard errors are those of clusters (K.-Y. Liang and S. L. Zeger, "Longitudinal
/// data analysis using generalized linear models", Biometrika 73, 1986), which begin with each
/// range of `rows`, which ascend, and in 20 other places. They are no less than those of white
/// errors, times what the second share's are more than its own of white errors. Shares of 1 where
/// the effects cannot be told from each other or from nothing. Requires outputs of which each has
/// errors.
std::array<Followed, 2> followed(const Matrix& errors, const std::array<Matrix, 2>& effects,
                                 const std::vector<Index>& rows,
                                 const std::vector<RowRange>& segments);

/// Returns the values with a straight line within each segment in place of these rows, which
/// ascend; the value of the nearest other row at an end. A segment of such rows alone stays.
Vector bridged(Vector values, const std::vector<Index>& rows,
               const std::vector<RowRange>& segments);

}  // namespace reident::identification
