// The projections of the future outputs, from the compressed data (METHOD.md, section 5):
//
//   Y_f = L_u U_f + L_w W_p + (residual orthogonal to both)
//
// m inputs, p outputs and the horizon s are those of the factor. Nothing here throws.
#pragma once

#include "identification/subspace/hankel.hpp"
#include "identification/subspace/weighting.hpp"

namespace reident::identification {

/// The projections of one horizon, for every weighting and order.
class Projection {
 public:
  /// Copies the blocks of the factor.
  explicit Projection(const HankelFactor& factor);

  Index inputs() const { return inputs_; }
  Index outputs() const { return outputs_; }
  Index horizon() const { return horizon_; }
  Index columns() const { return columns_; }  // of the Hankel matrix

  /// Blocks of the triangular factor: u stands for U_f (m s rows), w for W_p ((m + p) s) and y for
  /// Y_f (p s). The row of ones is left out, which centres the rest.
  struct Blocks {
    Matrix uu, wu, ww, yu, yw, yy;
  };
  const Blocks& L() const { return L_; }

  /// W1^-1 U S^1/2 of the weighted projection's singular value decomposition
  /// W1 O W2 = U S V' (p s x p s).
  struct Observability {
    Matrix gamma;            // its first n columns are Γ of the order n
    Vector singular_values;  // p s, descending
  };
  /// Returns the observability matrices of all orders at once; one decomposition is made.
  Observability observability(Weighting weighting) const;

  /// Returns the deviation of each future input that no earlier sample predicts (s x m, in the
  /// factor's units): row k column i is input i against the inputs of the k rows before.
  Matrix input_innovations() const;

 private:
  Index inputs_, outputs_, horizon_, columns_;
  Blocks L_;
};

}  // namespace reident::identification
