// Steps in what a model leaves of an output: its sensor was set to another zero, or the equipment
// is another one from there on. Nothing here throws.
#pragma once

#include <optional>
#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// From `row` on, what is left has a mean that is larger by `size`, or follows the model's output
/// by `size` times more.
struct Shift {
  enum class Of { mean, gain } of = Of::mean;
  Index row = 0;
  double size = 0;
};

/// Returns the step that explains most of the values (N), the errors of a model with the output
/// y_hat (N), but for what they are linear in the columns (N x k) of inputs and of what a model
/// makes of them: a gain that is wrong everywhere is no step (D. V. Hinkley, "Inference about the
/// change-point in a sequence of random variables", Biometrika 57, 1970). It lies at least a tenth
/// of the rows from either end. It has to be twice the deviation of what it leaves, and six of its
/// own standard errors, where correlated rows count as one. One of the mean has to leave a fifth
/// less than a straight line does, which a drift is nearer to. Absent where none is, and for fewer
/// than 60 rows.
std::optional<Shift> shift_of(const Vector& values, const Vector& y_hat, const Matrix& columns,
                              const std::vector<RowRange>& segments);

}  // namespace reident::identification
