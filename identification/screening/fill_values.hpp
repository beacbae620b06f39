// Values that stand for "no sample", such as -999. Private to this folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Returns the values of a channel that are written where there is no sample: the least or the
/// greatest value, exactly repeated in at least two rows, and far outside of all others. Far is
/// more than the others' range away for a number of nines and the ends of integers of 8, 16 and 32
/// bits, ten times the greatest magnitude of others that have another sign, and ten thousand times
/// that of any.
std::vector<double> fill_values(const Vector& values);

}  // namespace reident::identification
