// Sets of ticks as ascending ranges that are apart from each other.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Ascending, disjoint, none empty and none beginning where another ends.
using TickSet = std::vector<TickRange>;

/// The ticks in any of the ranges, which may overlap and come in any order.
TickSet united(std::vector<TickRange> ranges);

/// The ticks of `set` inside of `ticks`, and those outside.
TickSet inside(const TickSet& set, TickRange ticks);
TickSet outside(const TickSet& set, TickRange ticks);

/// The ticks in one of the two and not in the other.
TickSet differing(const TickSet& one, const TickSet& other);

/// How many ticks there are.
std::int64_t size(const TickSet& set);

/// The record's rows but for those at `holes`, which split segments as missing samples do.
Record without(Record record, const TickSet& holes);

}  // namespace reident::identification
