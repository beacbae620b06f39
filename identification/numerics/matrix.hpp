// Matrices and vectors of the mathematics: dense, of doubles, stored by columns. Rows and columns
// are counted from 0. A vector is a column. Copies and products allocate memory, and nothing but
// std::bad_alloc is ever thrown; this is what "nothing throws" means in the other headers.
#pragma once

#include <Eigen/Core>

namespace reident::identification {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
/// Rows, columns and counts of them. Signed, so that differences are.
using Index = Eigen::Index;

}  // namespace reident::identification
