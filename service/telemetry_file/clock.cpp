#include "service/telemetry_file/clock.hpp"

#include <algorithm>
#include <array>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

constexpr std::int64_t day_s = 86'400;

struct FormatName {
  std::string_view name;
  TimeFormat format;
};
constexpr std::array<FormatName, 10> formats = {{{"text", TimeFormat::text},
                                                 {"unix", TimeFormat::unix},
                                                 {"elapsed", TimeFormat::elapsed},
                                                 {"excel", TimeFormat::excel},
                                                 {"mjd", TimeFormat::mjd},
                                                 {"jd", TimeFormat::jd},
                                                 {"matlab", TimeFormat::matlab},
                                                 {"filetime", TimeFormat::filetime},
                                                 {"dotnet", TimeFormat::dotnet},
                                                 {"gps", TimeFormat::gps}}};

std::optional<std::int64_t> rounded(std::optional<std::int64_t> time, std::int64_t quantum) {
  if (!time || quantum <= 1) return time;
  const std::int64_t rest = ((*time % quantum) + quantum) % quantum;
  return *time - rest + (rest * 2 >= quantum ? quantum : 0);
}

/// The number of "1,709,157,600.5" with a decimal point.
std::string without_thousands(std::string_view cell, char decimal) {
  std::string plain;
  for (const char c : cell)
    if (c == decimal)
      plain += '.';
    else if (c != '.' && c != ',')
      plain += c;
  return plain;
}

