// Matrices and vectors of the mathematics.
#pragma once

#include <Eigen/Core>

namespace reident::identification {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Index = Eigen::Index;

}  // namespace reident::identification
