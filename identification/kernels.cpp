#include "identification/kernels.hpp"

#include <cstddef>

// Clones need the loader's indirect functions, which sanitizers and clang 14 do not go with.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define REIDENT_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define REIDENT_CLONES
#endif

namespace reident::identification {

REIDENT_CLONES
void add_outer_products(const VectorSequence& a, const VectorSequence& b, Index count,
                        Triangle triangle, double* S) {
  const Index rows = a.size, cols = b.size;
  Index k = 0;
  for (; k + 4 <= count; k += 4) {  // four at a time: S is loaded and stored once for them
    const double* a0 = a.data + k * a.stride;
    const double* a1 = a0 + a.stride;
    const double* a2 = a1 + a.stride;
    const double* a3 = a2 + a.stride;
    const double* b0 = b.data + k * b.stride;
    const double* b1 = b0 + b.stride;
    const double* b2 = b1 + b.stride;
    const double* b3 = b2 + b.stride;
    for (Index j = 0; j < cols; ++j) {
      const double w0 = b0[j], w1 = b1[j], w2 = b2[j], w3 = b3[j];
      double* __restrict column = S + j * rows;
      for (Index i = triangle == Triangle::lower ? j : 0; i < rows; ++i)
        column[i] += (a0[i] * w0 + a1[i] * w1) + (a2[i] * w2 + a3[i] * w3);
    }
  }
  for (; k < count; ++k) {
    const double* a0 = a.data + k * a.stride;
    const double* b0 = b.data + k * b.stride;
    for (Index j = 0; j < cols; ++j) {
      double* __restrict column = S + j * rows;
      for (Index i = triangle == Triangle::lower ? j : 0; i < rows; ++i) column[i] += a0[i] * b0[j];
    }
  }
}

namespace {

// Small sizes known to the compiler keep their vectors in registers; 0 stands for any size.
// Inlined, so that each clone has its own.
#define REIDENT_INLINE inline __attribute__((always_inline))
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
#define REIDENT_CASE(size) \
  case size:               \
    return state_space_steps<size>(M, n, m, p, v, count, state, work, y);
    REIDENT_SMALL_SIZES(REIDENT_CASE)
#undef REIDENT_CASE
    default:
      return state_space_steps<0>(M, n, m, p, v, count, state, work, y);
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
