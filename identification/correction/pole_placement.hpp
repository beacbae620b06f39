// Pole placement: a gain F (m x n) with which A - B F has given eigenvalues.
//
// The method is that of A. Varga, "A Schur method for pole assignment", IEEE Transactions on
// Automatic Control 26(2), 1981. A = Q T Q' is brought to real Schur form. The block of one or two
// eigenvalues at the lower end of T can be moved by a feedback of its own states alone, which
// leaves all other eigenvalues where they are; of all that move it as wanted the one of least norm
// is taken. Orthogonal swaps (Z. Bai, J. W. Demmel, "On swapping diagonal blocks in real Schur
// form", Linear Algebra and its Applications 186, 1993) then bring the moved block to the upper end
// and the next one to the lower. Only orthogonal transformations act on A, and each block takes the
// wanted eigenvalues nearest to its own, so that what already is in place costs no gain.
//
// The norm is that of inputs measured by the columns of B: the unit of an input makes no difference
// to the poles or to the share that the input takes.
//
// A mode that no input reaches stays where it is. It is seen as a block whose rows of Q' B are
// below 1e-7 of B: two equal poles are known to the root of the rounding, and a mode that weaker
// inputs reach takes a gain that rounding in A would undo.
#pragma once

#include <complex>
#include <variant>
#include <vector>

#include "identification/numerics/matrix.hpp"
#include "identification/samples/verdict.hpp"

namespace reident::identification {

using Poles = std::vector<std::complex<double>>;

/// Eigenvalues of A; each pair's two stand side by side and are conjugate to the last bit.
Poles poles_of(const Matrix& A);

struct PolePlacement {
  Matrix gain;           // F, m x n
  Poles uncontrollable;  // eigenvalues of A that stayed; as many of the wanted ones were not used
};

/// A is n x n, B is n x m, both finite; `wanted` are n finite numbers in which each complex one is
/// followed by its conjugate. The verdict no_gain is given where the modes that the inputs
/// reach are fewer than the pairs wanted need, and where the eigenvalues of A are not found.
std::variant<PolePlacement, Verdict> place_poles(const Matrix& A, const Matrix& B,
                                                 const Poles& wanted);

}  // namespace reident::identification
