// Values by their rank among others. Private to this folder. Nothing here throws.
#pragma once

#include <cstddef>
#include <span>

namespace reident::identification {

/// Returns the value that `rank` others come before in ascending order. Requires more values than
/// that, all of them finite. As a rule the cost is that of one look at each.
double nth_smallest(std::span<const double> values, std::size_t rank);

/// Returns the value that a share of the others is not above. Requires a value.
double quantile(std::span<const double> values, double share);

}  // namespace reident::identification
