// Inverse scaling and squaring (Higham, Functions of Matrices, 2008, chapter 11): square roots of
// the real Schur form until it is near I, log(I + X) by a quadrature, and log T = 2^k log
// T^(1/2^k).
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/schur_blocks.hpp"

namespace reident::identification {
namespace {

/// log(I + X) is the integral of X (I + t X)^-1 over t from 0 to 1. The seven nodes of Gauss and
/// Legendre give it to rounding for |X| <= near_identity (Higham, table 11.1).
struct QuadratureNode {
  double t, weight;
};
constexpr std::array<QuadratureNode, 7> quadrature = {{
    {0.5 - 0.9491079123427585 / 2, 0.1294849661688697 / 2},
    {0.5 - 0.7415311855993945 / 2, 0.2797053914892766 / 2},
    {0.5 - 0.4058451513773972 / 2, 0.3818300505051189 / 2},
    {0.5, 0.4179591836734694 / 2},
    {0.5 + 0.4058451513773972 / 2, 0.3818300505051189 / 2},
    {0.5 + 0.7415311855993945 / 2, 0.2797053914892766 / 2},
    {0.5 + 0.9491079123427585 / 2, 0.1294849661688697 / 2},
}};
constexpr double near_identity = 0.264;
constexpr int most_roots = 100;  // a logarithm of 1e29: no digit of it would be right

/// A diagonal block of a real Schur form: one row, or two of a conjugate pair of eigenvalues, of
/// which the one above the real axis is given.
struct DiagonalBlock {
  Index first, size;
  std::complex<double> eigenvalue;
};

std::vector<DiagonalBlock> diagonal_blocks(const SchurBlocks& schur) {
  std::vector<DiagonalBlock> blocks;
  for (Index i = 0; i < schur.count(); ++i) {
    std::complex<double> eigenvalue = schur.eigenvalue(i);
    // A double eigenvalue: the quotient in function_of_block becomes the derivative.
    if (schur.size(i) == 2 && eigenvalue.imag() == 0)
      eigenvalue.imag(1e-30 * std::abs(eigenvalue.real()));
    blocks.push_back({schur.first_row(i), schur.size(i), eigenvalue});
  }
  return blocks;
}

/// f(T) of a block, given f of its eigenvalue.
Matrix function_of_block(const Matrix& T, const DiagonalBlock& block, std::complex<double> value) {
  Matrix result = value.real() * Matrix::Identity(block.size, block.size);
  if (block.size == 1) return result;
  Matrix off_centre = T.block(block.first, block.first, 2, 2);  // less half of its trace, exactly
  const double half = (off_centre(0, 0) - off_centre(1, 1)) / 2;
  off_centre.diagonal() << half, -half;
  return result + value.imag() / block.eigenvalue.imag() * off_centre;
}

/// The principal square root of T, block by block; `blocks` get the eigenvalues of the root.
Matrix square_root(const Matrix& T, std::vector<DiagonalBlock>& blocks) {
  Matrix R = Matrix::Zero(T.rows(), T.cols());
  for (std::size_t j = 0; j < blocks.size(); ++j) {
    const Index column = blocks[j].first, width = blocks[j].size;
    const std::complex<double> root = std::sqrt(blocks[j].eigenvalue);
    R.block(column, column, width, width) = function_of_block(T, blocks[j], root);
    blocks[j].eigenvalue = root;
    for (std::size_t i = j; i-- > 0;) {
      const Index row = blocks[i].first, height = blocks[i].size;
      const Index between = row + height, count = column - between;
      R.block(row, column, height, width) = sylvester(
          R.block(row, row, height, height), -R.block(column, column, width, width),
          T.block(row, column, height, width) -
              R.block(row, between, height, count) * R.block(between, column, count, width));
    }
  }
  return R;
}

}  // namespace

Matrix matrix_logarithm(const Matrix& A) {
  const Index n = A.rows();
  const Matrix I = Matrix::Identity(n, n);
  const Matrix none = Matrix::Constant(n, n, std::numeric_limits<double>::quiet_NaN());
  if (!A.allFinite()) return none;
  const SchurBlocks schur(A);
  const std::vector<DiagonalBlock> of_T = diagonal_blocks(schur);
  if (n > 0 && of_T.empty()) return none;
  for (const DiagonalBlock& block : of_T)
    if (block.size == 1 && !(block.eigenvalue.real() > 0)) return none;

  Matrix X = schur.T();
  std::vector<DiagonalBlock> blocks = of_T;
  int roots = 0;
  for (; (X - I).norm() > near_identity; ++roots) {
    if (roots == most_roots) return none;
    X = square_root(X, blocks);
  }
  X -= I;
  Matrix L = Matrix::Zero(n, n);
  for (const QuadratureNode& node : quadrature) L += node.weight * solve_lu(I + node.t * X, X);
  L *= std::ldexp(1.0, roots);
  for (const DiagonalBlock& block : of_T)  // without the rounding of the roots
    L.block(block.first, block.first, block.size, block.size) =
        function_of_block(schur.T(), block, std::log(block.eigenvalue));
  return schur.Q() * L * schur.Q().transpose();
}

}  // namespace reident::identification