/// The number of "10 sec".
std::string_view without_unit(std::string_view cell) {
  const auto last = cell.find_last_of("0123456789.");
  return cell.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

bool all_digits(std::string_view text) {
  if (!text.empty() && text.front() == '-') text.remove_prefix(1);
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

std::optional<TimeFormat> parse_time_format(std::string_view text) {
  for (const FormatName& known : formats)
    if (known.name == text) return known.format;
  return std::nullopt;
}

std::string time_format_names() {
  std::string text;
  for (const FormatName& known : formats)
    text += std::string(text.empty() ? "" : ", ") + std::string(known.name);
  return text;
}

std::optional<std::int64_t> parse_time_unit(std::string_view text) {
  if (text.empty() || text.find_first_of("+-") != std::string_view::npos) return std::nullopt;
  const bool has_number = text[0] >= '0' && text[0] <= '9';  // 10ms
  const auto unit = parse_duration((has_number ? "" : "1") + std::string(text));
  return unit > 0 ? unit : std::nullopt;
}

bool Clock::uses(std::size_t column) const {
  return column == zone_column_ || column == fraction_column_ ||
         std::find(columns_.begin(), columns_.end(), column) != columns_.end();
}

std::optional<std::int64_t> Clock::read(std::span<const std::string_view> cells) {
  if (zone_column_) {
    offset_ns_ = read_offset(cells[*zone_column_]);
    if (!offset_ns_) return std::nullopt;
  }
  auto time = parts_ == Parts::one ? read_one(cells[columns_.front()]) : read_parts(cells);
  if (!time || !fraction_column_) return time;
  const auto fraction = parse_count(cells[*fraction_column_], fraction_unit_ns_);
  if (!fraction || *fraction < 0 || *fraction >= second_ns ||
      __builtin_add_overflow(*time, *fraction, &*time))
    return std::nullopt;
  return time;
}

/// A time of day; one that is a number, as 93000, with the zeros that it has lost and colons.
std::string Clock::clock_text(std::string_view cell) const {
  std::string clock(trimmed(cell));
  if (clock_digits_ == 0 || !all_digits(clock)) return clock;
  if (clock.size() < clock_digits_) clock.insert(0, clock_digits_ - clock.size(), '0');
  for (std::size_t at = 2; at < clock.size(); at += 3) clock.insert(at, 1, ':');
  return clock;
}

std::optional<std::int64_t> Clock::absolute(const DateText& text) {
  const auto time = counted_on(text);
  return time && text.is_in_leap_second && follows_leap_second(*time)
             ? std::optional(place_in_leap_second(*time))
             : time;
}

std::optional<std::int64_t> Clock::counted_on(const DateText& text) {
  std::int64_t time = 0;
  if (text.offset_ns)
    return __builtin_sub_overflow(text.clock_ns, *text.offset_ns, &time) ? std::nullopt
                                                                         : std::optional(time);
  if (__builtin_add_overflow(text.clock_ns, text.has_date ? 0 : epoch_ns_.value_or(0), &time))
    return std::nullopt;
  if (counts_first_day_ && !text.has_date && __builtin_sub_overflow(time, day_ns, &time))
    return std::nullopt;
  if (is_gps_date_) return utc_of_gps_date(time);
  if (offset_ns_ && __builtin_sub_overflow(time, *offset_ns_, &time)) return std::nullopt;
  return zone_ ? zone_->to_utc(time) : std::optional(time);
}

std::optional<std::int64_t> Clock::read_number_of(std::string_view cell) const {
  std::string with_point;
  if (cell.find(',') != std::string_view::npos || std::count(cell.begin(), cell.end(), '.') > 1) {
    with_point = without_thousands(cell, has_decimal_comma_ ? ',' : '.');
    cell = with_point;
  }
  if (const auto at = cell.find_first_of("Dd");
      at != std::string_view::npos && at + 1 < cell.size() &&
      std::string_view("+-0123456789").find(cell[at + 1]) != std::string_view::npos) {
    with_point = cell;  // 0.5D+02
    with_point[at] = 'e';
    cell = with_point;
  }
  const auto serial = [&](std::int64_t origin_days, std::int64_t half_days = 0) {
    return rounded(parse_count(cell, day_ns, origin_days * day_s + half_days * day_s / 2),
                   quantum_ns_);
  };
  switch (format_) {
    case TimeFormat::excel:
      return serial(25'569);
    case TimeFormat::mjd:
      return serial(40'587);
    case TimeFormat::jd:
      return serial(2'440'587, 1);
    case TimeFormat::matlab:
      return serial(719'529);
    case TimeFormat::filetime:
      return parse_count(cell, 100, 11'644'473'600);
    case TimeFormat::dotnet:
      return parse_count(cell, 100, 62'135'596'800);
    case TimeFormat::gps: {
      const auto time = parse_count(cell, unit_ns_);
      return time ? std::optional(utc_of_gps(*time)) : std::nullopt;
    }
    case TimeFormat::mixed:
    case TimeFormat::text:
    case TimeFormat::unix:
    case TimeFormat::elapsed:
      break;
  }
  if (has_unit_behind_) cell = without_unit(cell);
  const auto time = rounded(parse_count(cell, unit_ns_), quantum_ns_);
  std::int64_t sum = 0;
  if (!time || __builtin_add_overflow(*time, epoch_ns_.value_or(0), &sum)) return std::nullopt;
  if (counts_first_day_ && __builtin_sub_overflow(sum, day_ns, &sum)) return std::nullopt;
  return sum;
}

std::optional<std::int64_t> Clock::read_one(std::string_view cell) {
  if (format_ == TimeFormat::mixed) {
    const std::string_view text = trimmed(cell);
    if (unit_ns_ == second_ns && text.size() >= 17 && all_digits(text)) return parse_count(text, 1);
    if (const auto time = parse_count(text, unit_ns_)) return time;
    if (!zone_ && !offset_ns_)
      if (const auto time = parse_time(text); time && !follows_leap_second(*time)) return time;
  } else if (format_ != TimeFormat::text) {
    const auto time = read_number_of(cell);
    if (!time || format_ != TimeFormat::excel) return time;
    return absolute({.clock_ns = *time, .offset_ns = {}, .has_date = true, .is_ordered = false});
  } else if (!zone_ && !offset_ns_ && !is_gps_date_) {
    const std::string_view text = trimmed(cell);
    if (text.size() > 4 && text[4] == '-')
      if (const auto time = parse_time(text); time && !follows_leap_second(*time)) return time;
  }
  auto text = read_date_text(cell, order_);
  if (text && counts_minutes_ && std::count(cell.begin(), cell.end(), ':') == 1)
    text->clock_ns /= 60;
  return text ? absolute(*text) : std::nullopt;
}

std::optional<std::int64_t> Clock::read_parts(std::span<const std::string_view> cells) {
  if (parts_ == Parts::joined && !part_unit_ns_.empty()) {
    auto day = read_date_text(cells[columns_[0]], order_);
    const auto of_day = parse_count(cells[columns_[1]], part_unit_ns_.front());
    if (!day || !of_day || *of_day < 0 || *of_day > day_ns) return std::nullopt;
    day->clock_ns += *of_day;
    return absolute(*day);
  }
  if (parts_ == Parts::joined) {
    const std::string clock = clock_text(cells[columns_[1]]);
    if (adds_clock_) {
      const auto date = read_date_text(cells[columns_[0]], order_);
      auto of_day = read_date_text(clock, order_);
      if (!date || !of_day || of_day->has_date) return std::nullopt;
      of_day->clock_ns += date->clock_ns;
      of_day->has_date = true;
      return absolute(*of_day);
    }
    const auto text =
        read_date_text(std::string(trimmed(cells[columns_[0]])) + " " + clock, order_);
    return text ? absolute(*text) : std::nullopt;
  }
  const auto number = [&](std::size_t part, std::int64_t unit) {
    return parse_count(cells[columns_[part]], unit);
  };
  if (parts_ == Parts::gps_week) {
    const auto week = number(0, 7 * day_ns), of_week = number(1, unit_ns_);
    if (!week || !of_week) return std::nullopt;
    return utc_of_gps(*week + *of_week);
  }
  if (parts_ == Parts::day_count) {
    const auto day = number(0, day_ns), of_day = number(1, part_unit_ns_.front());
    std::int64_t time = 0;
    if (!day || !of_day || *of_day < 0 || *of_day > day_ns + second_ns ||
        __builtin_add_overflow(*day, *of_day, &time) ||
        __builtin_add_overflow(time, epoch_ns_.value_or(0), &time))
      return std::nullopt;
    return time;
  }
  const bool is_ordinal = parts_ == Parts::day_of_year;
  const bool is_dated = parts_ == Parts::dated;
  std::string_view second = trimmed(cells[columns_[1]]);
  std::int64_t of_day_ns = 0;
  if (const auto point = second.find(has_decimal_comma_ ? ',' : '.');
      is_ordinal && point != std::string_view::npos) {  // 59.9166667
    const auto fraction = parse_count("0." + std::string(second.substr(point + 1)), day_ns);
    if (!fraction) return std::nullopt;
    of_day_ns = *rounded(fraction, quantum_ns_);
    second = second.substr(0, point);
  }
  std::string date(trimmed(cells[columns_[0]]));
  if (!is_dated) date += "/";
  if (is_ordinal) date.append(3 - std::min<std::size_t>(second.size(), 3), '0');  // 9 is 009
  if (!is_dated) date += second;
  if (parts_ == Parts::calendar) date += "/" + std::string(trimmed(cells[columns_[2]]));
  const auto day = read_date_text(date, order_);
  if (!day) return std::nullopt;
  DateText time = *day;
  time.clock_ns += of_day_ns;
  const std::size_t first = is_dated ? 1 : is_ordinal ? 2 : 3;
  for (std::size_t part = first; part < columns_.size(); ++part) {
    if (part_unit_ns_[part - first] == 0) {  // a time of day as text
      const auto of_day = read_date_text(clock_text(cells[columns_[part]]), order_);
      if (!of_day || of_day->has_date) return std::nullopt;
      time.clock_ns += of_day->clock_ns;
      time.offset_ns = of_day->offset_ns;
      continue;
    }
    const auto value = number(part, part_unit_ns_[part - first]);
    if (!value) return std::nullopt;
    time.clock_ns += *value;
  }
  return absolute(time);
}

}  // namespace reident::telemetry_file
