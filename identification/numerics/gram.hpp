// Gram matrices with the same bits on every machine: Eigen's product of long matrices is summed in
// blocks of a length that follows the processor's cache. Private to the library.
#pragma once

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// Returns the lower triangle of V V' (n x n) for V of n x N; what is above it has no meaning.
Matrix lower_gram(const Matrix& V);

}  // namespace reident::identification
