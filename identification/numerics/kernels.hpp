// The loops that most of the time goes into, over plain pointers (METHOD.md, "Speed"). A range that
// is written overlaps no other one. Private to the library. Nothing here throws.
#pragma once

#include "identification/numerics/matrix.hpp"

namespace reident::identification {

/// `count` vectors of `size` doubles; the next one starts `stride` doubles after the one before, so
/// that they may overlap.
struct VectorSequence {
  const double* data;
  Index size;
  Index stride;
};

enum class Triangle { full, lower };

/// S += sum over k < count of a_k b_k', with S of a.size x b.size by columns; with Triangle::lower
/// the entries above the diagonal are left without meaning.
void add_outer_products(const VectorSequence& a, const VectorSequence& b, Index count,
                        Triangle triangle, double* S);

/// The Cholesky factor L of A = L L', in place of the lower triangle of A (size x size by columns);
/// the upper one is left without meaning. False where A is not positive definite.
bool cholesky(double* A, Index size);

/// Runs x[k+1] = M_x [x[k]; v[k]] and writes y[k] = M_y [x[k]; v[k]] for count steps, with
/// M = [M_x; M_y] of (n + p) x (n + m) by columns. `state` (n) is carried on, `work` holds
/// n + p; y by columns of p.
void run_state_space(const double* M, Index n, Index m, Index p, const double* v, Index count,
                     double* state, double* work, double* y);

/// Runs X[k+1] = A' X[k] + c v[k]' for count steps, X of n x inputs, and writes X[k] to
/// out + k * out_stride; v by columns of `inputs`. `states` holds X and is carried on.
void run_dual_filters(const double* At, const double* c, Index n, Index inputs, const double* v,
                      Index count, double* states, double* out, Index out_stride);

}  // namespace reident::identification
