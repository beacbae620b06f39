#include "identification/numerics/kernels.hpp"

#include <cmath>
#include <cstddef>
#include <type_traits>

#include "identification/numerics/cpu_clones.hpp"

namespace reident::identification {

namespace {

#ifdef REIDENT_AVX512
bool has_eights() {
  static const bool found = __builtin_cpu_supports("avx512f") != 0;
  return found;
}
#endif

/// Rows from `row` on of Columns columns of S, as many as Registers registers of Lanes have: their
/// sums stay there for all k. Of these rows only the last `kept` ones are added.
template <class Lanes, std::size_t Registers, std::size_t Columns>
REIDENT_INLINE void outer_product_tile(const VectorSequence& a, const double* b, Index b_stride,
                                       Index count, Index row, Index kept, double* S) {
  constexpr Index lanes = sizeof(Lanes) / sizeof(double), height = Index(Registers) * lanes;
  Lanes sums[Registers][Columns] = {};
  const double* from = a.data + row;
  for (Index k = 0; k < count; ++k, from += a.stride, b += b_stride)
    for (std::size_t q = 0; q < Registers; ++q) {
      const auto left = load<Lanes>(from + lanes * Index(q));
      for (std::size_t j = 0; j < Columns; ++j) sums[q][j] += left * b[j];
    }
  for (std::size_t j = 0; j < Columns; ++j) {
    double* to = S + Index(j) * a.size + row;
    if (kept == height) {
      for (std::size_t q = 0; q < Registers; ++q, to += lanes)
        store(to, load<Lanes>(to) + sums[q][j]);
      continue;
    }
    double own[Registers * sizeof(Lanes) / sizeof(double)];
    for (std::size_t q = 0; q < Registers; ++q) store(own + lanes * Index(q), sums[q][j]);
    for (Index i = height - kept; i < height; ++i) to[i] += own[i];
  }
}

/// Rows from `row` on of Columns columns of S. Where they do not fill a register, the last tile
/// begins at rows that are done.
template <class Lanes, std::size_t Registers, std::size_t Columns>
REIDENT_INLINE void outer_product_strip(const VectorSequence& a, const double* b, Index b_stride,
                                        Index count, Index row, double* S) {
  constexpr Index lanes = sizeof(Lanes) / sizeof(double), height = Index(Registers) * lanes;
  for (; row + height <= a.size; row += height)
    outer_product_tile<Lanes, Registers, Columns>(a, b, b_stride, count, row, height, S);
  const Index left = a.size - row;
  if constexpr (Registers > 1) {
    outer_product_strip<Lanes, Registers - 1, Columns>(a, b, b_stride, count, row, S);
  } else if constexpr (lanes > 1) {
    if (a.size >= lanes && left > lanes / 4)
      outer_product_tile<Lanes, 1, Columns>(a, b, b_stride, count, a.size - lanes, left, S);
    else
      outer_product_strip<std::conditional_t<lanes == 8, Four, double>, 1, Columns>(a, b, b_stride,
                                                                                    count, row, S);
  }
}

/// What add_outer_products() does to the columns of S from j on, Columns at a time and then fewer,
/// with sums in so many registers of Lanes for each.
template <class Lanes, std::size_t Registers, std::size_t Columns = 6>
REIDENT_INLINE void outer_products(const VectorSequence& a, const VectorSequence& b, Index count,
                                   Triangle triangle, double* S, Index j = 0) {
  for (; j + Index(Columns) <= b.size; j += Index(Columns))
    outer_product_strip<Lanes, Registers, Columns>(
        a, b.data + j, b.stride, count, triangle == Triangle::lower ? j : 0, S + j * a.size);
  if constexpr (Columns > 1)
    outer_products<Lanes, Registers, Columns - 1>(a, b, count, triangle, S, j);
}

REIDENT_CLONES
void outer_products_by_fours(const VectorSequence& a, const VectorSequence& b, Index count,
                             Triangle triangle, double* S) {
  outer_products<Four, 2>(a, b, count, triangle, S);
}

#ifdef REIDENT_AVX512
REIDENT_AVX512
void outer_products_by_eights(const VectorSequence& a, const VectorSequence& b, Index count,
                              Triangle triangle, double* S) {
  outer_products<Eight, 3>(a, b, count, triangle, S);
}
#endif

}  // namespace

void add_outer_products(const VectorSequence& a, const VectorSequence& b, Index count,
                        Triangle triangle, double* S) {
#ifdef REIDENT_AVX512
  if (has_eights()) return outer_products_by_eights(a, b, count, triangle, S);
#endif
  outer_products_by_fours(a, b, count, triangle, S);
}

namespace {

/// Four columns of the Cholesky factor less what the columns before them explain, on as many rows
/// from i on as Registers registers of Lanes have: A(i.., j..j+3) -= sum_{k<j} L(i.., k)
/// L(j..j+3, k)'.
template <class Lanes, std::size_t Registers>
REIDENT_INLINE void cholesky_tile(double* A, Index size, Index i, Index j) {
  constexpr Index lanes = sizeof(Lanes) / sizeof(double);
  Lanes rest[Registers][4];
  for (std::size_t q = 0; q < Registers; ++q)
    for (std::size_t c = 0; c < 4; ++c)
      rest[q][c] = load<Lanes>(A + (j + Index(c)) * size + i + lanes * Index(q));
  const double* column = A;
  for (Index k = 0; k < j; ++k, column += size)
    for (std::size_t q = 0; q < Registers; ++q) {
      const auto left = load<Lanes>(column + i + lanes * Index(q));
      for (std::size_t c = 0; c < 4; ++c) rest[q][c] -= left * column[j + Index(c)];
    }
  for (std::size_t q = 0; q < Registers; ++q)
    for (std::size_t c = 0; c < 4; ++c)
      store(A + (j + Index(c)) * size + i + lanes * Index(q), rest[q][c]);
}

/// Does what cholesky_tile() does for `columns` columns, one entry at a time.
REIDENT_INLINE void cholesky_entries(double* A, Index size, Index i, Index j, Index columns) {
  for (Index c = 0; c < columns; ++c) {
    double rest = A[(j + c) * size + i];
    for (Index k = 0; k < j; ++k) rest -= A[k * size + i] * A[k * size + j + c];
    A[(j + c) * size + i] = rest;
  }
}

/// What cholesky() does.
template <class Lanes>
REIDENT_INLINE bool cholesky_by(double* A, Index size) {
  constexpr Index lanes = sizeof(Lanes) / sizeof(double);
  for (Index j = 0; j < size; j += 4) {
    const Index columns = size - j < 4 ? size - j : 4;
    Index i = j;
    if (columns == 4) {
      for (; i + 2 * lanes <= size; i += 2 * lanes) cholesky_tile<Lanes, 2>(A, size, i, j);
      for (; i + lanes <= size; i += lanes) cholesky_tile<Lanes, 1>(A, size, i, j);
      for (; i + 4 <= size; i += 4) cholesky_tile<Four, 1>(A, size, i, j);
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

REIDENT_CLONES
bool cholesky_by_fours(double* A, Index size) {
  return cholesky_by<Four>(A, size);
}

#ifdef REIDENT_AVX512
REIDENT_AVX512
bool cholesky_by_eights(double* A, Index size) {
  return cholesky_by<Eight>(A, size);
}
#endif

}  // namespace

bool cholesky(double* A, Index size) {
#ifdef REIDENT_AVX512
  if (has_eights()) return cholesky_by_eights(A, size);
#endif
  return cholesky_by_fours(A, size);
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
