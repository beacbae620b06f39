// Dates and times of day as people write them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace reident::telemetry_file {

/// What 03/04/2024 is: 3 April or March 4; and whether 03/04/24 is 24 April 2003.
enum class DateOrder { day_first, month_first, year_first };

/// A time as a text says it.
struct DateText {
  std::int64_t clock_ns = 0;              // since 1970 by the clock of the text
  std::optional<std::int64_t> offset_ns;  // of that clock, east of UTC; absent: not said
  bool has_date = true;                   // false: a time of day, or one that has passed, alone
  bool is_ordered = false;                // the order of day and month was needed to read it
  bool is_in_leap_second = false;         // the clock shows the second 60
};

/// Reads any of these, with blanks around, a weekday in front, and a Z, UTC, GMT or +02:00 behind:
///   2024-02-28, 2024/2/28, 2024.02.28, 20240228, 2024-Feb-28, 28-Feb-2024, Feb 28 2024
///   240228220030, 202402282200
///   28.02.2024, 28/02/2024, 02/28/2024 (by `order` where both are possible), 28.02.24
///   2024-059, 2024:059, 2024.059, 2024/059, 24-059, 2024059T (day of the year), 2024-W09-3
/// followed by a T, a blank, or what separates the date's parts, and then
///   22:00, 22:00:30, 22:00:30.5, 22:00:30,5, 22.00.30.500, 220030, 10:00:30 PM
/// or Feb 28 22:00:30 UTC 2024, or a time of day alone, or a time that has passed: 26:03:10,
/// 012/22:00:30, 12:22:00:30. A zone may be named as in CET. Months may be in six languages. The
/// second 60 is the next minute's 0. Other spellings are those of date_spelling.hpp. Empty where
/// the text is none.
std::optional<DateText> read_date_text(std::string_view text, DateOrder order);

/// A date and time that lacks the year, as Nov 27 10:00:00, with one; empty for any other text.
std::string with_missing_year(std::string_view cell);

/// Returns how far east of UTC a clock is that CET, UTC, GMT+1 or +02:00 names; empty for others.
std::optional<std::int64_t> read_offset(std::string_view text);

}  // namespace reident::telemetry_file
