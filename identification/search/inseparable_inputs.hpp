// Inputs that move together, so that the rows show what they do together and not what each of them
// does (METHOD.md, section 7, "Inputs that move together"). Private to this folder. Nothing here
// throws.
#pragma once

#include <string>
#include <vector>

#include "identification/search/identify.hpp"
#include "identification/search/prepared_rows.hpp"

namespace reident::identification {

/// Returns a sentence for each output and each group of inputs whose gains to it the rows do not
/// tell apart: one or more of them may do all that the group does together, or nothing.
std::vector<std::string> inseparable_inputs(PreparedRows& rows, const Identified& identified);

}  // namespace reident::identification
