// The other channels, as far as they say whether an excursion of one is what the equipment does.
// Private to this folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/screening/excursions.hpp"

namespace reident::identification {

/// The channels as witnesses of excursions of one of them. A lost packet is 0 in all channels: one
/// says nothing that has the same value in the same row, while the two hardly ever agree otherwise.
struct Witnesses {
  std::vector<Channel> channels;         // bridged where they say nothing
  std::size_t self = 0;                  // whose excursions these are
  std::vector<std::vector<Index>> lost;  // by channel, the begins of those it says nothing of

  bool saw(std::size_t channel, const Plateau& excursion) const;
  /// Whether a channel has the same value there.
  bool is_lost(const Plateau& excursion) const;
};

/// Returns the witnesses of excursions of channel `self`, which are by time.
Witnesses witnesses_of(const std::vector<Channel>& channels, std::size_t self,
                       const std::vector<Plateau>& excursions);

/// Gives the rows of a plateau the mean of the rows on both sides.
void bridge(Vector& values, const Plateau& plateau);

/// Returns whether another channel stands out with the excursions together, in the same row or the
/// next, by 6 standard errors of what it does elsewhere. Requires an excursion.
bool another_stands_out(const Witnesses& witnesses, const std::vector<Excursion>& excursions);

}  // namespace reident::identification
