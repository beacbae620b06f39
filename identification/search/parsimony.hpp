// Whether rows need the states that a model has more than a simpler one (METHOD.md, section 7,
// "Parsimony"). Private to the library. Nothing here throws.
#pragma once

#include <vector>

#include "identification/fit/output_error_fit.hpp"
#include "identification/samples/record.hpp"
#include "identification/search/folds.hpp"

namespace reident::identification {

/// Returns the parameters that a fit of order n, with m inputs and p outputs, has in so many
/// segments: those of the model up to a change of basis, and the initial states.
Index parameters_of(Index n, Index m, Index p, bool direct, Index segments);

/// Whether the likelihood ratio refutes, at 99.99 %, that the simpler of two fits to the same rows
/// has all that is in the outputs. Both are fits to errors of these colours: only then is the ratio
/// distributed as chi-squared. `extra` are the parameters, at least 1, that the richer one has
/// more.
bool is_refuted(const Response& simple, const Response& rich,
                const std::vector<ErrorColour>& colours, Index extra, const Record& record,
                RowRange rows);

/// Whether the rows held out speak against the simpler of two models, by their errors on each fold:
/// the median of its errors over the other's is above what chance gives `extra` parameters that
/// mean nothing, with white errors on so many rows fitted and held out; and its squares, or
/// their logarithms, are larger by two standard errors.
bool errs_more(const std::vector<HeldOutError>& simple, const std::vector<HeldOutError>& rich,
               Index extra, Index fitted, Index held_out);

}  // namespace reident::identification
