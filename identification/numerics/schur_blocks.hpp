// A real Schur form whose diagonal blocks can be moved (METHOD.md, section 12). Private to
// the library. Nothing here throws.
#pragma once

#include <complex>
#include <vector>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// X of T11 X - X T22 = T12 for blocks of at most two rows, which have no eigenvalue in common.
Matrix sylvester(const Matrix& T11, const Matrix& T22, const Matrix& T12);

/// A = Q T Q' with T block upper triangular, blocks of one or two rows.
class SchurBlocks {
 public:
  /// Decomposes A (n x n). Requires a finite A. Without convergence there are no blocks although A
  /// has rows.
  explicit SchurBlocks(const Matrix& A);

  /// Blocks are counted from the upper end; of a pair of eigenvalues the one above the real axis
  /// is given.
  Index count() const { return static_cast<Index>(sizes_.size()); }
  Index size(Index block) const { return sizes_[static_cast<std::size_t>(block)]; }
  Index first_row(Index block) const;
  std::complex<double> eigenvalue(Index block) const;
  const Matrix& T() const { return T_; }
  const Matrix& Q() const { return Q_; }

  /// Exchanges a block with the one below it by the orthogonal Z that is returned, to be applied to
  /// the rows from first_row(block) on of whatever has the coordinates of T: rows = Z' rows.
  /// Two blocks whose eigenvalues are equal up to rounding and that are coupled stay, with Z = I:
  /// no orthogonal transformation exchanges them. Requires a block below.
  Matrix swap_with_next(Index block);

  /// Takes two neighbouring blocks as one. Requires that each has one row.
  void join_with_next(Index block);

  /// Takes the coordinates Z (of as many rows as the block) within a block.
  void rotate(Index block, const Matrix& Z);

  /// Sets what is below the diagonal of a block to zero and takes it as two. Requires that it has
  /// two rows.
  void split(Index block);

  /// Subtracts `columns` (n rows, one for each row of the block) from the block's columns of T.
  void subtract_from_columns(Index block, const Matrix& columns);

 private:
  void apply(Index row, const Matrix& Z);

  Matrix T_, Q_;
  std::vector<Index> sizes_;
};

}  // namespace reident::identification
