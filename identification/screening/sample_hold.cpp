#include "identification/screening/sample_hold.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace reident::identification {
namespace {

constexpr Index longest = 60;
constexpr std::size_t least_changes = 10;
constexpr double same_phase = 0.95;  // of the changes of a channel
constexpr double changing = 0.5;     // of the samples: an equipment that rests repeats values too

/// Ticks at which the channels change, one list for each that does.
std::vector<std::vector<std::int64_t>> changes_of(const Record& record) {
  std::vector<std::vector<std::int64_t>> changes;
  for (const Matrix* channels : {&record.u, &record.y})
    for (Index c = 0; c < channels->cols(); ++c) {
      std::vector<std::int64_t> ticks;
      for (const Segment& segment : record.segments)
        for (Index row = segment.begin + 1; row < segment.end; ++row)
          if ((*channels)(row, c) != (*channels)(row - 1, c)) ticks.push_back(segment.tick_of(row));
      if (!ticks.empty()) changes.push_back(std::move(ticks));
    }
  return changes;
}

/// Whether nearly all of the ticks are the same number of ticks behind multiples of `rows`.
bool have_one_phase(const std::vector<std::int64_t>& ticks, Index rows) {
  std::vector<Index> of_phase(static_cast<std::size_t>(rows), 0);
  for (const std::int64_t tick : ticks)
    ++of_phase[static_cast<std::size_t>(((tick % rows) + rows) % rows)];
  return double(*std::max_element(of_phase.begin(), of_phase.end())) >=
         same_phase * double(ticks.size());
}

}  // namespace

Index rows_per_sample(const Record& record) {
  const auto changes = changes_of(record);
  std::size_t most = 0;
  for (const auto& ticks : changes) most = std::max(most, ticks.size());
  if (most < least_changes) return 1;
  for (Index rows = std::min(longest, record.rows() / Index{least_changes}); rows > 1; --rows)
    if (double(most) >= changing * double(record.rows()) / double(rows) &&
        std::all_of(changes.begin(), changes.end(),
                    [rows](const auto& ticks) { return have_one_phase(ticks, rows); }))
      return rows;
  return 1;
}

}  // namespace reident::identification
