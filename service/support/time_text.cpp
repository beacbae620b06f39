#include "service/support/time_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <limits>
#include <system_error>
#include <utility>

#include "service/support/floor_divide.hpp"
#include "service/support/text.hpp"

namespace reident {
namespace {

__extension__ using Wide = __int128;

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::int64_t minute_ns = 60 * second_ns;
constexpr std::int64_t hour_ns = 60 * minute_ns;
constexpr std::int64_t day_ns = 24 * hour_ns;

struct Unit {
  std::string_view name;
  std::int64_t ns;
};
constexpr std::array<Unit, 7> units = {{{"d", day_ns},
                                        {"h", hour_ns},
                                        {"min", minute_ns},
                                        {"s", second_ns},
                                        {"ms", 1'000'000},
                                        {"us", 1'000},
                                        {"ns", 1}}};

constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::optional<std::int64_t> narrow(Wide value) {
  if (value < std::numeric_limits<std::int64_t>::min() ||
      value > std::numeric_limits<std::int64_t>::max()) {
    return std::nullopt;
  }
  return static_cast<std::int64_t>(value);
}

/// A decimal number: (-1)^negative * digits * 10^exponent.
struct Decimal {
  bool negative = false;
  Wide digits = 0;
  int exponent = 0;
};

/// Takes a number off the front of `text`: sign, digits, point, digits, exponent. 20
/// significant digits are kept: all of a nanosecond in every time that can be held.
std::optional<Decimal> take_decimal(std::string_view& text) {
  constexpr Wide room = Wide{1'000'000'000'000'000'000} * 10;
  Decimal number;
  std::size_t at = 0;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) number.negative = text[at++] == '-';
  bool point = false;
  bool any = false;
  for (; at < text.size() && (is_digit(text[at]) || (text[at] == '.' && !point)); ++at) {
    if (text[at] == '.') {
      point = true;
      continue;
    }
    any = true;
    const bool kept = number.digits < room;
    if (kept) number.digits = number.digits * 10 + (text[at] - '0');
    if (kept && point) --number.exponent;
    if (!kept && !point) ++number.exponent;
  }
  if (!any) return std::nullopt;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    const char* first = text.data() + at + 1;
    const char* last = text.data() + text.size();
    if (first != last && *first == '+') ++first;
    int exponent = 0;
    const auto [end, error] = std::from_chars(first, last, exponent);
    if (error != std::errc{} || exponent < -1000 || exponent > 1000) return std::nullopt;
    number.exponent += exponent;
    at = static_cast<std::size_t>(end - text.data());
  }
  text.remove_prefix(at);
  return number;
}

/// number * unit, rounded to the nearest integer (halves away from zero); empty far outside 64
/// bits.
std::optional<Wide> scaled_wide(const Decimal& number, std::int64_t unit) {
  Wide value = number.digits * unit;
  constexpr Wide limit = static_cast<Wide>(std::numeric_limits<std::int64_t>::max()) * second_ns;
  for (int e = number.exponent; e > 0 && value != 0; --e) {
    if (value > limit) return std::nullopt;
    value *= 10;
  }
  if (number.exponent < 0) {
    Wide divisor = 1;
    for (int e = number.exponent; e < 0; ++e) {
      if (divisor > 2 * value) return 0;
      divisor *= 10;
    }
    value = (value + divisor / 2) / divisor;
  }
  return number.negative ? -value : value;
}

std::optional<std::int64_t> scaled(const Decimal& number, std::int64_t unit) {
  const auto value = scaled_wide(number, unit);
  return value ? narrow(*value) : std::nullopt;
}

/// Takes `least` to `most` digits off the front.
std::optional<int> take_field(std::string_view& text, std::size_t least, std::size_t most) {
  std::size_t count = 0;
  int value = 0;
  while (count < most && count < text.size() && is_digit(text[count])) {
    value = value * 10 + (text[count++] - '0');
  }
  if (count < least) return std::nullopt;
  text.remove_prefix(count);
  return value;
}

bool take(std::string_view& text, char expected) {
  if (text.empty() || text.front() != expected) return false;
  text.remove_prefix(1);
  return true;
}

/// "2023-04-29" or "2023/4/29" to days since the epoch.
std::optional<std::int64_t> take_date(std::string_view& text) {
  const auto year = take_field(text, 4, 4);
  if (!year) return std::nullopt;
  const bool slashes = take(text, '/');
  if (!slashes && !take(text, '-')) return std::nullopt;
  const std::size_t least = slashes ? 1 : 2;
  const auto month = take_field(text, least, 2);
  if (!month || !take(text, slashes ? '/' : '-')) return std::nullopt;
  const auto day = take_field(text, least, 2);
  if (!day) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year{*year},
                                         std::chrono::month{static_cast<unsigned>(*month)},
                                         std::chrono::day{static_cast<unsigned>(*day)}};
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days{date}.time_since_epoch().count();
}

