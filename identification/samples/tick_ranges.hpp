// Sets of ticks as ascending ranges that are apart from each other. Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Ascending, disjoint, none empty and none beginning where another ends.
using TickSet = std::vector<TickRange>;

/// Returns the ticks in any of the ranges, which may overlap, be empty and come in any order.
TickSet united(std::vector<TickRange> ranges);

/// Return the ticks of `set` inside of `ticks`, and those outside.
TickSet inside(const TickSet& set, TickRange ticks);
TickSet outside(const TickSet& set, TickRange ticks);

/// Returns the ticks in one of the two and not in the other.
TickSet differing(const TickSet& one, const TickSet& other);

/// Returns the number of ticks.
std::int64_t size(const TickSet& set);

/// Returns the record's rows but for those at `holes`, which split segments as missing samples do.
Record without(Record record, const TickSet& holes);

}  // namespace reident::identification
