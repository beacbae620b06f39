#include "service/telemetry_file/clock_finder.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/clock_words.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

constexpr double seconds_a_day = 86'400;
constexpr double earliest_s = 631'152'000;  // 1990
constexpr int min_serial_decimals = 4;
constexpr std::int64_t coarsest_quantum_ns = 10 * second_ns;
constexpr double much_less = 5;  // times, of the spans of two ways to read dates

using Problem = Clock::Problem;

/// Whether a date's three numbers have two digits at most, as 24-02-28.
bool has_short_year(std::string_view cell) {
  cell = trimmed(cell);
  cell = cell.substr(0, cell.find_first_not_of("0123456789-/."));
  std::size_t parts = 1, digits = 0;
  for (const char c : cell) {
    const bool is_digit = c >= '0' && c <= '9';
    digits = is_digit ? digits + 1 : 0;
    parts += is_digit ? 0U : 1U;
    if (digits > 2) return false;
  }
  return parts == 3;
}

/// Seconds since 1970 of a number in a format.
double seconds_of(double value, TimeFormat format, std::int64_t unit_ns) {
  switch (format) {
    case TimeFormat::excel:
      return (value - 25'569) * seconds_a_day;
    case TimeFormat::mjd:
      return (value - 40'587) * seconds_a_day;
    case TimeFormat::jd:
      return (value - 2'440'587.5) * seconds_a_day;
    case TimeFormat::matlab:
      return (value - 719'529) * seconds_a_day;
    case TimeFormat::filetime:
      return value * 1e-7 - 11'644'473'600.0;
    case TimeFormat::dotnet:
      return value * 1e-7 - 62'135'596'800.0;
    case TimeFormat::gps:
      return value * static_cast<double>(unit_ns) * 1e-9 + 315'964'800;
    case TimeFormat::mixed:
    case TimeFormat::text:
    case TimeFormat::unix:
    case TimeFormat::elapsed:
      break;
  }
  return value * static_cast<double>(unit_ns) * 1e-9;
}

/// The power of ten [ns] that numbers of a unit are rounded to: they have so many decimals, and
/// were doubles near `value`. 1 where they do not resolve ten seconds.
std::int64_t quantum_of(std::int64_t unit_ns, int decimals, double value) {
  const double spacing = std::nextafter(value, 1e300) - value;
  const double resolution_ns = static_cast<double>(unit_ns) * (std::pow(10.0, -decimals) + spacing);
  std::int64_t quantum = 1;
  while (static_cast<double>(quantum) < resolution_ns)
    if ((quantum *= 10) > coarsest_quantum_ns) return 1;
  return quantum;
}

int decimals_of(std::string_view cell, char mark) {
  const auto point = cell.find(mark);
  return point == std::string_view::npos ? 0 : static_cast<int>(cell.size() - point) - 1;
}

}  // namespace

std::variant<Clock, Problem> ClockFinder::run() {
  if (options_.zone) {
    clock_.zone_ = TimeZone::named(*options_.zone);
    if (!clock_.zone_) clock_.offset_ns_ = read_offset(*options_.zone);
    if (!clock_.zone_ && !clock_.offset_ns_)
      return Problem{0, "--time-zone " + *options_.zone +
                            " is not known here; name it as Europe/Berlin, +01:00 or UTC"};
  }
  clock_.epoch_ns_ = options_.epoch_ns;
  clock_.has_decimal_comma_ = head_.style.decimal == ',';
  if (options_.order) clock_.order_ = *options_.order;
  if (auto problem = choose_columns()) return *std::move(problem);
  if (auto problem =
          clock_.parts_ == Clock::Parts::one ? decide_one(clock_.columns_.front()) : decide_parts())
    return *std::move(problem);
  if (options_.zone) clock_.description_ += ", " + *options_.zone;
  if (clock_.may_be_local_ && clock_.is_absolute() && !find_zone_column()) {
    take_zone_of_names();
    if (clock_.may_be_local_) take_zone_of_lines();
  }
  find_fraction_column();
  clock_.is_newest_first_ = is_newest_first();
  if (clock_.is_newest_first_) clock_.description_ += ", newest first";
  if (clock_.zone_ && clock_.is_newest_first_) clock_.zone_->put_newest_first();
  return std::move(clock_);
}

/// Whether the clock goes back between most of the first rows.
bool ClockFinder::is_newest_first() const {
  constexpr std::size_t rows_looked_at = 1000;
  Clock reading = clock_;
  reading.zone_.reset();
  std::vector<std::string_view> cells(head_.columns.size());
  std::optional<std::int64_t> before;
  std::size_t back = 0, ahead = 0;
  for (std::size_t row = 0; row < std::min(head_.lines.size(), rows_looked_at); ++row) {
    for (std::size_t c = 0; c < cells.size(); ++c) cells[c] = head_.columns[c][row];
    const auto time = reading.read(cells);
    if (time && before) (*time < *before ? back : ahead) += *time == *before ? 0U : 1U;
    if (time) before = time;
  }
  return back > 1 && back > 3 * ahead;
}

std::optional<Problem> ClockFinder::decide_parts() {
  const bool are_numbers =
      clock_.parts_ == Clock::Parts::gps_week || clock_.parts_ == Clock::Parts::day_count;
  clock_.may_be_local_ = !are_numbers && !options_.zone;
  switch (clock_.parts_) {
    case Clock::Parts::joined:
    case Clock::Parts::dated:
      clock_.description_ = "a date and a time of day";
      break;
    case Clock::Parts::calendar:
      clock_.description_ = "year, month, day";
      break;
    case Clock::Parts::day_of_year:
      clock_.description_ = "year, day of year";
      for (const std::string_view cell : head_.columns[clock_.columns_[1]])
        if (const int decimals = decimals_of(trimmed(cell), head_.style.decimal); decimals > 0)
          clock_.quantum_ns_ = quantum_of(day_ns, std::max(decimals, min_serial_decimals), 366);
      break;
    case Clock::Parts::day_count:
      clock_.description_ = "days and " + unit_name(clock_.part_unit_ns_.front()) + " of the day";
      break;
    default:
      clock_.description_ = "GPS week and " + unit_name(clock_.unit_ns_);
      break;
  }
  if (!are_numbers)
    for (const std::size_t c : clock_.columns_)
      if (auto problem = decide_scale(c)) return problem;
  if (clock_.parts_ == Clock::Parts::joined || clock_.parts_ == Clock::Parts::dated)
    return decide_order(clock_.columns_.front());
  return std::nullopt;
}

/// How dates such as 24-02-28 read with the year first: not of today in some row; as well as with
/// the day or the month first; or of today in this way alone.
ClockFinder::YearFirst ClockFinder::year_first(std::size_t c) const {
  bool is_needed = false, differs = false;
  for (const std::string_view cell : head_.columns[c]) {
    const auto seconds = [cell](DateOrder order) {
      const auto read = read_date_text(cell, order);
      return read && read->has_date ? static_cast<double>(read->clock_ns) * 1e-9 : -1;
    };
    if (trimmed(cell).empty()) continue;
    const double at = seconds(DateOrder::year_first);
    if (at < earliest_s || at > latest_s_) return YearFirst::impossible;
    const double other = seconds(DateOrder::day_first);
    is_needed = is_needed || other < 0 || other > latest_s_;
    differs = differs || (at != other && has_short_year(cell));
  }
  if (is_needed) return YearFirst::alone;
  return differs ? YearFirst::possible : YearFirst::impossible;
}

/// How far apart the dates of neighbouring rows are, in all [s].
double ClockFinder::span(std::size_t c, DateOrder order) const {
  double span = 0;
  std::optional<double> before;
  for (const std::string_view cell : head_.columns[c]) {
    const auto read = read_date_text(cell, order);
    if (!read) continue;
    const double at = static_cast<double>(read->clock_ns) * 1e-9;
    span += std::abs(at - before.value_or(at));
    before = at;
  }
  return span;
}

/// Whether 03/04/2024 is in April or in March.
std::optional<Problem> ClockFinder::decide_order(std::size_t c) {
  if (options_.order) return std::nullopt;
  const YearFirst year = year_first(c);
  if (year == YearFirst::alone) {
    clock_.order_ = DateOrder::year_first;
    return std::nullopt;
  }
  if (year == YearFirst::possible) {
    const double with_year = span(c, DateOrder::year_first),
                 without = std::min(span(c, DateOrder::day_first), span(c, DateOrder::month_first));
    if (with_year * much_less < without) {
      clock_.order_ = DateOrder::year_first;
      return std::nullopt;
    }
    if (without * much_less >= with_year) {
      const auto [cell, line] = first_cell(c);
      return Problem{line, shown(cell) + " in column '" + head_.names[c] +
                               "' may have the year or the day first; say --time-format ymd, dmy "
                               "or mdy"};
    }
  }
  bool day_first = false, month_first = false;
  std::string_view ambiguous;
  std::uint64_t line = 0;
  for (std::size_t row = 0; row < head_.columns[c].size(); ++row) {
    const std::string_view cell = head_.columns[c][row];
    const auto one = read_date_text(cell, DateOrder::day_first),
               other = read_date_text(cell, DateOrder::month_first);
    if (!one || !other) continue;
    if (one->is_ordered) {
      if (ambiguous.empty()) {
        ambiguous = cell;
        line = head_.lines[row];
      }
    } else if (const auto mark = cell.find('/'); mark != std::string_view::npos && mark < 3) {
      const auto first = plain_number(cell.substr(0, mark));
      const auto rest = cell.substr(mark + 1);
      const auto second = plain_number(rest.substr(0, rest.find('/')));
      if (first && second && *first > 12) day_first = true;
      if (first && second && *second > 12) month_first = true;
    }
  }
  if (day_first != month_first) {
    clock_.order_ = day_first ? DateOrder::day_first : DateOrder::month_first;
    return std::nullopt;
  }
  if (ambiguous.empty()) return std::nullopt;
  const double with_day = span(c, DateOrder::day_first),
               with_month = span(c, DateOrder::month_first);
  if (with_day * much_less < with_month || with_month * much_less < with_day) {
    clock_.order_ = with_day < with_month ? DateOrder::day_first : DateOrder::month_first;
    return std::nullopt;
  }
  return Problem{line, shown(ambiguous) + " in column '" + head_.names[c] +
                           "' may have the day or the month first; say --time-format dmy or mdy"};
}

std::optional<Problem> ClockFinder::decide_one(std::size_t c) {
  std::size_t filled = 0, numbers = 0, texts = 0, offsets = 0, dated = 0;
  std::vector<double> values;
  int decimals = 0;
  std::string_view first_text;
  for (const std::string_view raw : head_.columns[c]) {
    const std::string_view cell = trimmed(raw);
    if (cell.empty()) continue;
    ++filled;
    const auto number = read_number(cell, head_.style);
    const auto text = read_date_text(cell, clock_.order_);
    const auto unit_behind = number && !text ? hint_of({}, number->suffix).unit_ns : std::nullopt;
    if (number && (number->suffix.empty() || unit_behind) && std::isfinite(number->value)) {
      clock_.has_unit_behind_ = unit_behind.has_value();
      unit_behind_ = unit_behind;
      ++numbers;
      values.push_back(number->value);
      decimals = std::max(decimals, decimals_of(cell, head_.style.decimal));
    }
    if (!text) continue;
    ++texts;
    if (first_text.empty()) first_text = cell;
    offsets += text->offset_ns ? 1U : 0U;
    dated += text->has_date ? 1U : 0U;
  }
  const bool is_text =
      options_.format
          ? *options_.format == TimeFormat::text ||
                (*options_.format == TimeFormat::gps && numbers == 0 && texts > 0)
          : texts > 0 && (numbers == 0 || (texts == filled && !is_absolute_number(values)));
  if (is_text) {
    clock_.format_ = TimeFormat::text;
    if (auto problem = decide_order(c)) return problem;
    clock_.counts_ = dated == 0;
    clock_.may_be_local_ = offsets == 0 && !options_.zone;
    clock_.counts_minutes_ = dated == 0 && counts_minutes(head_.names[c]);
    clock_.counts_first_day_ = dated == 0 && is_day_of_year(head_.names[c]);
    if (dated > 0 && offsets == 0) {
      if (auto problem = decide_scale(c)) return problem;
    }
    if (offsets > 0 && offsets < texts && !options_.zone) return some_lack_offsets(c);
    const auto text = read_date_text(first_text, clock_.order_);
    if (text) clock_.description_ = describe_text(first_text, clock_.order_, *text);
    return std::nullopt;
  }
  if (numbers > 0 && texts > 0 && !options_.format) {
    clock_.format_ = TimeFormat::mixed;
    clock_.unit_ns_ =
        options_.unit_ns.value_or(hint_of(head_.names[c], unit(c)).unit_ns.value_or(second_ns));
    clock_.description_ = describe_format(TimeFormat::mixed, second_ns);
    return std::nullopt;
  }
  if (numbers == 0 && filled > 0 && !options_.format) {
    if (auto problem = unknown_zone(c)) return problem;
    if (auto problem = no_year(c)) return problem;
    const auto [cell, line] = first_cell(c);
    return Problem{line,
                   shown(cell) + " in column '" + head_.names[c] +
                       "' is no time; use 2023-04-29T16:22:37.5Z or seconds since 1970-01-01 UTC, "
                       "or say what it is with --time-format, --time-unit or --epoch"};
  }
  return decide_number(c, values, decimals);
}

/// Dates with an offset and others without one.
Problem ClockFinder::some_lack_offsets(std::size_t c) const {
  const auto& cells = head_.columns[c];
  const auto first = std::find_if(cells.begin(), cells.end(), [this](std::string_view cell) {
    const auto text = read_date_text(cell, clock_.order_);
    return text && !text->offset_ns;
  });
  return Problem{head_.lines[static_cast<std::size_t>(first - cells.begin())],
                 fmt::format("{} in column '{}' has no offset, and others have one; say with "
                             "--time-zone of which zone it is, as UTC or Europe/Berlin",
                             shown(*first), head_.names[c])};
}

/// Whether the numbers, as seconds, are of rows that are weeks apart: they count something shorter.
bool ClockFinder::are_weeks_apart(const std::vector<double>& values) const {
  constexpr std::size_t enough = 5;
  constexpr double week_s = 7 * seconds_a_day;
  return values.size() >= enough &&
         std::adjacent_find(values.begin(), values.end(), [](double one, double other) {
           return std::abs(other - one) < week_s;
         }) == values.end();
}

bool ClockFinder::in_window(const std::vector<double>& values, TimeFormat format,
                            std::int64_t unit_ns) const {
  return !values.empty() && std::all_of(values.begin(), values.end(), [&](double value) {
    const double at = seconds_of(value, format, unit_ns);
    return at >= earliest_s && at <= latest_s_;
  });
}

std::optional<std::int64_t> ClockFinder::unit_by_size(const std::vector<double>& values) const {
  for (const std::int64_t unit :
       {std::int64_t{1}, std::int64_t{1000}, std::int64_t{1'000'000}, second_ns})
    if (in_window(values, TimeFormat::unix, unit)) return unit;
  return std::nullopt;
}

bool ClockFinder::is_absolute_number(const std::vector<double>& values) const {
  return unit_by_size(values).has_value();
}

void ClockFinder::take(TimeFormat format, std::int64_t unit_ns, int decimals, double value,
                       std::string_view evidence) {
  clock_.format_ = format;
  clock_.unit_ns_ = unit_ns;
  clock_.counts_ = format == TimeFormat::elapsed;
  clock_.may_be_local_ = format == TimeFormat::excel && !options_.zone;
  clock_.description_ = describe_format(format, unit_ns) + std::string(evidence);
  const bool is_serial = format == TimeFormat::excel || format == TimeFormat::mjd ||
                         format == TimeFormat::jd || format == TimeFormat::matlab;
  if (is_serial)
    clock_.quantum_ns_ = quantum_of(day_ns, std::max(decimals, min_serial_decimals), value);
  else if (unit_ns > second_ns && decimals > 0)
    clock_.quantum_ns_ = quantum_of(unit_ns, decimals, value);
}

/// Where the name says a unit or an epoch that is not known here, which may not pass as seconds.
std::optional<Problem> ClockFinder::unknown_count(std::size_t c, const NameHint& hint,
                                                  const std::vector<double>& values) const {
  if (!hint.since.empty() && !options_.epoch_ns && !options_.format)
    return Problem{
        first_cell(c).second,
        fmt::format(
            "column '{}' counts since {}; say when that is with --epoch, as {}", head_.names[c],
            hint.since,
            hint.since != "J2000" || values.empty()
                ? "2000-01-01T00:00:00Z"
                : fmt::format("{} where it is ET, TDB or TT, or {} where it counts as UTC",
                              epoch_in_utc("TDB", hint, values.front()), time_text(j2000_ns)))};
  if (options_.unit_ns || options_.format) return std::nullopt;
  if (!hint.unknown_unit.empty()) return unknown_unit(c, hint.unknown_unit);
  if (hint.format == TimeFormat::dotnet && !in_window(values, TimeFormat::dotnet, second_ns))
    return unknown_unit(c, "ticks");
  return std::nullopt;
}

Problem ClockFinder::unknown_unit(std::size_t c, std::string_view unit) const {
  return {first_cell(c).second,
          fmt::format("column '{}' counts in '{}', which is no unit that is known here; say what "
                      "that is with --time-unit, as ms or 10ms",
                      head_.names[c], unit)};
}

std::optional<Problem> ClockFinder::decide_number(std::size_t c, const std::vector<double>& values,
                                                  int decimals) {
  NameHint hint = hint_of(head_.names[c], unit(c));
  if (unit_behind_) hint.unit_ns = unit_behind_;
  if (is_day_of_year(head_.names[c]) && options_.epoch_ns && !options_.unit_ns) {
    hint.unit_ns = day_ns;
    clock_.counts_first_day_ = true;
  }
  if (auto problem = refuse_scale_of_numbers(c, hint, values.empty() ? 0 : values.front()))
    return problem;
  if (hint.epoch_ns == gps_epoch_ns && time_scale_of(head_.names[c], unit(c)) == "GPS") {
    hint.epoch_ns.reset();
    hint.format = TimeFormat::gps;
  }
  if (auto problem = unknown_count(c, hint, values)) return problem;
  const std::int64_t unit = options_.unit_ns.value_or(hint.unit_ns.value_or(second_ns));
  const auto by_size = unit_by_size(values);
  const double value = values.empty() ? 0 : values.front();
  if (hint.epoch_ns && !options_.epoch_ns && !options_.format) {
    clock_.epoch_ns_ = hint.epoch_ns;
    take(TimeFormat::elapsed, unit, decimals, value, " by the name");
    return std::nullopt;
  }
  if (options_.format) {
    take(*options_.format,
         *options_.format == TimeFormat::unix && !options_.unit_ns && !hint.unit_ns
             ? by_size.value_or(unit)
             : unit,
         decimals, value, "");
    return std::nullopt;
  }
  if (options_.epoch_ns || options_.unit_ns) {
    take(options_.epoch_ns ? TimeFormat::elapsed : TimeFormat::unix, unit, decimals, value, "");
    if (!options_.epoch_ns && !in_window(values, TimeFormat::unix, unit)) clock_.counts_ = true;
    return std::nullopt;
  }
  if (hint.format && *hint.format != TimeFormat::unix) {
    const bool plausible =
        *hint.format == TimeFormat::elapsed || in_window(values, *hint.format, unit);
    if (plausible) {
      take(*hint.format, unit, decimals, value, " by the name");
      return std::nullopt;
    }
  }
  if (hint.unit_ns) {
    const bool fits = in_window(values, TimeFormat::unix, unit);
    if (!fits && by_size && !(hint.format && *hint.format == TimeFormat::elapsed)) {
      const auto [cell, line] = first_cell(c);
      return Problem{
          line, fmt::format("{} in column '{}' is no time of today in {}, as the name says, but "
                            "is one in {}; say with --time-unit which is right",
                            shown(cell), head_.names[c], unit_name(unit), unit_name(*by_size))};
    }
    take(fits ? TimeFormat::unix : TimeFormat::elapsed, unit, decimals, value, " by the name");
    return std::nullopt;
  }
  if (by_size == second_ns && are_weeks_apart(values) && hint.format != TimeFormat::unix) {
    const auto [cell, line] = first_cell(c);
    return Problem{line, fmt::format("{} and others in column '{}' would be weeks apart as seconds "
                                     "since 1970; say with --time-unit what they count, as us, and "
                                     "with --epoch since when",
                                     shown(cell), head_.names[c])};
  }
  if (by_size) {
    take(TimeFormat::unix, *by_size, decimals, value,
         *by_size == second_ns ? "" : " by their size");
    return std::nullopt;
  }
  for (const TimeFormat format : {TimeFormat::filetime, TimeFormat::dotnet, TimeFormat::jd,
                                  TimeFormat::matlab, TimeFormat::excel, TimeFormat::mjd}) {
    if (!in_window(values, format, second_ns)) continue;
    const bool is_fine = decimals >= min_serial_decimals &&
                         (options_.column || is_named_like_a_time(head_.names[c]));
    if (format != TimeFormat::filetime && format != TimeFormat::dotnet &&
        format != TimeFormat::jd && !is_fine)
      continue;
    take(format, second_ns, decimals, value, " by their size");
    return std::nullopt;
  }
  take(hint.format == TimeFormat::unix ? TimeFormat::unix : TimeFormat::elapsed, second_ns,
       decimals, value, "");
  return std::nullopt;
}

std::variant<Clock, Problem> Clock::find(const HeadCells& head, const TimeOptions& options,
                                         std::int64_t latest_ns) {
  return ClockFinder(head, options, latest_ns).run();
}

}  // namespace reident::telemetry_file
