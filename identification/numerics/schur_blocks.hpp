// A real Schur form whose diagonal blocks can be moved.
#pragma once

#include <complex>
#include <vector>

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// A = Q T Q' with T block upper triangular, blocks of one or two rows.
class SchurBlocks {
 public:
  /// A is square and finite. Without convergence there are no blocks although A has rows.
  explicit SchurBlocks(const Matrix& A);

  Index count() const { return static_cast<Index>(sizes_.size()); }
  Index size(Index block) const { return sizes_[static_cast<std::size_t>(block)]; }
  Index first_row(Index block) const;
  std::complex<double> eigenvalue(Index block) const;  // of a pair the one above the real axis
  const Matrix& T() const { return T_; }
  const Matrix& Q() const { return Q_; }

  /// Exchanges a block with the one below it by the orthogonal Z that is returned, to be applied to
  /// the rows from first_row(block) on of whatever has the coordinates of T: rows = Z' rows.
  /// Two blocks whose eigenvalues are equal up to rounding and that are coupled stay, with Z = I:
  /// no orthogonal transformation exchanges them, and nothing tells them apart.
  Matrix swap_with_next(Index block);

  /// Takes two neighbouring blocks of one row as one of two.
  void join_with_next(Index block);

  /// Takes the coordinates Z (of as many rows as the block) within a block.
  void rotate(Index block, const Matrix& Z);

  /// Sets what is below the diagonal of a block of two rows to zero and takes it as two.
  void split(Index block);

  /// T -= columns of the block's states, of n rows.
  void subtract_from_columns(Index block, const Matrix& columns);

 private:
  void apply(Index row, const Matrix& Z);

  Matrix T_, Q_;
  std::vector<Index> sizes_;
};

}  // namespace reident::identification
