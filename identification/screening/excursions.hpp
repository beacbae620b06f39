// Plateaus that stand out from the rows around them, as spikes, pulses and lost samples do.
// Private to this folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/screening/channels.hpp"

namespace reident::identification {

/// The values on both sides of an excursion differ by less than this share of its height.
inline constexpr double neighbours_agree = 0.3;

/// A plateau that stands out from the rows around it.
struct Excursion {
  Plateau plateau;
  double height = 0;  // above the rows around it, or below them where negative
};

/// Returns the plateaus of an analog channel that stand out from both neighbours by unusual jumps,
/// while these neighbours agree; by time.
std::vector<Excursion> excursions_of(const Channel& channel);

}  // namespace reident::identification
