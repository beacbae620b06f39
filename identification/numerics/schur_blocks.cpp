#include "identification/numerics/schur_blocks.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "identification/numerics/decompositions.hpp"

namespace reident::identification {
namespace {

constexpr double accepted_swap = 1e-13;  // of the blocks' size, left below the diagonal

Matrix exchange(Index n1, Index n2) {
  Matrix Z = Matrix::Zero(n1 + n2, n1 + n2);
  Z.topRightCorner(n1, n1).setIdentity();
  Z.bottomLeftCorner(n2, n2).setIdentity();
  return Z;
}

}  // namespace

Matrix sylvester(const Matrix& T11, const Matrix& T22, const Matrix& T12) {
  const Index n1 = T11.rows(), n2 = T22.rows();
  Matrix operation = Matrix::Zero(n1 * n2, n1 * n2);
  for (Index column = 0; column < n2; ++column) {
    operation.block(column * n1, column * n1, n1, n1) += T11;
    for (Index other = 0; other < n2; ++other)
      operation.block(column * n1, other * n1, n1, n1) -=
          T22(other, column) * Matrix::Identity(n1, n1);
  }
  const Vector x = solve_full_lu(operation, Vector(T12.reshaped()));
  return x.reshaped(n1, n2);
}

SchurBlocks::SchurBlocks(const Matrix& A) {
  assert(A.rows() == A.cols() && A.allFinite());
  if (A.rows() == 0) return;
  const auto schur = real_schur(A);
  if (!schur) return;
  T_ = schur->T;
  Q_ = schur->Q;
  for (Index row = 0; row < A.rows(); row += sizes_.back())
    sizes_.push_back(row + 1 < A.rows() && T_(row + 1, row) != 0 ? 2 : 1);
}

Index SchurBlocks::first_row(Index block) const {
  return std::accumulate(sizes_.begin(), sizes_.begin() + block, Index{0});
}

std::complex<double> SchurBlocks::eigenvalue(Index block) const {
  const Index row = first_row(block);
  if (size(block) == 1) return T_(row, row);
  const double centre = (T_(row, row) + T_(row + 1, row + 1)) / 2;
  const double half = (T_(row, row) - T_(row + 1, row + 1)) / 2;
  const double square = half * half + T_(row, row + 1) * T_(row + 1, row);
  return square < 0 ? std::complex<double>(centre, std::sqrt(-square)) : centre;
}

void SchurBlocks::apply(Index row, const Matrix& Z) {
  T_.middleRows(row, Z.rows()) = (Z.transpose() * T_.middleRows(row, Z.rows())).eval();
  T_.middleCols(row, Z.rows()) = (T_.middleCols(row, Z.rows()) * Z).eval();
  Q_.middleCols(row, Z.rows()) = (Q_.middleCols(row, Z.rows()) * Z).eval();
}

Matrix SchurBlocks::swap_with_next(Index block) {
  const Index row = first_row(block), n1 = size(block), n2 = size(block + 1), n = n1 + n2;
  const Matrix local = T_.block(row, row, n, n);
  Matrix Z = exchange(n1, n2);
  if (local.topRightCorner(n1, n2).norm() > 0) {
    // The columns of [-X; I] span the invariant subspace of the lower block.
    const Matrix X = sylvester(local.topLeftCorner(n1, n1), local.bottomRightCorner(n2, n2),
                               local.topRightCorner(n1, n2));
    Matrix subspace(n, n2);
    subspace << -X, Matrix::Identity(n2, n2);
    subspace /= std::max(1.0, X.norm());
    Z = orthogonal_factor(subspace);
  }
  const Matrix swapped = Z.transpose() * local * Z;
  if (!(swapped.bottomLeftCorner(n1, n2).norm() <= accepted_swap * local.norm()))
    return Matrix::Identity(n, n);
  apply(row, Z);
  T_.block(row + n2, row, n1, n2).setZero();
  std::swap(sizes_[static_cast<std::size_t>(block)], sizes_[static_cast<std::size_t>(block + 1)]);
  return Z;
}

void SchurBlocks::join_with_next(Index block) {
  assert(size(block) == 1 && size(block + 1) == 1);
  sizes_[static_cast<std::size_t>(block)] = 2;
  sizes_.erase(sizes_.begin() + block + 1);
}

void SchurBlocks::rotate(Index block, const Matrix& Z) {
  apply(first_row(block), Z);
}

void SchurBlocks::split(Index block) {
  assert(size(block) == 2);
  const Index row = first_row(block);
  T_(row + 1, row) = 0;
  sizes_[static_cast<std::size_t>(block)] = 1;
  sizes_.insert(sizes_.begin() + block, 1);
}

void SchurBlocks::subtract_from_columns(Index block, const Matrix& columns) {
  const Index rows = first_row(block) + size(block);
  T_.block(0, first_row(block), rows, size(block)) -= columns.topRows(rows);
}

}  // namespace reident::identification
