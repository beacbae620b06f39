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

/// The ends of some values, how many have each, and the value next to it; infinite where none is.
struct Ends {
  double low, next_to_low, high, next_to_high;
  std::ptrdiff_t at_low, at_high;
};

/// Returns the ends of the values between `above` and `below`, at least one.
Ends ends_of(std::span<const double> values, double above, double below);

}  // namespace reident::identification
