#include "service/telemetry_file/head_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/telemetry_file/clock_names.hpp"
#include "service/telemetry_file/clock_words.hpp"
#include "service/telemetry_file/date_text.hpp"
#include "service/telemetry_file/number_text.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

using Problem = Clock::Problem;

constexpr double most_repeated = 0.2;  // of the rows, with the time of the row before

constexpr std::size_t enough_cells = 5;  // that show how all of a column are written

/// How a number is written: digits before the mark, behind it, and of an exponent.
struct Digits {
  std::size_t whole = 0, decimals = 0, exponent = 0;
  bool operator==(const Digits&) const = default;
};

Digits digits_of(std::string_view cell, char decimal) {
  Digits digits;
  std::size_t* count = &digits.whole;
  for (const char c : cell)
    if (c >= '0' && c <= '9')
      ++*count;
    else if (c == decimal)
      count = &digits.decimals;
    else if (c == 'e' || c == 'E')
      count = &digits.exponent;
  return digits;
}

}  // namespace

bool is_shorter_than_all(std::string_view cell, std::span<const std::string_view> column,
                         char decimal) {
  // The head of a small file holds the last row too.
  if (!column.empty() && column.back() == cell) column = column.first(column.size() - 1);
  if (column.size() < enough_cells) return false;
  const auto number = read_number(cell, {decimal, '\0'});
  if (!number)  // a time, or words
    return std::ranges::all_of(column, [&](std::string_view other) {
      return other.size() == column.front().size() && other.size() > cell.size();
    });
  const Digits own = digits_of(cell, decimal), usual = digits_of(column.front(), decimal);
  if (usual.decimals > 0 || usual.exponent > 0)
    return (own.decimals < usual.decimals || own.exponent < usual.exponent) &&
           std::ranges::all_of(column, [&](std::string_view other) {
             const Digits digits = digits_of(other, decimal);
             return digits.decimals == usual.decimals && digits.exponent == usual.exponent;
           });
  constexpr double much_less = 5;  // a digit that is missing makes it ten times less
  return own.whole < usual.whole && std::ranges::all_of(column, [&](std::string_view other) {
           const auto value = plain_number(other);
           return value && digits_of(other, decimal) == usual &&
                  std::abs(*value) > much_less * std::abs(number->value);
         });
}

std::vector<std::string> other_times(const std::vector<std::string>& names,
                                     std::span<const std::vector<std::string_view>> columns,
                                     std::span<const CellFormat> formats, const Clock& clock) {
  std::vector<std::string> others;
  const auto& own = columns[clock.columns().front()];
  for (std::size_t c = 0; c < formats.size(); ++c) {
    if (clock.uses(c) || formats[c].kind != CellFormat::Kind::text || columns[c].empty()) continue;
    const auto date = read_date_text(columns[c].front(), DateOrder::day_first);
    if (date && date->has_date && columns[c] != own) others.push_back(names[c]);
  }
  return others;
}

bool are_doubtful_names(const std::vector<std::string>& names, std::string_view encoding) {
  if (encoding != "ISO-8859-1" && encoding != "WINDOWS-1252") return false;
  std::size_t latin = 0, other = 0;
  for (const std::string& name : names)
    for (const char c : name) {
      latin += (c | 0x20) >= 'a' && (c | 0x20) <= 'z' ? 1U : 0U;
      other += (c & 0xC0) == 0xC0 ? 1U : 0U;  // begins a character beyond ASCII
    }
  return other > latin;
}

std::vector<SpacecraftColumn> spacecraft_columns(const HeadCells& head, const Clock& clock) {
  std::vector<SpacecraftColumn> columns;
  for (std::size_t c = 0; c < head.columns.size(); ++c) {
    const auto& cells = head.columns[c];
    const bool holds_numbers = std::any_of(cells.begin(), cells.end(), [](std::string_view cell) {
      return plain_number(trimmed(cell)).has_value();
    });
    if (clock.uses(c) || !is_named_like_a_spacecraft(head.names[c], holds_numbers)) continue;
    SpacecraftColumn column{c, head.names[c], {}, 0};
    const auto first = std::find_if(cells.begin(), cells.end(),
                                    [](std::string_view cell) { return !trimmed(cell).empty(); });
    if (first != cells.end()) {
      column.spacecraft = trimmed(*first);
      column.line = head.lines[static_cast<std::size_t>(first - cells.begin())];
    }
    columns.push_back(std::move(column));
  }
  return columns;
}

std::optional<std::string> names_another(const SpacecraftColumn& column,
                                         std::span<const std::string_view> cells) {
  const std::string_view cell = trimmed(cells[column.position]);
  if (cell.empty() || cell == column.spacecraft || column.spacecraft.empty()) return std::nullopt;
  return fmt::format(
      "column '{}' names several spacecraft, {} and {}; divide the file into one for each, or "
      "take all rows for one's with --force-times",
      column.name, shown(column.spacecraft), shown(cell));
}

std::optional<Problem> several_spacecraft(const SpacecraftColumn& column, const HeadCells& head) {
  std::vector<std::string_view> cells(column.position + 1);
  for (std::size_t row = 0; row < head.lines.size(); ++row) {
    cells[column.position] = head.columns[column.position][row];
    if (auto another = names_another(column, cells)) return Problem{head.lines[row], *another};
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

std::optional<Problem> unpadded_parts(const HeadCells& head, const Clock& clock) {
  const std::size_t column = clock.columns().back();
  Clock reading = clock;
  std::vector<std::string_view> cells(head.columns.size());
  std::optional<std::int64_t> before, before_padded;
  std::size_t back = 0, first = 0;
  constexpr double latest_ns = 9e18;  // within 64 bits, with a second more
  for (std::size_t row = 0; row < head.lines.size(); ++row) {
    const std::string_view cell = trimmed(head.columns[column][row]);
    const auto colon = cell.rfind(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const std::string_view second = cell.substr(colon);
    const auto mark = std::min(second.find_first_of(".,"), second.size() - 1);
    const std::string_view part =
        second.substr(mark + 1, second.find_first_not_of("0123456789", mark + 1) - mark - 1);
    if (second[mark] == ':') return std::nullopt;  // no part of a second
    constexpr std::size_t digits_of_ms = 3;
    if (part.empty() || part.size() > digits_of_ms) return std::nullopt;
    for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = head.columns[c][row];
    const auto time = reading.read(cells);
    if (!time || std::abs(static_cast<double>(*time)) > latest_ns) return std::nullopt;
    constexpr std::array<std::int64_t, 4> scale = {0, 100, 10, 1};
    const auto number = static_cast<std::int64_t>(plain_number(part).value_or(0));
    const std::int64_t padded = *time + number * (1 - scale[part.size()]) * (second_ns / 1000);
    if (before_padded && padded < *before_padded) return std::nullopt;
    if (before && *time < *before && back++ == 0) first = row;
    before = time;
    before_padded = padded;
  }
  if (back < 2) return std::nullopt;
  return Problem{head.lines[first],
                 fmt::format("{} in column '{}' is before the row above, unless its part of a "
                             "second is milliseconds without their zeros; write three digits, as "
                             ".005, or take the times as they are with --force-times",
                             shown(head.columns[column][first]), head.names[column])};
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
