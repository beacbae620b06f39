// What the inputs of a window can show: which of them follow from others, and up to which order
// they excite the model (METHOD.md, sections 3 and 5). Nothing here throws.
#pragma once

#include <vector>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// An input that others explain at every row, such as I_BUS = I_SG2 + I_BDROUT.
struct RedundantInput {
  Index input;
  std::vector<Index> explained_by;  // earlier inputs, ascending
};

/// Returns the inputs (columns of `u`, N x m, normalised) of which less than 1e-6 of the deviation
/// is left once the inputs before them are known, ascending.
std::vector<RedundantInput> redundant_inputs(const Matrix& u);

/// Whether each input has so much of its own, given those before it, that none is redundant; from
/// their correlations (m x m). Where not, redundant_inputs() decides.
bool are_independent(const Matrix& correlation);

/// How many block rows the inputs excite persistently, and the input that excites the last of them.
struct Excitation {
  Index order = 0;
  Index strongest_input = 0;
};

/// Returns the excitation from the deviations of Projection::input_innovations() (horizon x m) of
/// normalised inputs: a block row counts while one of its innovations is at least 1e-7.
Excitation excitation_of(const Matrix& input_innovations);

}  // namespace reident::identification
