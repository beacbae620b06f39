#include "identification/screening/sample_hold.hpp"

#include <algorithm>
#include <vector>

namespace reident::identification {
namespace {

constexpr Index longest = 60;
constexpr Index least_changes = 10;
constexpr double same_phase = 0.95;  // of the changes
constexpr double changing = 0.5;     // of the samples: an equipment that rests repeats values too

}  // namespace

Index rows_per_sample(const Record& record) {
  std::vector<std::int64_t> changes;  // ticks
  for (const Segment& segment : record.segments)
    for (Index row = segment.begin + 1; row < segment.end; ++row)
      if (record.u.row(row) != record.u.row(row - 1) || record.y.row(row) != record.y.row(row - 1))
        changes.push_back(segment.first_tick + (row - segment.begin));
  const auto count = static_cast<Index>(changes.size());
  if (count < least_changes) return 1;
  for (Index rows = std::min(longest, record.rows() / least_changes); rows > 1; --rows) {
    if (double(count) < changing * double(record.rows()) / double(rows)) continue;
    std::vector<Index> of_phase(static_cast<std::size_t>(rows), 0);
    for (const std::int64_t tick : changes)
      ++of_phase[static_cast<std::size_t>(((tick % rows) + rows) % rows)];
    if (double(*std::max_element(of_phase.begin(), of_phase.end())) >= same_phase * double(count))
      return rows;
  }
  return 1;
}

}  // namespace reident::identification
