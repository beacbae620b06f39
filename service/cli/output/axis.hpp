// From values to pixels, and where the marks of an axis stand.
#pragma once

#include <string>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::cli {

/// Values low to high, low < high, on the pixels from `from` to `to`.
struct Scale {
  double low = 0;
  double high = 1;
  double from = 0;
  double to = 1;
  double operator()(double value) const {
    return from + (value - low) / (high - low) * (to - from);
  }
};

struct Tick {
  double value = 0;
  std::string label;
};

/// Around low and high with a little room; around a single value one that is wider.
Scale scale_around(double low, double high, double from, double to);

/// Multiples of 1, 2 or 5 times a power of ten, at most `most` of them.
std::vector<Tick> ticks_of(const Scale& scale, int most);

/// Round times of UTC in `range`, at most `most` of them; values are seconds after range.begin. The
/// first one of each day says the day too.
std::vector<Tick> time_ticks(storage::TimeRange range, int most);

}  // namespace reident::cli
