#include "identification/numerics/kernels.hpp"

#include <cmath>
#include <cstddef>

#include "identification/numerics/cpu_clones.hpp"

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

/// Does what cholesky_tile() does for `columns` columns, one entry at a time.
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

// Sizes known to the compiler keep sums in registers. Vectors are padded with zeros to whole fours:
// without, the compiler works on some sizes entry by entry.
#define REIDENT_SMALL_SIZES(CASE) \
  CASE(1) CASE(2) CASE(3) CASE(4) CASE(5) CASE(6) CASE(7) CASE(8) CASE(9) CASE(10) CASE(11) CASE(12)

constexpr std::size_t most_columns = 32;  // of [A B] on the stack
constexpr Index inputs_at_once = 16;

/// The loop that says the same becomes a call of memmove, which costs as much as a step of the
/// model.
REIDENT_INLINE void copy_few(const double* from, Index count, double* to) {
  switch (count) {
    case 1:
      to[0] = from[0];
      return;
    case 2:
      __builtin_memcpy(to, from, 2 * sizeof(double));
      return;
    case 3:
      __builtin_memcpy(to, from, 3 * sizeof(double));
      return;
    default:
      __builtin_memcpy(to, from, static_cast<std::size_t>(count) * sizeof(double));
  }
}

/// A step waits for the state of the one before: what the inputs add is summed first, and the
/// columns of the state in two sums.
template <std::size_t Quads>
REIDENT_INLINE void state_space_steps(const double* M, Index n, Index m, Index p, const double* v,
                                      Index count, double* state, double* y) {
  Four columns[most_columns][Quads] = {};
  for (Index j = 0; j < n + m; ++j)
    __builtin_memcpy(columns[j], M + j * (n + p), static_cast<std::size_t>(n + p) * sizeof(double));
  double next[4 * Quads] = {};
  // Without states their pointer may be null, which a copy of no bytes does not take either.
  if (n > 0) __builtin_memcpy(next, state, static_cast<std::size_t>(n) * sizeof(double));
  for (Index k = 0; k < count; ++k, v += m, y += p) {
    Four even[Quads] = {}, odd[Quads] = {};
    for (Index j = 0; j < m; ++j)
      for (std::size_t q = 0; q < Quads; ++q) even[q] += columns[n + j][q] * v[j];
    for (Index j = 0; j < n; j += 2)
      for (std::size_t q = 0; q < Quads; ++q) even[q] += columns[j][q] * next[j];
    for (Index j = 1; j < n; j += 2)
      for (std::size_t q = 0; q < Quads; ++q) odd[q] += columns[j][q] * next[j];
    for (std::size_t q = 0; q < Quads; ++q) store(next + 4 * q, even[q] + odd[q]);
    copy_few(next + n, p, y);
  }
  if (n > 0) __builtin_memcpy(state, next, static_cast<std::size_t>(n) * sizeof(double));
}

/// Does what state_space_steps() does for any size.
REIDENT_INLINE void state_space_steps_of_any_size(const double* M, Index n, Index m, Index p,
                                                  const double* v, Index count, double* state,
                                                  double* work, double* y) {
  const Index rows = n + p;
  for (Index k = 0; k < count; ++k, v += m, y += p) {
    for (Index i = 0; i < rows; ++i) work[i] = 0;
    const double* column = M;
    for (Index j = 0; j < n; ++j, column += rows)
      for (Index i = 0; i < rows; ++i) work[i] += column[i] * state[j];
    for (Index j = 0; j < m; ++j, column += rows)
      for (Index i = 0; i < rows; ++i) work[i] += column[i] * v[j];
    for (Index i = 0; i < n; ++i) state[i] = work[i];
    for (Index i = n; i < rows; ++i) y[i - n] = work[i];
  }
}

/// The filters of at most `inputs_at_once` inputs: while one waits for its sums, the others go on.
template <std::size_t Order>
REIDENT_INLINE void dual_filter_steps(const double* At, const double* c, Index inputs, Index stride,
                                      const double* v, Index count, double* states, double* out,
                                      Index out_stride) {
  constexpr std::size_t quads = (Order + 3) / 4, bytes = Order * sizeof(double);
  constexpr Index order = Index(Order), padded = 4 * Index(quads);
  Four columns[Order][quads] = {}, driven[quads] = {};
  for (std::size_t l = 0; l < Order; ++l)
    __builtin_memcpy(columns[l], At + Index(l) * order, bytes);
  __builtin_memcpy(driven, c, bytes);
  double x[std::size_t{inputs_at_once} * 4 * quads] = {};
  for (Index j = 0; j < inputs; ++j) __builtin_memcpy(x + j * padded, states + j * order, bytes);
  for (Index k = 0; k < count; ++k, out += out_stride, v += stride)
    for (Index j = 0; j < inputs; ++j) {
      double* own = x + j * padded;
      __builtin_memcpy(out + j * order, own, bytes);
      Four next[quads];
      for (std::size_t q = 0; q < quads; ++q) next[q] = driven[q] * v[j];
      for (std::size_t l = 0; l < Order; ++l)
        for (std::size_t q = 0; q < quads; ++q) next[q] += columns[l][q] * own[l];
      for (std::size_t q = 0; q < quads; ++q) store(own + 4 * q, next[q]);
    }
  for (Index j = 0; j < inputs; ++j) __builtin_memcpy(states + j * order, x + j * padded, bytes);
}

/// Does what dual_filter_steps() does for any size.
REIDENT_INLINE void dual_filter_steps_of_any_size(const double* At, const double* c, Index n,
                                                  Index inputs, const double* v, Index count,
                                                  double* states, double* out, Index out_stride) {
  for (Index k = 0; k < count; ++k, out += out_stride, v += inputs)
    for (Index j = 0; j < inputs; ++j) {
      double* __restrict x = out + j * n;
      double* __restrict next = states + j * n;
      for (Index i = 0; i < n; ++i) x[i] = next[i];
      for (Index i = 0; i < n; ++i) next[i] = c[i] * v[j];
      const double* column = At;
      for (Index l = 0; l < n; ++l, column += n)
        for (Index i = 0; i < n; ++i) next[i] += column[i] * x[l];
    }
}

}  // namespace

REIDENT_CLONES
void run_state_space(const double* M, Index n, Index m, Index p, const double* v, Index count,
                     double* state, double* work, double* y) {
  if (n + p > 12 || n + m > Index(most_columns))
    return state_space_steps_of_any_size(M, n, m, p, v, count, state, work, y);
  if (n + p <= 4) return state_space_steps<1>(M, n, m, p, v, count, state, y);
  if (n + p <= 8) return state_space_steps<2>(M, n, m, p, v, count, state, y);
  return state_space_steps<3>(M, n, m, p, v, count, state, y);
}

REIDENT_CLONES
void run_dual_filters(const double* At, const double* c, Index n, Index inputs, const double* v,
                      Index count, double* states, double* out, Index out_stride) {
  if (n == 0) return;
  if (n > 12)
    return dual_filter_steps_of_any_size(At, c, n, inputs, v, count, states, out, out_stride);
  for (Index first = 0; first < inputs; first += inputs_at_once) {
    const Index some = inputs - first < inputs_at_once ? inputs - first : inputs_at_once;
    switch (n) {
#define REIDENT_CASE(size)                                                             \
  case size:                                                                           \
    dual_filter_steps<size>(At, c, some, inputs, v + first, count, states + first * n, \
                            out + first * n, out_stride);                              \
    break;
      REIDENT_SMALL_SIZES(REIDENT_CASE)
#undef REIDENT_CASE
      default:
        break;
    }
  }
}

}  // namespace reident::identification
