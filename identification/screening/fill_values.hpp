// Values that stand for "no sample", such as -999. Private to this folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/screening/channels.hpp"

namespace reident::identification {

/// Returns the values of a channel that are written where there is no sample: the least or the
/// greatest value, far outside of all others. Far is more than the others' range away for a number
/// of nines and the ends of integers of 8, 16 and 32 bits, and ten thousand times the greatest
/// magnitude of others for any value; ten times that for one that is exactly repeated, where the
/// others have another sign.
std::vector<double> fill_values(const Vector& values);

/// Returns the rows of one channel that hold a value which stands for none by how it stands there,
/// by time. It is the least or the greatest one, further outside of the others than these are
/// apart, or one that excursions have again and again to the digit. It is scattered over the rows
/// in few and short stretches, which no other channel confirms (METHOD.md, section 17).
std::vector<Plateau> scattered_fills(const std::vector<Channel>& channels, std::size_t self);

}  // namespace reident::identification
