// Matrices of models with delays: as many states hand on a value, and hardly anything is filled.
// Private to the library.
#pragma once

#include <optional>

#include <Eigen/SparseCore>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// The matrix without its zeros where it has many states (columns) and is nearly empty. A product
/// with a vector has the bits of the sum over the columns in their order.
inline std::optional<Eigen::SparseMatrix<double>> nearly_empty(const Matrix& M) {
  constexpr Index least_states = 13;
  constexpr double most_filled = 0.25;
  if (M.cols() < least_states || double((M.array() != 0).count()) >= most_filled * double(M.size()))
    return std::nullopt;
  return Eigen::SparseMatrix<double>(M.sparseView(0, 0));
}

}  // namespace reident::identification