/// "16:22", "16:22:37.5" to nanoseconds of the day.
std::optional<std::int64_t> take_clock(std::string_view& text) {
  const auto hour = take_field(text, 1, 2);
  if (!hour || *hour > 23 || !take(text, ':')) return std::nullopt;
  const auto minute = take_field(text, 2, 2);
  if (!minute || *minute > 59) return std::nullopt;
  const std::int64_t of_day = *hour * hour_ns + *minute * minute_ns;
  if (!take(text, ':')) return of_day;
  const auto second = take_field(text, 2, 2);
  if (!second || *second > 60) return std::nullopt;
  std::int64_t fraction = 0;
  if (!text.empty() && text.front() == '.') {
    const auto end = text.find_first_not_of("0123456789", 1);
    std::string_view digits = text.substr(0, end);
    text.remove_prefix(digits.size());
    const auto number = take_decimal(digits);
    if (!number) return std::nullopt;
    fraction = scaled(*number, second_ns).value_or(0);
  }
  return of_day + *second * second_ns + fraction;
}

/// "", "Z", "+03", "+0300" or "+03:00" to nanoseconds east of UTC.
std::optional<std::int64_t> take_offset(std::string_view& text) {
  if (text.empty() || take(text, 'Z') || take(text, 'z')) return 0;
  const bool west = text.front() == '-';
  if (!take(text, '+') && !take(text, '-')) return std::nullopt;
  const auto hours = take_field(text, 2, 2);
  if (!hours || *hours > 23) return std::nullopt;
  std::int64_t minutes = 0;
  if (!text.empty()) {
    take(text, ':');
    const auto field = take_field(text, 2, 2);
    if (!field || *field > 59) return std::nullopt;
    minutes = *field;
  }
  const std::int64_t east = *hours * hour_ns + minutes * minute_ns;
  return west ? -east : east;
}

std::optional<std::int64_t> parse_calendar(std::string_view text) {
  const auto days = take_date(text);
  if (!days) return std::nullopt;
  std::int64_t of_day = 0;
  std::int64_t east = 0;
  if (!text.empty()) {
    if (!take(text, 'T') && !take(text, 't') && !take(text, ' ')) return std::nullopt;
    text = trimmed(text);
    const auto clock = take_clock(text);
    if (!clock) return std::nullopt;
    of_day = *clock;
    text = trimmed(text);
    const auto offset = take_offset(text);
    if (!offset || !text.empty()) return std::nullopt;
    east = *offset;
  }
  return narrow(static_cast<Wide>(*days) * day_ns + of_day - east);
}

/// So many digits, with zeros in front. A large export writes millions of times.
void append_digits(std::string& text, std::int64_t value, std::size_t digits) {
  text.resize(text.size() + digits, '0');
  for (auto at = text.rbegin(); value > 0; ++at, value /= 10)
    *at = static_cast<char>('0' + value % 10);
}

}  // namespace

