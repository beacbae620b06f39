// A fit without the modes that the rows miss least (METHOD.md, section 7, "Parsimony"). Private to
// this folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/fit/output_error_fit.hpp"
#include "identification/samples/record.hpp"
#include "identification/search/recipe.hpp"
#include "identification/subspace/shift_invariance.hpp"

namespace reident::identification {

/// Modes that are left of a fit, and the error of a regression with them.
struct FewerModes {
  Dynamics dynamics;
  double error = 0;  // root mean square over rows of the output error's norm
};

/// Takes one mode after the other out of a stable fit's, real ones and pairs: each time the one
/// without which B, D, y0 and the initial states fit `rows` best. Descending orders, each below
/// that of the fit, and at least `least_order`.
std::vector<FewerModes> fewer_modes(Dynamics dynamics, bool direct, const Record& record,
                                    RowRange rows, Index least_order);

/// Refines the dynamics of a subspace as the recipe says, and what is left of them where modes are
/// eliminated: of its order, or of one more where that would take half of a pair.
Response refined(const Dynamics& dynamics, const Recipe& recipe, const Record& record,
                 RowRange rows);

}  // namespace reident::identification
