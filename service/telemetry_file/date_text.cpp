#include "service/telemetry_file/date_text.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <vector>

#include "service/support/text.hpp"
#include "service/telemetry_file/date_spelling.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

/// What the names of a month begin with in English, German, French, Spanish, Portuguese, Italian.
constexpr std::array<std::string_view, 12> months = {
    " jan ene gen ", " feb fev ",         " mar mrz ",      " apr avr abr ",
    " may mai mag ", " jun juin giu ",    " jul juil lug ", " aug aou ago ",
    " sep set ",     " oct okt out ott ", " nov ",          " dec dez dic "};

struct NamedOffset {
  std::string_view name;
  int minutes;
};
/// Names of zones of RFC 822, and others that stand for one offset alone. IST and BST do not.
constexpr std::array<NamedOffset, 34> named_offsets = {
    {{"z", 0},      {"utc", 0},    {"gmt", 0},    {"ut", 0},     {"wet", 0},    {"west", 60},
     {"cet", 60},   {"met", 60},   {"mez", 60},   {"cest", 120}, {"mest", 120}, {"mesz", 120},
     {"eet", 120},  {"eest", 180}, {"est", -300}, {"edt", -240}, {"cst", -360}, {"cdt", -300},
     {"mst", -420}, {"mdt", -360}, {"pst", -480}, {"pdt", -420}, {"msk", 180},  {"sast", 120},
     {"hkt", 480},  {"sgt", 480},  {"jst", 540},  {"kst", 540},  {"aest", 600}, {"aedt", 660},
     {"nzst", 720}, {"nzdt", 780}, {"brt", -180}, {"art", -180}}};

bool digit(char c) {
  return c >= '0' && c <= '9';
}
bool letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c & 0x80) != 0;
}

/// The letter of U+00C0 to U+00FF without its accent, in lower case, of its second byte in UTF-8;
/// '\0' where no month has it.
char without_accent(char second) {
  switch (static_cast<unsigned char>(second) | 0x20U) {
    case 0xA4:
      return 'a';
    case 0xA7:
      return 'c';
    case 0xA8:
    case 0xA9:
      return 'e';
    case 0xBB:
      return 'u';
    default:
      return '\0';
  }
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
  /// Whether a time of day comes next, as 22:00:30, and no short year in front of one.
  bool is_clock() const {
    return digits() == 2 && text_.size() > 2 && text_[2] == ':' &&
           std::count(text_.begin(), text_.end(), ':') <= 2;
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
  /// Takes letters, as lower case and without accents.
  std::string word() {
    std::string taken;
    while (letter(front())) {
      const bool is_accented = text_.front() == '\xC3' && text_.size() > 1;
      taken += is_accented ? without_accent(text_[1]) : static_cast<char>(text_.front() | 0x20);
      text_.remove_prefix(is_accented ? 2 : 1);
    }
    return taken;
  }
  /// Digits as a part of a second [ns], those below a nanosecond cut off; 250.000.000 is 250.
  std::int64_t fraction() {
    std::int64_t value = 0, unit = second_ns;
    const bool is_in_groups = digits() == 3;
    for (; digit(front()); text_.remove_prefix(1)) {
      unit /= 10;
      value += (text_.front() - '0') * unit;
      if (is_in_groups && text_.size() > 4 && text_[1] == '.' && digit(text_[2]))
        text_.remove_prefix(1);
    }
    return value;
  }
  Parts saved() const { return *this; }
  /// Whether the clock that was taken has a second 60.
  bool has_second_60 = false;

 private:
  std::string_view text_;
};

std::optional<int> month_of(std::string_view word) {
  if (word.size() < 3) return std::nullopt;
  const std::size_t letters = word.starts_with("jui") ? 4 : 3;  // juin, juillet
  const std::string begin = " " + std::string(word.substr(0, letters)) + " ";
  for (std::size_t m = 0; m < months.size(); ++m)
    if (months[m].find(begin) != std::string_view::npos) return static_cast<int>(m) + 1;
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
  if (text.digits() == 9) return days_of_ordinal(year, text.number(3));  // 2024059220000
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
  if (separator == ' ') text.take_blanks();  // 2024 Nov  3
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
    const bool is_short = text.digits() == 2;
    first = text.whole(1, 2);
    separator = text.take_any("-/. ");
    if (is_short && separator != ' ' && text.digits() == 3) {
      const auto days = days_of_ordinal(2000 + *first, text.number(3));  // 24-059T22:00
      return text.empty() ? std::nullopt : days;
    }
    text.take_blanks();  // 28. Februar, 28FEB2024
    if (letter(text.front()))
      month = month_of(text.word());
    else
      second = text.whole(1, 2);
  }
  if (!first || (!month && (!second || separator == '\0'))) return std::nullopt;
  text.take(',');
  if (!text.take_any("-/. ") && separator != '\0') return std::nullopt;
  text.take_blanks();
  const std::size_t digits = text.digits();
  if (digits != 4 && (digits != 2 || separator == '\0')) return std::nullopt;
  if (text.is_clock()) return std::nullopt;  // Nov 27 10:00:00, 28.02. 22:00:00
  if (order == DateOrder::year_first && digits == 2 && second)
    return days_of(2000 + *first, *second, text.number(2));
  const int year = digits == 4 ? text.number(4) : 2000 + text.number(2);
  if (month) return days_of(year, *month, *first);
  is_ordered = separator != '.' && *first <= 12 && *second <= 12 && *first != *second;
  const bool day_first =
      separator == '.' || *first > 12 || (*second <= 12 && order == DateOrder::day_first);
  return day_first ? days_of(year, *second, *first) : days_of(year, *first, *second);
}

