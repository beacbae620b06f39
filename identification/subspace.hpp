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

  /// Deviation of each future input that no earlier one foretells (horizon x m, in the record's
  /// units): the row k column i speaks of input i against the inputs of k rows before.
  Matrix input_innovations() const;

  /// Covariance [Q S; S' R] of the process and measurement noises that the model leaves, the
  /// model's x, u and y being those of the record.
  Matrix noise_covariance(const StateSpaceModel& model) const;

 private:
  Index inputs_, outputs_, horizon_, columns_;
  // Blocks of the triangular factor; the row of the constant is left out, which centres the rest.
  Matrix T_uu_, T_uw_, T_uy_, T_ww_, T_wy_, T_yy_;
};

/// A and C of the order n by the shift invariance of the extended observability matrix.
struct Dynamics {
  Matrix A, C;
};
enum class Stability {
  as_found,
  enforced,  // a zero block row below makes A stable (J. Maciejowski, Systems & Control Letters
             // 26(3), 1995), at the price of a bias where the last block row is not small
};
Dynamics shift_invariant(const Matrix& gamma, Index outputs, Index order,
                         Stability stability = Stability::as_found);

}  // namespace reident::identification
