// B and D from the compressed data (METHOD.md, section 6, "From the compression").
#pragma once

#include "identification/simulation/state_space.hpp"
#include "identification/subspace/projection.hpp"

namespace reident::identification {

/// Returns the model with the finite A (n x n) and C (p x n) whose B and D solve
///   (I - G G^+) Y_f = (I - G G^+) H(B, D) U_f,  G = [C; C A; ...],
/// by least squares over the part of Y_f in the rows of U_f; of least norm where U_f does not
/// determine them. Without `direct` D is zero; K is empty, u0 and y0 are zero. Nothing throws.
StateSpaceModel with_response(const Projection& projection, const Matrix& A, const Matrix& C,
                              bool direct, double period_s);

}  // namespace reident::identification
