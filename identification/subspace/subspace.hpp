// Observability subspaces and input responses from the compressed data, for all orders and
// weightings.
#pragma once

#include <string_view>

#include "identification/simulation/state_space.hpp"
#include "identification/subspace/hankel.hpp"

namespace reident::identification {

/// W1 and W2 of the weighted oblique projection (METHOD.md, "Subspace").
enum class Weighting { n4sid, moesp, cva };
std::string_view name(Weighting weighting);

/// The projections of one horizon s:
///   Y_f = L_u U_f + L_w W_p + (residual orthogonal to both)
class Projection {
 public:
  explicit Projection(const HankelFactor& factor);

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

  /// B and D of the model with these A and C: least squares on
  ///   (I - G G^+) Y_f = (I - G G^+) H(B, D) U_f,  G = [C; C A; ...],
  /// over the part of Y_f that lies in the rows of U_f, which leaves the noise and the past out
  /// (M. Verhaegen, Automatica 30(1), 1994). Without `direct` D is zero. Of least norm where U_f
  /// does not determine them. The offsets of the model are zero.
  StateSpaceModel with_response(const Matrix& A, const Matrix& C, bool direct,
                                double period_s) const;

  /// Covariance [Q S; S' R] of the process and measurement noises that the model leaves, the
  /// model's x, u and y being those of the record.
  Matrix noise_covariance(const StateSpaceModel& model) const;

 private:
  Index inputs_, outputs_, horizon_, columns_;
  // Blocks of the triangular factor; the row of the constant is left out, which centres the rest.
  Matrix L_uu_, L_wu_, L_ww_, L_yu_, L_yw_, L_yy_;
};

/// A and C of the order n by the shift invariance of the extended observability matrix.
struct Dynamics {
  Matrix A, C;
};
enum class Stability {
  as_found,
  enforced,  // a zero block row below makes A stable (J. Maciejowski, Systems & Control Letters
             // 26(2), 1995), at the price of a bias where the last block row is not small
};
Dynamics shift_invariant(const Matrix& gamma, Index outputs, Index order,
                         Stability stability = Stability::as_found);

}  // namespace reident::identification
