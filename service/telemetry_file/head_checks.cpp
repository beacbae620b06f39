#include "service/telemetry_file/head_checks.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/telemetry_file/clock_names.hpp"
#include "service/telemetry_file/clock_words.hpp"
#include "service/telemetry_file/number_text.hpp"

namespace reident::telemetry_file {
namespace {

using Problem = Clock::Problem;

constexpr double most_repeated = 0.2;  // of the rows, with the time of the row before

}  // namespace

std::optional<Problem> several_spacecraft(const HeadCells& head, const Clock& clock) {
  for (std::size_t c = 0; c < head.columns.size(); ++c) {
    const auto& cells = head.columns[c];
    const bool holds_numbers = std::any_of(cells.begin(), cells.end(), [](std::string_view cell) {
      return plain_number(trimmed(cell)).has_value();
    });
    if (clock.uses(c) || !is_named_like_a_spacecraft(head.names[c], holds_numbers)) continue;
    std::string_view first;
    for (std::size_t row = 0; row < head.lines.size(); ++row) {
      const std::string_view cell = trimmed(cells[row]);
      if (cell.empty() || cell == first) continue;
      if (!first.empty())
        return Problem{
            head.lines[row],
            fmt::format(
                "column '{}' names several spacecraft, {} and {}; divide the file into one for "
                "each, or take all rows for one's with --force-times",
                head.names[c], shown(first), shown(cell))};
      first = cell;
    }
  }
  return std::nullopt;
}

std::optional<Problem> clocks_of_their_own(const HeadCells& head) {
  const auto& names = head.names;
  if (names.size() < 4 || names.size() % 2 != 0) return std::nullopt;
  for (std::size_t c = 0; c < names.size(); c += 2)
    if (!is_named_like_a_time(names[c]) || is_named_like_a_time(names[c + 1]) ||
        !are_named_alike(names[c], names[0]))
      return std::nullopt;
  for (std::size_t c = 2; c < names.size(); c += 2)
    if (head.columns[c] != head.columns[0])
      return Problem{
          0,
          fmt::format(
              "each value stands behind a time of its own ('{}' and '{}' differ); divide the file "
              "into one for each pair of columns, or name one for all with --time",
              names[0], names[c])};
  return std::nullopt;
}

std::optional<Problem> repeated_times(const HeadCells& head, const Clock& clock) {
  Clock reading = clock;
  std::vector<std::string_view> cells(head.columns.size());
  std::optional<std::int64_t> before;
  std::size_t repeated = 0, first = 0;
  for (std::size_t row = 0; row < head.lines.size(); ++row) {
    const auto last = cells;
    for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = head.columns[c][row];
    const auto time = reading.read(cells);
    const auto differs = [&](std::size_t c) {
      const std::string_view now = trimmed(cells[c]), then = trimmed(last[c]);
      return !now.empty() && !then.empty() && now != then && !reading.uses(c);
    };
    bool contradicts = false;
    for (std::size_t c = 0; c < cells.size() && time && time == before && !contradicts; ++c)
      contradicts = differs(c);
    if (contradicts && repeated++ == 0) first = row;
    before = time;
  }
  if (static_cast<double>(repeated) <= most_repeated * static_cast<double>(head.lines.size()))
    return std::nullopt;
  const std::size_t column = reading.columns().front();
  return Problem{
      head.lines[first],
      fmt::format(
          "{} in column '{}' is the time of the row before, and other values stand there, as in "
          "{} of the first {} rows. Is the time cut off, or a part of it in another column (--time "
          "DATE,CLOCK)? Is each row one sample (call the columns parameter, time and value with "
          "--names)? --force-times takes the times as they are",
          shown(head.columns[column][first]), head.names[column], repeated, head.lines.size())};
}

}  // namespace reident::telemetry_file
