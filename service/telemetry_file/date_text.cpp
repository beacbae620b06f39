#include "service/telemetry_file/date_text.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>

#include "service/support/text.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

constexpr std::array<std::string_view, 12> months = {"jan", "feb", "mar", "apr", "may", "jun",
                                                     "jul", "aug", "sep", "oct", "nov", "dec"};
constexpr std::array<std::string_view, 7> weekdays = {"mon", "tue", "wed", "thu",
                                                      "fri", "sat", "sun"};

bool digit(char c) {
  return c >= '0' && c <= '9';
}
bool letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// Takes parts off the front of a text.
class Parts {
 public:
  explicit Parts(std::string_view text) : text_(text) {}

  bool empty() const { return text_.empty(); }
  char front() const { return text_.empty() ? '\0' : text_.front(); }
  /// How many digits come next.
  std::size_t digits() const {
    std::size_t count = 0;
    while (count < text_.size() && digit(text_[count])) ++count;
    return count;
  }
  /// Requires so many digits.
  int number(std::size_t count) {
    int value = 0;
    for (std::size_t i = 0; i < count; ++i) value = value * 10 + (text_[i] - '0');
    text_.remove_prefix(count);
    return value;
  }
  /// Takes `least` to `most` digits, no more of them behind.
  std::optional<int> whole(std::size_t least, std::size_t most) {
    const std::size_t count = digits();
    if (count < least || count > most) return std::nullopt;
    return number(count);
  }
  bool take(char c) {
    if (front() != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  char take_any(std::string_view of) {
    if (text_.empty() || of.find(text_.front()) == std::string_view::npos) return '\0';
    const char taken = text_.front();
    text_.remove_prefix(1);
    return taken;
  }
  bool take_blanks() {
    const bool any = front() == ' ';
    while (take(' ')) {
    }
    return any;
  }
  /// Takes letters, as lower case.
  std::string word() {
    std::string taken;
    while (letter(front())) {
      taken += static_cast<char>(text_.front() | 0x20);
      text_.remove_prefix(1);
    }
    return taken;
  }
  /// Digits as a part of a second [ns], those below a nanosecond cut off.
  std::int64_t fraction() {
    std::int64_t value = 0, unit = second_ns;
    for (; digit(front()); text_.remove_prefix(1)) {
      unit /= 10;
      value += (text_.front() - '0') * unit;
    }
    return value;
  }
  Parts saved() const { return *this; }

 private:
  std::string_view text_;
};

std::optional<int> month_of(std::string_view word) {
  if (word.size() < 3) return std::nullopt;
  for (std::size_t m = 0; m < months.size(); ++m)
    if (word.substr(0, 3) == months[m]) return static_cast<int>(m) + 1;
  return std::nullopt;
}

std::optional<std::int64_t> days_of(int year, int month, int day) {
  const std::chrono::year_month_day date{std::chrono::year{year},
                                         std::chrono::month{static_cast<unsigned>(month)},
                                         std::chrono::day{static_cast<unsigned>(day)}};
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days{date}.time_since_epoch().count();
}

std::optional<std::int64_t> days_of_ordinal(int year, int day) {
  const bool leap = std::chrono::year{year}.is_leap();
  if (day < 1 || day > (leap ? 366 : 365)) return std::nullopt;
  return *days_of(year, 1, 1) + day - 1;
}

std::optional<std::int64_t> days_of_week(int year, int week, int day) {
  if (week < 1 || week > 53 || day < 1 || day > 7) return std::nullopt;
  const std::int64_t fourth = *days_of(year, 1, 4);  // always in week 1
  const std::int64_t weekday = ((fourth + 3) % 7 + 7) % 7;
  return fourth - weekday + (week - 1) * 7 + day - 1;
}

/// A date that begins with the four digits of the year.
std::optional<std::int64_t> take_year_first(Parts& text, char& separator) {
  const int year = text.number(4);
  if (text.digits() == 3 || text.digits() == 4) {  // 2024059T, 20240228
    const bool ordinal = text.digits() == 3;
    const int rest = text.number(ordinal ? 3 : 4);
    return ordinal ? days_of_ordinal(year, rest) : days_of(year, rest / 100, rest % 100);
  }
  if (text.digits() == 10) {  // 20240228220000
    const int rest = text.number(4);
    return days_of(year, rest / 100, rest % 100);
  }
  separator = text.take_any("-/.: ");
  if (text.front() == 'W' || text.front() == 'w') {
    text.word();
    const auto week = text.whole(2, 3);
    if (!week) return std::nullopt;
    if (*week > 99) return days_of_week(year, *week / 10, *week % 10);
    if (!text.take('-')) return days_of_week(year, *week, 1);
    const auto day = text.whole(1, 1);
    return day ? days_of_week(year, *week, *day) : std::nullopt;
  }
  if (separator == '\0') return std::nullopt;
  if (text.digits() == 3) return days_of_ordinal(year, text.number(3));
  std::optional<int> month = letter(text.front()) ? month_of(text.word()) : text.whole(1, 2);
  if (!month || !text.take(separator)) return std::nullopt;
  const auto day = text.whole(1, 2);
  return day ? days_of(year, *month, *day) : std::nullopt;
}

/// A date that begins with a day or a month; 28.02.24 is of this century.
std::optional<std::int64_t> take_year_last(Parts& text, DateOrder order, char& separator,
                                           bool& is_ordered) {
  std::optional<int> first, second;
  std::optional<int> month;
  if (letter(text.front())) {
    month = month_of(text.word());
    separator = text.take_any("-/. ");
    first = text.whole(1, 2);
  } else {
    first = text.whole(1, 2);
    separator = text.take_any("-/. ");
    if (letter(text.front()))
      month = month_of(text.word());
    else
      second = text.whole(1, 2);
  }
  if (!first || separator == '\0' || (!month && !second)) return std::nullopt;
  text.take(',');
  if (!text.take_any("-/. ")) return std::nullopt;
  const std::size_t digits = text.digits();
  if (digits != 4 && digits != 2) return std::nullopt;
  const int year = digits == 4 ? text.number(4) : 2000 + text.number(2);
  if (month) return days_of(year, *month, *first);
  is_ordered = separator != '.' && *first <= 12 && *second <= 12 && *first != *second;
  const bool day_first =
      separator == '.' || *first > 12 || (*second <= 12 && order == DateOrder::day_first);
  return day_first ? days_of(year, *second, *first) : days_of(year, *first, *second);
}

/// A time of day [ns].
std::optional<std::int64_t> take_clock(Parts& text) {
  const std::size_t digits = text.digits();
  std::int64_t hour = 0, minute = 0, second = 0;
  if (digits == 6 || digits == 4) {  // 220030
    hour = text.number(2);
    minute = text.number(2);
    if (digits == 6) second = text.number(2);
    if (digits == 4)
      return hour < 24 && minute < 60 ? std::optional(hour * hour_ns + minute * minute_ns)
                                      : std::nullopt;
  } else {
    const auto hours = text.whole(1, 2);
    const char separator = text.take_any(":.");
    const auto minutes = text.whole(2, 2);
    if (!hours || separator == '\0' || !minutes) return std::nullopt;
    hour = *hours;
    minute = *minutes;
    if (text.take(separator)) {
      const auto seconds = text.whole(2, 2);
      if (!seconds) return std::nullopt;
      second = *seconds;
    }
  }
  std::int64_t fraction = 0;
  const Parts before = text.saved();
  if (text.take_any(".,:")) {
    if (text.digits() == 0)
      text = before;
    else
      fraction = text.fraction();
  }
  const bool twelve_hours = text.saved().take_blanks() || letter(text.front());
  if (twelve_hours) {
    Parts ahead = text.saved();
    ahead.take_blanks();
    const std::string half = ahead.word();
    if (half == "am" || half == "pm") {
      if (hour < 1 || hour > 12) return std::nullopt;
      hour = hour % 12 + (half == "pm" ? 12 : 0);
      text = ahead;
    }
  }
  const bool midnight = hour == 24 && minute == 0 && second == 0;
  if ((hour > 23 && !midnight) || minute > 59 || second > 60) return std::nullopt;
  return hour * hour_ns + minute * minute_ns + second * second_ns + fraction;
}

/// What follows the time: false where it is no offset.
bool take_offset(Parts& text, std::optional<std::int64_t>& offset) {
  text.take_blanks();
  if (text.empty()) return true;
  if (letter(text.front())) {
    const std::string zone = text.word();
    if (zone != "z" && zone != "utc" && zone != "gmt") return false;
    offset = 0;
    if (text.empty()) return true;
  }
  const char sign = text.take_any("+-");
  if (sign == '\0') return false;
  const std::size_t digits = text.digits();
  if (digits != 1 && digits != 2 && digits != 4) return false;
  const std::int64_t hours = text.number(digits == 1 ? 1 : 2);
  if (digits != 4) text.take(':');
  const auto minutes = text.empty() ? std::optional(0) : text.whole(2, 2);
  if (!minutes || hours > 23 || *minutes > 59) return false;
  const std::int64_t east = hours * hour_ns + *minutes * minute_ns;
  offset = sign == '-' ? -east : east;
  return text.empty();
}

/// Adds a day and the time of it; empty outside 64 bits.
std::optional<DateText> with_day(DateText read, std::int64_t days, std::int64_t of_day_ns) {
  // Before 1970 from the day's end, so that nothing leaves 64 bits on the first day that they hold.
  const std::int64_t whole = days < 0 ? days + 1 : days;
  const std::int64_t rest_ns = days < 0 ? of_day_ns - day_ns : of_day_ns;
  if (__builtin_mul_overflow(whole, day_ns, &read.clock_ns) ||
      __builtin_add_overflow(read.clock_ns, rest_ns, &read.clock_ns))
    return std::nullopt;
  return read;
}

void take_weekday(Parts& text) {
  Parts ahead = text.saved();
  const std::string word = ahead.word();
  if (word.size() < 3 ||
      std::find(weekdays.begin(), weekdays.end(), word.substr(0, 3)) == weekdays.end())
    return;
  ahead.take(',');
  ahead.take_blanks();
  text = ahead;
}

}  // namespace

std::optional<DateText> read_date_text(std::string_view cell, DateOrder order) {
  Parts text(trimmed(cell));
  DateText read;
  Parts ahead = text.saved();
  if (text.digits() <= 2 && cell.find(':') != std::string_view::npos) {
    read.has_date = false;
    const auto alone = take_clock(ahead);
    if (alone && take_offset(ahead, read.offset_ns)) return DateText{*alone, read.offset_ns, false};
    read = {};
  }
  take_weekday(text);
  char separator = '\0';
  const std::size_t digits = text.digits();
  const bool year_first = digits == 4 || digits == 7 || digits == 8 || digits == 14;
  const auto days = year_first ? take_year_first(text, separator)
                               : take_year_last(text, order, separator, read.is_ordered);
  if (!days) return std::nullopt;
  if (text.empty()) return with_day(read, *days, 0);
  const bool joined = digits == 14;
  if (!joined && !text.take_any("Tt_") && !text.take_blanks() &&
      !(separator != '\0' && text.take(separator)) && !text.take_any(":/-"))
    return std::nullopt;
  text.take_blanks();
  const auto clock = take_clock(text);
  if (!clock || !take_offset(text, read.offset_ns)) return std::nullopt;
  return with_day(read, *days, *clock);
}

}  // namespace reident::telemetry_file
