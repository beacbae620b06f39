// What the rules of sensor_screening.hpp share: a channel's samples as plateaus of equal values.
// Private to this folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Rows [begin, end) of one segment in which a channel repeats one value.
struct Plateau {
  Index begin = 0, end = 0;
  double value = 0;
  std::size_t segment = 0;
  Index size() const { return end - begin; }
};

/// A channel with what is usual for it.
struct Channel {
  Vector values;
  bool is_analog = false;
  double low = 0, high = 0;
  std::vector<Plateau> plateaus;  // of analog channels
  /// The least change from one value to the next that is no usual one. Any change of a channel that
  /// is not analog is one.
  double least_jump = 0;

  double range() const { return high - low; }
};

/// Returns the channels, inputs first; `analog` has m + p entries. Requires a row.
std::vector<Channel> channels_of(const Record& record, const std::vector<bool>& analog);

/// Returns the median of the plateaus' rows. Requires a plateau.
double median_size(const std::vector<Plateau>& plateaus);

/// Returns the largest less the smallest value of some rows.
double movement(const Vector& values, Index begin, Index end);

}  // namespace reident::identification
