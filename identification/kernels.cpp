#include "identification/kernels.hpp"

#include <cmath>
#include <cstddef>

#include "identification/cpu_clones.hpp"

namespace reident::identification {

namespace {

/// Rows [i, i + 4 Quads) of Columns columns of S: their sums stay in registers for all k.
template <std::size_t Quads, std::size_t Columns>
REIDENT_INLINE void outer_product_tile(const double* a, Index a_stride, const double* b,
                                       Index b_stride, Index count, double* S, Index rows) {
  Four sums[Quads][Columns] = {};
  for (Index k = 0; k < count; ++k, a += a_stride, b += b_stride)
    for (std::size_t q = 0; q < Quads; ++q) {
      const Four left = load(a + 4 * q);
      for (std::size_t j = 0; j < Columns; ++j) sums[q][j] += left * b[j];
    }
  for (std::size_t j = 0; j < Columns; ++j)
    for (std::size_t q = 0; q < Quads; ++q) {
      double* to = S + Index(j) * rows + 4 * q;
      store(to, load(to) + sums[q][j]);
    }
}

template <std::size_t Columns>
REIDENT_INLINE void outer_product_strip(const VectorSequence& a, const double* b, Index b_stride,
                                        Index count, Index first_row, double* S) {
  const Index rows = a.size;
  Index i = first_row;
  for (; i + 8 <= rows; i += 8)
    outer_product_tile<2, Columns>(a.data + i, a.stride, b, b_stride, count, S + i, rows);
  if (i + 4 <= rows) {
    outer_product_tile<1, Columns>(a.data + i, a.stride, b, b_stride, count, S + i, rows);
    i += 4;
  }
  for (; i < rows; ++i) {
    double sums[Columns] = {};
    for (Index k = 0; k < count; ++k)
      for (std::size_t j = 0; j < Columns; ++j)
        sums[j] += a.data[k * a.stride + i] * b[k * b_stride + Index(j)];
    for (std::size_t j = 0; j < Columns; ++j) S[Index(j) * rows + i] += sums[j];
  }
}

}  // namespace

REIDENT_CLONES
void add_outer_products(const VectorSequence& a, const VectorSequence& b, Index count,
                        Triangle triangle, double* S) {
  const Index rows = a.size;
  Index j = 0;
  const auto first_row = [&] { return triangle == Triangle::lower ? j : 0; };
  const auto column = [&] { return S + j * rows; };
  for (; j + 6 <= b.size; j += 6)
    outer_product_strip<6>(a, b.data + j, b.stride, count, first_row(), column());
  switch (b.size - j) {
    case 5:
      return outer_product_strip<5>(a, b.data + j, b.stride, count, first_row(), column());
    case 4:
      return outer_product_strip<4>(a, b.data + j, b.stride, count, first_row(), column());
    case 3:
      return outer_product_strip<3>(a, b.data + j, b.stride, count, first_row(), column());
    case 2:
      return outer_product_strip<2>(a, b.data + j, b.stride, count, first_row(), column());
    case 1:
      return outer_product_strip<1>(a, b.data + j, b.stride, count, first_row(), column());
    default:
      return;
  }
}

namespace {

/// Four columns of the Cholesky factor less what the columns before them explain, on rows
/// [i, i + 4 Quads): A(i.., j..j+3) -= sum_{k<j} L(i.., k) L(j..j+3, k)'.
template <std::size_t Quads>
REIDENT_INLINE void cholesky_tile(double* A, Index size, Index i, Index j) {
  Four rest[Quads][4];
  for (std::size_t q = 0; q < Quads; ++q)
    for (std::size_t c = 0; c < 4; ++c)
      rest[q][c] = load(A + (j + Index(c)) * size + i + 4 * Index(q));
  const double* column = A;
  for (Index k = 0; k < j; ++k, column += size)
    for (std::size_t q = 0; q < Quads; ++q) {
      const Four left = load(column + i + 4 * Index(q));
      for (std::size_t c = 0; c < 4; ++c) rest[q][c] -= left * column[j + Index(c)];
    }
  for (std::size_t q = 0; q < Quads; ++q)
    for (std::size_t c = 0; c < 4; ++c)
      store(A + (j + Index(c)) * size + i + 4 * Index(q), rest[q][c]);
}

/// The same for `columns` columns one entry at a time.
REIDENT_INLINE void cholesky_entries(double* A, Index size, Index i, Index j, Index columns) {
  for (Index c = 0; c < columns; ++c) {
    double rest = A[(j + c) * size + i];
    for (Index k = 0; k < j; ++k) rest -= A[k * size + i] * A[k * size + j + c];
    A[(j + c) * size + i] = rest;
  }
}

}  // namespace

REIDENT_CLONES
bool cholesky(double* A, Index size) {
  for (Index j = 0; j < size; j += 4) {
    const Index columns = size - j < 4 ? size - j : 4;
    Index i = j;
    if (columns == 4) {
      for (; i + 8 <= size; i += 8) cholesky_tile<2>(A, size, i, j);
      if (i + 4 <= size) {
        cholesky_tile<1>(A, size, i, j);
        i += 4;
      }
    }
    for (; i < size; ++i) cholesky_entries(A, size, i, j, columns);
    for (Index c = j; c < j + columns; ++c) {
      double* column = A + c * size;
      for (Index k = j; k < c; ++k) {
        const double* before = A + k * size;
        const double weight = before[c];
        for (Index r = c; r < size; ++r) column[r] -= before[r] * weight;
      }
      if (!(column[c] > 0)) return false;
      const double pivot = std::sqrt(column[c]);
      for (Index r = c; r < size; ++r) column[r] /= pivot;
    }
  }
  return true;
}

namespace {

// Small sizes known to the compiler keep their vectors in registers; 0 stands for any size.
#define REIDENT_SMALL_SIZES(CASE) \
  CASE(1) CASE(2) CASE(3) CASE(4) CASE(5) CASE(6) CASE(7) CASE(8) CASE(9) CASE(10) CASE(11) CASE(12)

template <int Rows>
REIDENT_INLINE void state_space_steps(const double* M, Index n, Index m, Index p, const double* v,
                                      Index count, double* state, double* work, double* y) {
  const Index rows = Rows > 0 ? Rows : n + p;
  double registers[static_cast<std::size_t>(Rows > 0 ? Rows : 1)];
  double* __restrict next = Rows > 0 ? registers : work;
  for (Index k = 0; k < count; ++k, v += m, y += p) {
    for (Index i = 0; i < rows; ++i) next[i] = 0;
    const double* column = M;
    for (Index j = 0; j < n; ++j, column += rows)
      for (Index i = 0; i < rows; ++i) next[i] += column[i] * state[j];
    for (Index j = 0; j < m; ++j, column += rows)
      for (Index i = 0; i < rows; ++i) next[i] += column[i] * v[j];
    for (Index i = 0; i < n; ++i) state[i] = next[i];
    for (Index i = n; i < rows; ++i) y[i - n] = next[i];
  }
}

template <int Order>
REIDENT_INLINE void dual_filter_steps(const double* At, const double* c, Index n, Index inputs,
                                      const double* v, Index count, double* states, double* out,
                                      Index out_stride) {
  const Index order = Order > 0 ? Order : n;
  for (Index k = 0; k < count; ++k, out += out_stride, v += inputs) {
    for (Index j = 0; j < inputs; ++j) {
      double* __restrict x = out + j * order;
      double* __restrict next = states + j * order;
      for (Index i = 0; i < order; ++i) x[i] = next[i];
      for (Index i = 0; i < order; ++i) next[i] = c[i] * v[j];
      const double* column = At;
      for (Index l = 0; l < order; ++l, column += order)
        for (Index i = 0; i < order; ++i) next[i] += column[i] * x[l];
    }
  }
}

}  // namespace

REIDENT_CLONES
void run_state_space(const double* M, Index n, Index m, Index p, const double* v, Index count,
                     double* state, double* work, double* y) {
  switch (n + p) {
#define REIDENT_CASE(size)                                                                   \
  case size:                                                                                 \
    /* one output: all sizes but that of the inputs are known */                             \
    if (p == 1) return state_space_steps<size>(M, size - 1, m, 1, v, count, state, work, y); \
    return state_space_steps<size>(M, n, m, p, v, count, state, work, y);
    REIDENT_SMALL_SIZES(REIDENT_CASE)
#undef REIDENT_CASE
    default:
      state_space_steps<0>(M, n, m, p, v, count, state, work, y);
  }
}

REIDENT_CLONES
void run_dual_filters(const double* At, const double* c, Index n, Index inputs, const double* v,
                      Index count, double* states, double* out, Index out_stride) {
  switch (n) {
#define REIDENT_CASE(size) \
  case size:               \
    return dual_filter_steps<size>(At, c, n, inputs, v, count, states, out, out_stride);
    REIDENT_SMALL_SIZES(REIDENT_CASE)
#undef REIDENT_CASE
    default:
      return dual_filter_steps<0>(At, c, n, inputs, v, count, states, out, out_stride);
  }
}

}  // namespace reident::identification