/// A time of day [ns]; as a time that has passed it may have more than 24 hours.
std::optional<std::int64_t> take_clock(Parts& text, bool has_passed = false) {
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
    const auto hours = text.whole(1, has_passed ? 3 : 2);
    const char separator = text.take_any(":.");
    const auto minutes = text.whole(2, 2);
    if (!hours || separator == '\0' || !minutes) return std::nullopt;
    hour = *hours;
    minute = *minutes;
    Parts ahead = text.saved();
    if (separator == ':' && ahead.take_any(".,") != '\0' && ahead.digits() > 0) {
      // Parts of a second stand behind seconds: 59:30.5 are minutes and seconds.
      if (!has_passed || hour > 59) return std::nullopt;
      second = minute;
      minute = hour;
      hour = 0;
    } else if (text.take(separator)) {
      const auto seconds = text.whole(2, 2);
      if (!seconds) return std::nullopt;
      second = *seconds;
    }
  }
  std::int64_t fraction = 0;
  const Parts before = text.saved();
  if (const char mark = text.take_any(".,:")) {
    if (text.digits() < (mark == ':' ? 3U : 1U))
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
  if ((hour > 23 && !midnight && !has_passed) || minute > 59 || second > 60) return std::nullopt;
  text.has_second_60 = second == 60;
  return hour * hour_ns + minute * minute_ns + second * second_ns + fraction;
}

