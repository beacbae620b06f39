// What the rules of sensor_screening.hpp share: a channel's samples as plateaus of equal values.
// Private to this folder. Nothing here throws.
#pragma once

#include <span>
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
  /// The least change from one value to the next that is no usual one. Any change of a channel that
  /// is not analog is one.
  double least_jump = 0;
  Index steps = 0;           // from one row of an analog channel to a next one with another value
  double greatest_step = 0;  // from one row to the next of an analog channel
  Index longest_repeat = 0;  // rows of the longest plateau of an analog channel
  const std::vector<Segment>* segments = nullptr;  // those of the record, which outlives this

  double range() const { return high - low; }
  /// As a rule nothing is found that needs them: they are made at each call.
  std::vector<Plateau> plateaus() const;
};

inline std::span<const double> span_of(const Vector& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

/// Returns the channels, inputs first; `analog` has m + p entries. Requires a row.
std::vector<Channel> channels_of(const Record& record, const std::vector<bool>& analog);

/// Returns the median of the plateaus' rows. Requires a plateau.
double median_size(const std::vector<Plateau>& plateaus);

/// Returns the largest less the smallest value of some rows.
double movement(const Vector& values, Index begin, Index end);

}  // namespace reident::identification
