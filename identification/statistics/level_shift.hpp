// A step of the mean in what a model leaves of an output: a sensor that was set to another zero, or
// an equipment that is another one from there on. Nothing here throws.
#pragma once

#include <optional>
#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// The values from `row` on have a mean that is larger by `size`.
struct LevelShift {
  Index row = 0;
  double size = 0;
};

/// Returns the step that explains most of the values (N) but for what they are linear in the
/// columns (N x k) of inputs and of what a model makes of them: a gain that is wrong is no step (D.
/// V. Hinkley, "Inference about the change-point in a sequence of random variables", Biometrika 57,
/// 1970). It lies at least a tenth of the rows from either end. It has to be twice the deviation of
/// what is left, and six of its own standard errors, where correlated rows count as one; and to
/// leave a fifth less than a straight line does, which a drift is nearer to. Absent where none is,
/// and for fewer than 60 rows.
std::optional<LevelShift> level_shift(const Vector& values, const Matrix& columns,
                                      const std::vector<RowRange>& segments);

}  // namespace reident::identification
