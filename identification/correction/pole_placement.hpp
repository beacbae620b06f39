// Pole placement: a gain F (m x n) with which A - B F has given eigenvalues, block by block of the
// real Schur form (METHOD.md, section 12). What already is in place costs no gain. The unit of an
// input makes no difference to the poles, nor to the share that the input takes.
//
// A mode that no input reaches stays where it is: a block whose rows of Q' B are below 1e-7 of B.
// Nothing here throws.
#pragma once

#include <complex>
#include <variant>
#include <vector>

#include "identification/numerics/matrix.hpp"
#include "identification/samples/verdict.hpp"

namespace reident::identification {

/// Poles of a model, each complex one followed by its conjugate.
using Poles = std::vector<std::complex<double>>;

/// Returns the eigenvalues of the square, finite A. The two of a pair stand next to each other and
/// are conjugate to the last bit.
Poles poles_of(const Matrix& A);

struct PolePlacement {
  Matrix gain;           // F, m x n
  Poles uncontrollable;  // eigenvalues of A that stayed; as many of the wanted ones were not used
};

/// Places the poles of A (n x n) by inputs that act by B (n x m) at `wanted`. Requires finite A and
/// B, and n finite numbers of which each complex one is followed by its conjugate. Returns the
/// verdict no_gain where the modes that the inputs reach are fewer than the pairs wanted need, and
/// where the eigenvalues of A are not found.
std::variant<PolePlacement, Verdict> place_poles(const Matrix& A, const Matrix& B,
                                                 const Poles& wanted);

}  // namespace reident::identification
