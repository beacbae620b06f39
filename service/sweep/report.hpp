// What came of a sweep.
#pragma once

#include <optional>

#include <nlohmann/json.hpp>

#include "service/sweep/plan.hpp"

namespace reident::sweep {

/// Puts the judgements together: `spacecraft`, a list of their files (comparison.hpp) with the
/// registry's path, and over all equipment
///
///   equipment, better, worse     how many; with an error that is less, or more, than what really
///                                was, by more than a hundredth
///   error_ratio                  geometric mean of what would have been over what was
///   would_regret, was_regret     geometric means over cycles that both know
///
/// Absent until every spacecraft is judged. A mean of nothing is null.
std::optional<nlohmann::ordered_json> report_of(const Plan& plan);

}  // namespace reident::sweep
