#include "identification/kernels.hpp"

#include <algorithm>

// Clones need the loader's indirect functions, which sanitizers and clang 14 do not go with.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define REIDENT_CLONES __attribute__((target_clones("arch=haswell", "default")))
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
    for (Index j = 0; j < cols; ++j) {
      const double w0 = b0[j], w1 = b0[j + b.stride];
      const double w2 = b0[j + 2 * b.stride], w3 = b0[j + 3 * b.stride];
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

REIDENT_CLONES
void run_state_space(const double* M, Index n, Index m, Index p, const double* v, Index count,
                     double* state, double* __restrict work, double* y) {
  const Index rows = n + p;
  for (Index k = 0; k < count; ++k, v += m, y += p) {
    std::fill(work, work + rows, 0.0);
    const double* column = M;
    for (Index j = 0; j < n; ++j, column += rows)
      for (Index i = 0; i < rows; ++i) work[i] += column[i] * state[j];
    for (Index j = 0; j < m; ++j, column += rows)
      for (Index i = 0; i < rows; ++i) work[i] += column[i] * v[j];
    std::copy(work, work + n, state);
    std::copy(work + n, work + rows, y);
  }
}

REIDENT_CLONES
void run_dual_filters(const double* At, const double* c, Index n, Index inputs, const double* v,
                      Index count, double* states, double* out, Index out_stride) {
  for (Index k = 0; k < count; ++k, out += out_stride, v += inputs) {
    std::copy(states, states + n * inputs, out);
    for (Index j = 0; j < inputs; ++j) {
      const double* x = out + j * n;
      double* __restrict next = states + j * n;
      for (Index i = 0; i < n; ++i) next[i] = c[i] * v[j];
      const double* column = At;
      for (Index l = 0; l < n; ++l, column += n)
        for (Index i = 0; i < n; ++i) next[i] += column[i] * x[l];
    }
  }
}

}  // namespace reident::identification
