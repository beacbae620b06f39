#include "identification/numerics/gram.hpp"

#include "identification/numerics/kernels.hpp"

namespace reident::identification {

Matrix lower_gram(const Matrix& V) {
  const VectorSequence columns{V.data(), V.rows(), V.rows()};
  Matrix sums = Matrix::Zero(V.rows(), V.rows());
  add_outer_products(columns, columns, V.cols(), Triangle::lower, sums.data());
  return sums;
}

}  // namespace reident::identification
