// Observability subspaces from the compressed data, for all orders and weightings.
#pragma once

#include "identification/hankel.hpp"
#include "identification/identify.hpp"
#include "identification/state_space.hpp"

namespace reident::identification {

/// The projections of one horizon s, from the triangular factor of the rows [1, U_f, W_p, Y_f] with
/// W_p = [U_p; Y_p]:
///   Y_f = L_u U_f + L_w W_p + (residual orthogonal to both)
class Projection {
 public:
  /// Requires 2 * horizon <= factor.block_rows.
  Projection(const HankelFactor& factor, Index horizon);

  Index horizon() const { return horizon_; }

  /// W1^-1 U S^1/2 of the singular value decomposition of W1 O W2 (ps x ps): its first n columns
  /// are the extended observability matrix of the order n.
  struct Observability {
    Matrix gamma;
    Vector singular_values;
  };
  Observability observability(Weighting weighting) const;

 private:
  Index inputs_, outputs_, horizon_;
  Matrix T_uw_, T_ww_, T_wy_, T_yy_;  // blocks of the triangular factor
};

/// A and C of the order n by the shift invariance of the extended observability matrix.
struct AC {
  Matrix A, C;
};
AC shift_invariant(const Matrix& gamma, Index outputs, Index order);

}  // namespace reident::identification