/// What follows the time: false where it is no offset.
bool take_offset(Parts& text, std::optional<std::int64_t>& offset) {
  text.take_blanks();
  if (text.empty()) return true;
  if (letter(text.front())) {
    const std::string zone = text.word();
    const auto* named = std::find_if(named_offsets.begin(), named_offsets.end(),
                                     [&](const NamedOffset& one) { return one.name == zone; });
    if (named == named_offsets.end()) return false;
    offset = named->minutes * minute_ns;
    if (text.empty()) return true;
    if (*offset != 0) return false;
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

/// 22:00:30, or the time that has passed: 26:03:10, 012/22:00:30, 12:22:00:30, 2 22:00:30.
std::optional<DateText> read_clock(Parts text) {
  DateText read{.clock_ns = 0, .offset_ns = {}, .has_date = false, .is_ordered = false};
  Parts alone = text.saved();
  if (const auto clock = take_clock(alone, true); clock && take_offset(alone, read.offset_ns)) {
    read.clock_ns = *clock;
    return read;
  }
  const auto days = text.whole(1, 5);
  if (!days || !text.take_any("/ :T")) return std::nullopt;
  const std::size_t hour_digits = text.digits();
  const auto clock = take_clock(text);
  if (!clock || hour_digits > 2 || !text.empty()) return std::nullopt;
  read.offset_ns.reset();
  read.clock_ns = *days * day_ns + *clock;
  return read;
}

/// What Unix prints: Feb 28 22:00:30 UTC 2024.
std::optional<DateText> read_year_at_end(Parts text) {
  DateText read;
  const auto month = month_of(text.word());
  if (!month || !text.take_blanks()) return std::nullopt;
  const auto day = text.whole(1, 2);
  if (!day || !text.take_blanks()) return std::nullopt;
  const auto clock = take_clock(text);
  if (!clock || !text.take_blanks()) return std::nullopt;
  read.is_in_leap_second = text.has_second_60;
  if (letter(text.front())) {
    const std::string name = text.word();
    Parts alone(name);
    if (!take_offset(alone, read.offset_ns) || !text.take_blanks()) return std::nullopt;
  }
  const auto year = text.whole(4, 4);
  if (!year || !text.empty()) return std::nullopt;
  const auto days = days_of(*year, *month, *day);
  return days ? with_day(read, *days, *clock) : std::nullopt;
}

std::string_view without_brackets(std::string_view cell) {
  cell = trimmed(cell);
  const bool has_brackets = cell.size() > 2 && ((cell.front() == '[' && cell.back() == ']') ||
                                                (cell.front() == '\'' && cell.back() == '\''));
  return has_brackets ? trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

/// 240228220030, and 202402282200 from the year 2020 on; both may begin with 200 and 201.
std::optional<DateText> read_twelve_digits(Parts text) {
  const int first = text.number(2), second = text.number(2);
  const bool is_long = first == 20 && second >= 20;
  if (first < 21 && !is_long) return std::nullopt;
  const int year = 2000 + (is_long ? second : first);
  const int month = is_long ? text.number(2) : second;
  const auto days = days_of(year, month, text.number(2));
  const auto clock = days ? take_clock(text) : std::nullopt;
  return clock && text.empty() ? with_day({}, *days, *clock) : std::nullopt;
}

std::optional<DateText> read_plain(std::string_view cell, DateOrder order) {
  Parts text(without_brackets(cell));
  DateText read;
  if (text.digits() <= 5 && cell.find(':') != std::string_view::npos)
    if (auto clock = read_clock(text.saved())) return clock;
  if (letter(text.front()))
    if (auto found = read_year_at_end(text.saved())) return found;
  char separator = '\0';
  const std::size_t digits = text.digits();
  // Thirteen digits of another begin are milliseconds since 1970.
  const bool packed = digits == 13 && text.front() == '2';
  if (digits == 12) return read_twelve_digits(text);
  const bool year_first = digits == 4 || digits == 7 || digits == 8 || packed || digits == 14;
  const auto days = year_first ? take_year_first(text, separator)
                               : take_year_last(text, order, separator, read.is_ordered);
  if (!days) return std::nullopt;
  if (text.empty()) return with_day(read, *days, 0);
  const bool joined = digits >= 13;
  if (!joined && !text.take_any("Tt_") && !text.take_blanks() &&
      !(separator != '\0' && text.take(separator)) && !text.take_any(":/-"))
    return std::nullopt;
  text.take_blanks();
  if (text.take('@')) text.take_blanks();  // Feb 28, 2024 @ 22:00
  const auto clock = take_clock(text);
  if (!clock || !take_offset(text, read.offset_ns)) return std::nullopt;
  read.is_in_leap_second = text.has_second_60;
  return with_day(read, *days, *clock);
}

}  // namespace

std::optional<std::int64_t> read_offset(std::string_view text) {
  Parts parts(trimmed(text));
  std::optional<std::int64_t> offset;
  return take_offset(parts, offset) ? offset : std::nullopt;
}

std::string with_missing_year(std::string_view cell) {
  cell = trimmed(cell);
  const auto reads = [](const std::string& text) {
    const auto read = read_date_text(text, DateOrder::day_first);
    return read && read->has_date;
  };
  if (cell.find(':') == std::string_view::npos || reads(std::string(cell))) return {};
  std::vector<std::string> spellings = {"2024 " + std::string(cell)};
  for (auto at = cell.find(' '); at != std::string_view::npos; at = cell.find(' ', at + 1))
    for (const char* year : {"2024", " 2024"})
      spellings.push_back(std::string(cell).insert(at, year));
  const auto found = std::find_if(spellings.begin(), spellings.end(), reads);
  return found == spellings.end() ? std::string() : *found;
}

std::optional<DateText> read_date_text(std::string_view cell, DateOrder order) {
  constexpr std::size_t longest = 100;  // of any spelling, in bytes
  if (auto read = read_plain(cell, order)) return read;
  if (cell.size() > longest) return std::nullopt;
  const std::string plain = plain_spelling(cell);
  return plain == cell ? std::nullopt : read_plain(plain, order);
}

}  // namespace reident::telemetry_file
