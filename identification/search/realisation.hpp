// From a recipe to a model (METHOD.md, sections 5, 6, 8 and 9). Private to this
// folder. Nothing here throws.
#pragma once

#include <optional>

#include "identification/search/identify.hpp"
#include "identification/search/prepared_rows.hpp"

namespace reident::identification {

/// Identifies the model of the recipe from all fitted rows. Requires rows that are prepared. The
/// result has no held_out_error, and of the warnings its own. Absent where the recipe gives no
/// stable, finite model there. It may be absent where the model has a mode slower than the limit.
std::optional<Identified> realise(PreparedRows& rows, const Recipe& recipe,
                                  double longest_time_constant_s);

}  // namespace reident::identification
