// What a closed loop means for a model that was identified as if the loop were open (METHOD.md,
// section 20). Private to this folder. Nothing here throws.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/samples/verdict.hpp"
#include "identification/search/identify.hpp"
#include "identification/search/prepared_rows.hpp"

namespace reident::identification {

/// Judges the model where inputs follow outputs in the rows: against one identified for closed
/// loops, on all rows and on each half of them. Returns the verdict `closed_loop` where that one is
/// certainly unstable and predicts more than the model simulates, certainly has the other sign of a
/// gain, or does not certainly have the same sign where an output all but makes the input; else
/// adds a warning.
std::optional<Verdict> closed_loop_verdict(PreparedRows& rows, const Identified& identified,
                                           std::vector<std::string>& warnings);

}  // namespace reident::identification