std::optional<std::int64_t> parse_time(std::string_view text) {
  text = trimmed(text);
  if (text.size() > 4 && (text[4] == '-' || text[4] == '/')) return parse_calendar(text);
  const auto number = take_decimal(text);
  if (!number || !text.empty()) return std::nullopt;
  return scaled(*number, second_ns);
}

std::optional<std::int64_t> parse_count(std::string_view text, std::int64_t unit_ns,
                                        std::int64_t origin_s) {
  text = trimmed(text);
  const auto number = take_decimal(text);
  if (!number || !text.empty()) return std::nullopt;
  const auto value = scaled_wide(*number, unit_ns);
  return value ? narrow(*value - static_cast<Wide>(origin_s) * second_ns) : std::nullopt;
}

std::optional<std::int64_t> parse_duration(std::string_view text) {
  text = trimmed(text);
  const auto number = take_decimal(text);
  if (!number) return std::nullopt;
  text = trimmed(text);
  if (text.empty()) return scaled(*number, second_ns);
  for (const Unit& unit : units) {
    if (text == unit.name) return scaled(*number, unit.ns);
  }
  return std::nullopt;
}

std::string time_text(std::int64_t time_ns) {
  using namespace std::chrono;
  // Not by floor<days>, which would step outside 64 bits on the first day that they hold.
  const std::int64_t rest_ns = time_ns % day_ns;
  const std::int64_t of_day_ns = rest_ns < 0 ? rest_ns + day_ns : rest_ns;
  const year_month_day date{sys_days{days{floor_divide(time_ns, day_ns)}}};
  std::string text;
  text.reserve(sizeof "2023-04-29T16:22:37.123456789Z");
  append_digits(text, static_cast<int>(date.year()), 4);
  append_digits(text += '-', static_cast<unsigned>(date.month()), 2);
  append_digits(text += '-', static_cast<unsigned>(date.day()), 2);
  append_digits(text += 'T', of_day_ns / hour_ns, 2);
  append_digits(text += ':', of_day_ns % hour_ns / minute_ns, 2);
  append_digits(text += ':', of_day_ns % minute_ns / second_ns, 2);
  if (const std::int64_t fraction = of_day_ns % second_ns; fraction != 0) {
    append_digits(text += '.', fraction, 9);
    text.erase(text.find_last_not_of('0') + 1);
  }
  return text += 'Z';
}

std::optional<std::int64_t> parse_moment(std::string_view text, std::int64_t now_ns) {
  if (text == "now") return now_ns;
  const bool has_unit = !text.empty() && text.back() >= 'a' && text.back() <= 'z';
  if (!text.starts_with('-') || !has_unit) return parse_time(text);
  const auto before = parse_duration(text);
  std::int64_t moment = 0;
  if (!before || __builtin_add_overflow(now_ns, *before, &moment)) return std::nullopt;
  return moment;
}

std::string rough_duration_text(std::int64_t duration_ns) {
  constexpr std::int64_t year_ns = 365 * day_ns;
  if (duration_ns < 0)
    return "-" + rough_duration_text(duration_ns == INT64_MIN ? INT64_MAX : -duration_ns);
  for (const auto& [ns, name] :
       {std::pair{2 * year_ns, "y"}, {day_ns, "d"}, {hour_ns, "h"}, {minute_ns, "min"}})
    if (duration_ns >= ns) return std::to_string(duration_ns / std::min(ns, year_ns)) + name;
  return std::to_string(duration_ns / second_ns) + "s";
}

std::string duration_text(std::int64_t duration_ns) {
  if (duration_ns == 0) return "0s";
  for (const Unit& unit : units) {
    if (duration_ns % unit.ns == 0) {
      return std::to_string(duration_ns / unit.ns) + std::string(unit.name);
    }
  }
  return {};
}

}  // namespace reident
