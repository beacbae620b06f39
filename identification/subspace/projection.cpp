#include "identification/subspace/projection.hpp"

#include <cmath>

#include "identification/numerics/decompositions.hpp"

namespace reident::identification {
namespace {

/// Lower triangular factor of M M' for M of no more rows than columns.
Matrix lower_factor(const Matrix& M) {
  return triangular_factor(M.transpose()).transpose();
}

/// X L = M for a lower triangular L; of least norm where L is singular to rounding.
Matrix divided(const Matrix& M, const Matrix& L) {
  const auto pivots = L.diagonal().cwiseAbs();
  if (pivots.minCoeff() > 1e-13 * pivots.maxCoeff()) return solve_lower_on_right(M, L);
  return solve_least_norm_on_right(M, L);
}

}  // namespace

Projection::Projection(const HankelFactor& factor)
    : inputs_(factor.inputs),
      outputs_(factor.outputs),
      horizon_(factor.horizon),
      columns_(factor.columns) {
  const Index mu = inputs_ * horizon_, ps = outputs_ * horizon_, past = mu + ps;
  const Index u = 1, w = u + mu, y = w + past;
  L_.uu = factor.L.block(u, u, mu, mu);
  L_.wu = factor.L.block(w, u, past, mu);
  L_.ww = factor.L.block(w, w, past, past);
  L_.yu = factor.L.block(y, u, ps, mu);
  L_.yw = factor.L.block(y, w, ps, past);
  L_.yy = factor.L.block(y, y, ps, ps);
}

Projection::Observability Projection::observability(Weighting weighting) const {
  Matrix weighted;  // W1 O W2
  Matrix W1_inverse;
  switch (weighting) {
    case Weighting::moesp:  // O projected off U_f
      weighted = L_.yw;
      break;
    case Weighting::n4sid: {  // O = L_w W_p itself
      const Matrix L_w = divided(L_.yw, L_.ww);
      weighted.resize(L_.yw.rows(), L_.wu.cols() + L_.yw.cols());
      weighted << L_w * L_.wu, L_.yw;
      break;
    }
    case Weighting::cva: {  // W1 = (Y_f projected off U_f)^-1/2
      Matrix off_inputs(L_.yw.rows(), L_.yw.cols() + L_.yy.cols());
      off_inputs << L_.yw, L_.yy;
      W1_inverse = lower_factor(off_inputs);
      weighted = solve_least_norm(W1_inverse, L_.yw);
      break;
    }
  }
  const auto [U, values] = left_singular(lower_factor(weighted), SingularVectors::thin);
  Matrix gamma = U * values.cwiseSqrt().asDiagonal();
  if (weighting == Weighting::cva) gamma = W1_inverse * gamma;
  return {gamma, values};
}

Matrix Projection::input_innovations() const {
  const Vector diagonal = L_.uu.diagonal().cwiseAbs() / std::sqrt(double(columns_));
  return diagonal.reshaped(inputs_, horizon_).transpose();
}

}  // namespace reident::identification
