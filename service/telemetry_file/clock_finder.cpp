#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/clock.hpp"
#include "service/telemetry_file/clock_names.hpp"
#include "service/telemetry_file/clock_words.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

constexpr double seconds_a_day = 86'400;
constexpr double earliest_s = 631'152'000;  // 1990
constexpr double min_serial_decimals = 4;

using Problem = Clock::Problem;

std::string shown(std::string_view cell) {
  return "'" + std::string(cell.substr(0, 40)) + "'";
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

}  // namespace

/// Looks at the columns of a head.
class ClockFinder {
 public:
  ClockFinder(const HeadCells& head, const TimeOptions& options, std::int64_t latest_ns)
      : head_(head), options_(options), latest_s_(static_cast<double>(latest_ns) * 1e-9) {}

  std::variant<Clock, Problem> run();

 private:
  std::optional<std::size_t> column(std::string_view name) const;
  std::optional<std::size_t> part(TimePart part) const;
  std::pair<std::string_view, std::uint64_t> first_cell(std::size_t c) const;
  bool set_parts(Clock::Parts parts, std::vector<std::size_t> columns,
                 std::vector<std::int64_t> units);
  bool find_calendar();
  bool find_date_and_clock();
  bool find_gps_week();
  bool find_set();
  std::string_view unit(std::size_t c) const;
  bool holds_time(std::size_t c) const;
  std::optional<Problem> choose_columns();
  std::optional<Problem> choose(std::vector<std::size_t> columns);
  std::optional<Problem> choose_named(const std::string& asked);
  std::optional<Problem> decide_parts();
  std::optional<Problem> decide_order(std::size_t c);
  std::optional<Problem> decide_one(std::size_t c);
  bool in_window(const std::vector<double>& values, TimeFormat format, std::int64_t unit_ns) const;
  std::optional<std::int64_t> unit_by_size(const std::vector<double>& values) const;
  bool is_absolute_number(const std::vector<double>& values) const;
  void take(TimeFormat format, std::int64_t unit_ns, int decimals, std::string_view evidence);
  std::optional<Problem> decide_number(std::size_t c, const std::vector<double>& values,
                                       int decimals);

  const HeadCells& head_;
  const TimeOptions& options_;
  const double latest_s_;
  Clock clock_;
};

std::variant<Clock, Problem> ClockFinder::run() {
  if (options_.zone) {
    clock_.zone_ = TimeZone::named(*options_.zone);
    if (!clock_.zone_)
      return Problem{0, "--time-zone " + *options_.zone +
                            " is not known here; name it as Europe/Berlin or UTC"};
  }
  clock_.epoch_ns_ = options_.epoch_ns.value_or(0);
  clock_.has_decimal_comma_ = head_.style.decimal == ',';
  if (options_.order) clock_.order_ = *options_.order;
  if (auto problem = choose_columns()) return *std::move(problem);
  if (auto problem =
          clock_.parts_ == Clock::Parts::one ? decide_one(clock_.columns_.front()) : decide_parts())
    return *std::move(problem);
  if (clock_.zone_) clock_.description_ += ", " + *options_.zone;
  return std::move(clock_);
}

std::optional<std::size_t> ClockFinder::column(std::string_view name) const {
  const auto found = std::find(head_.names.begin(), head_.names.end(), name);
  return found == head_.names.end()
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - head_.names.begin()));
}

std::optional<std::size_t> ClockFinder::part(TimePart part) const {
  for (std::size_t c = 0; c < head_.names.size(); ++c)
    if (part_of(head_.names[c]) == part) return c;
  return std::nullopt;
}

/// The first cell of a column that holds something, and its line.
std::pair<std::string_view, std::uint64_t> ClockFinder::first_cell(std::size_t c) const {
  for (std::size_t row = 0; row < head_.columns[c].size(); ++row)
    if (!trimmed(head_.columns[c][row]).empty())
      return {trimmed(head_.columns[c][row]), head_.lines[row]};
  return {{}, head_.lines.empty() ? 0 : head_.lines.front()};
}

bool ClockFinder::set_parts(Clock::Parts parts, std::vector<std::size_t> columns,
                            std::vector<std::int64_t> units) {
  clock_.parts_ = parts;
  clock_.columns_ = std::move(columns);
  clock_.part_unit_ns_ = std::move(units);
  return true;
}

/// Year with month and day, or day of the year, and the time of day.
bool ClockFinder::find_calendar() {
  const auto year = part(TimePart::year), month = part(TimePart::month), day = part(TimePart::day);
  auto of_year = part(TimePart::day_of_year);
  if (year && !of_year && day && !month) of_year = day;
  if (!year || (!of_year && (!month || !day))) return false;
  std::vector<std::size_t> columns =
      of_year ? std::vector{*year, *of_year} : std::vector{*year, *month, *day};
  std::vector<std::int64_t> units;
  const auto add = [&](TimePart wanted, std::int64_t unit) {
    const auto at = part(wanted);
    if (!at || std::find(columns.begin(), columns.end(), *at) != columns.end()) return false;
    columns.push_back(*at);
    units.push_back(unit);
    return true;
  };
  const bool of_day = add(TimePart::second_of_day, second_ns) ||
                      add(TimePart::millisecond_of_day, 1'000'000) || add(TimePart::clock, 0);
  if (!of_day && add(TimePart::hour, 3600 * second_ns) && add(TimePart::minute, 60 * second_ns))
    add(TimePart::second, second_ns);
  else if (!of_day)
    add(TimePart::second, second_ns);
  return set_parts(of_year ? Clock::Parts::day_of_year : Clock::Parts::calendar, std::move(columns),
                   std::move(units));
}

/// A date and a time of day side by side.
bool ClockFinder::find_date_and_clock() {
  const auto date = part(TimePart::date), clock = part(TimePart::clock);
  if (!date || !clock) return false;
  const auto day = read_date_text(first_cell(*date).first, clock_.order_);
  const auto of_day = read_date_text(first_cell(*clock).first, clock_.order_);
  if (!day || !day->has_date || !of_day || of_day->has_date) return false;
  return set_parts(Clock::Parts::joined, {*date, *clock}, {});
}

bool ClockFinder::find_gps_week() {
  const auto week = part(TimePart::gps_week), second = part(TimePart::week_second);
  if (!week || !second || !plain_number(first_cell(*week).first)) return false;
  clock_.unit_ns_ = options_.unit_ns.value_or(
      hint_of(head_.names[*second], unit(*second)).unit_ns.value_or(second_ns));
  return set_parts(Clock::Parts::gps_week, {*week, *second}, {});
}

bool ClockFinder::find_set() {
  return find_calendar() || find_date_and_clock() || find_gps_week();
}

std::string_view ClockFinder::unit(std::size_t c) const {
  return head_.units.empty() ? std::string_view() : head_.units[c];
}

bool ClockFinder::holds_time(std::size_t c) const {
  const auto cell = first_cell(c).first;
  return read_number(cell, head_.style).has_value() ||
         read_date_text(cell, clock_.order_).has_value();
}

std::optional<Problem> ClockFinder::choose_columns() {
  if (options_.column) return choose_named(*options_.column);
  if (find_set()) return std::nullopt;
  for (std::size_t c = 0; c < head_.names.size(); ++c)
    if (is_named_like_a_time(head_.names[c]) && holds_time(c)) return choose({c});
  for (std::size_t c = 0; c < head_.names.size(); ++c)
    if (!read_number(first_cell(c).first, head_.style) &&
        read_date_text(first_cell(c).first, clock_.order_))
      return choose({c});
  return Problem{head_.lines.empty() ? 0 : head_.lines.front(),
                 "no column looks like a time; name it with --time (the columns are: " +
                     joined(head_.names) + ")"};
}

std::optional<Problem> ClockFinder::choose(std::vector<std::size_t> columns) {
  clock_.columns_ = std::move(columns);
  return std::nullopt;
}

std::optional<Problem> ClockFinder::choose_named(const std::string& asked) {
  const auto no_column = [&](const std::string& name) {
    std::string text = "there is no column '" + name + "'; ";
    if (find_set()) {
      text += "the time is in the columns ";
      std::string all;
      for (const std::size_t c : clock_.columns_) all += (all.empty() ? "" : ",") + head_.names[c];
      text += all + ": --time " + all + "; ";
    }
    return Problem{0, text + "the columns are: " + joined(head_.names)};
  };
  if (const auto one = column(asked)) {
    const auto cell = first_cell(*one).first;
    const auto text = read_date_text(cell, clock_.order_);
    const bool is_part =
        part_of(asked) != TimePart::none && !options_.format && (text ? cell.size() <= 12 : true);
    if (is_part && find_set() &&
        std::find(clock_.columns_.begin(), clock_.columns_.end(), *one) != clock_.columns_.end())
      return std::nullopt;
    clock_.parts_ = Clock::Parts::one;
    return choose({*one});
  }
  std::vector<std::size_t> columns;
  for (std::size_t at = 0; at <= asked.size();) {
    const std::size_t end = std::min(asked.find(',', at), asked.size());
    const std::string name(trimmed(std::string_view(asked).substr(at, end - at)));
    const auto found = column(name);
    if (!found) return no_column(name);
    columns.push_back(*found);
    at = end + 1;
  }
  if (columns.size() == 1) return choose(std::move(columns));
  if (find_set() && clock_.columns_.size() == columns.size() &&
      std::is_permutation(columns.begin(), columns.end(), clock_.columns_.begin()))
    return std::nullopt;
  if (columns.size() == 2) {
    set_parts(Clock::Parts::joined, std::move(columns), {});
    return std::nullopt;
  }
  return Problem{
      0, "--time " + asked +
             " are no columns of one time: a date and a time of day; year, month and day, or year "
             "and doy, with hour, minute and second or sec_of_day; week and tow"};
}

std::optional<Problem> ClockFinder::decide_parts() {
  clock_.may_be_local_ = clock_.parts_ != Clock::Parts::gps_week && !clock_.zone_;
  switch (clock_.parts_) {
    case Clock::Parts::joined:
      clock_.description_ = "a date and a time of day";
      break;
    case Clock::Parts::calendar:
      clock_.description_ = "year, month, day";
      break;
    case Clock::Parts::day_of_year:
      clock_.description_ = "year, day of year";
      break;
    default:
      clock_.description_ = "GPS week and " + unit_name(clock_.unit_ns_);
      break;
  }
  if (clock_.parts_ == Clock::Parts::joined) return decide_order(clock_.columns_.front());
  return std::nullopt;
}

/// Whether 03/04/2024 is in April or in March.
std::optional<Problem> ClockFinder::decide_order(std::size_t c) {
  if (options_.order) return std::nullopt;
  bool day_first = false, month_first = false;
  std::string_view ambiguous;
  std::uint64_t line = 0;
  std::int64_t span[2] = {0, 0}, before[2] = {0, 0};
  bool any = false;
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
    const std::int64_t times[2] = {one->clock_ns, other->clock_ns};
    for (int i = 0; i < 2; ++i) {
      if (any) span[i] += std::abs(times[i] / second_ns - before[i] / second_ns);
      before[i] = times[i];
    }
    any = true;
  }
  if (day_first != month_first) {
    clock_.order_ = day_first ? DateOrder::day_first : DateOrder::month_first;
    return std::nullopt;
  }
  if (ambiguous.empty()) return std::nullopt;
  if (span[0] * 5 < span[1] || span[1] * 5 < span[0]) {
    clock_.order_ = span[0] < span[1] ? DateOrder::day_first : DateOrder::month_first;
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
    if (number && number->suffix.empty() && std::isfinite(number->value)) {
      ++numbers;
      values.push_back(number->value);
      const auto point = cell.find(head_.style.decimal);
      if (point != std::string_view::npos)
        decimals = std::max(decimals, static_cast<int>(cell.size() - point) - 1);
    }
    if (!text) continue;
    ++texts;
    if (first_text.empty()) first_text = cell;
    offsets += text->offset_ns ? 1U : 0U;
    dated += text->has_date ? 1U : 0U;
  }
  const bool is_text =
      options_.format
          ? *options_.format == TimeFormat::text
          : texts > 0 && (numbers == 0 || (texts == filled && !is_absolute_number(values)));
  if (is_text) {
    clock_.format_ = TimeFormat::text;
    if (auto problem = decide_order(c)) return problem;
    clock_.is_absolute_ = dated > 0 || options_.epoch_ns.has_value();
    clock_.may_be_local_ = offsets == 0 && !clock_.zone_;
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
    const auto [cell, line] = first_cell(c);
    return Problem{line,
                   shown(cell) + " in column '" + head_.names[c] +
                       "' is no time; use 2023-04-29T16:22:37.5Z or seconds since 1970-01-01 UTC, "
                       "or say what it is with --time-format, --time-unit or --epoch"};
  }
  return decide_number(c, values, decimals);
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

void ClockFinder::take(TimeFormat format, std::int64_t unit_ns, int decimals,
                       std::string_view evidence) {
  clock_.format_ = format;
  clock_.unit_ns_ = unit_ns;
  clock_.is_absolute_ = format != TimeFormat::elapsed || options_.epoch_ns.has_value();
  clock_.description_ = describe_format(format, unit_ns) + std::string(evidence);
  const bool is_serial = format == TimeFormat::excel || format == TimeFormat::mjd ||
                         format == TimeFormat::jd || format == TimeFormat::matlab;
  // So many decimals of a day are exact to half of this.
  for (int d = std::max(decimals, 4); is_serial && d < 14; ++d) {
    if (clock_.quantum_ns_ == 1)
      clock_.quantum_ns_ = 10;
    else
      clock_.quantum_ns_ *= 10;
  }
}

std::optional<Problem> ClockFinder::decide_number(std::size_t c, const std::vector<double>& values,
                                                  int decimals) {
  const NameHint hint = hint_of(head_.names[c], unit(c));
  const std::int64_t unit = options_.unit_ns.value_or(hint.unit_ns.value_or(second_ns));
  const auto by_size = unit_by_size(values);
  if (options_.format) {
    take(*options_.format,
         *options_.format == TimeFormat::unix && !options_.unit_ns && !hint.unit_ns
             ? by_size.value_or(unit)
             : unit,
         decimals, "");
    return std::nullopt;
  }
  if (options_.epoch_ns || options_.unit_ns) {
    take(options_.epoch_ns ? TimeFormat::elapsed : TimeFormat::unix, unit, decimals, "");
    if (!options_.epoch_ns && !in_window(values, TimeFormat::unix, unit))
      clock_.is_absolute_ = false;
    return std::nullopt;
  }
  if (hint.format && *hint.format != TimeFormat::unix) {
    const bool plausible =
        *hint.format == TimeFormat::elapsed || in_window(values, *hint.format, unit);
    if (plausible) {
      take(*hint.format, unit, decimals, " by the name");
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
    take(fits ? TimeFormat::unix : TimeFormat::elapsed, unit, decimals, " by the name");
    return std::nullopt;
  }
  if (by_size) {
    take(TimeFormat::unix, *by_size, decimals, *by_size == second_ns ? "" : " by their size");
    return std::nullopt;
  }
  for (const TimeFormat format : {TimeFormat::filetime, TimeFormat::jd, TimeFormat::matlab,
                                  TimeFormat::excel, TimeFormat::mjd}) {
    if (!in_window(values, format, second_ns)) continue;
    const bool is_fine = decimals >= min_serial_decimals && is_named_like_a_time(head_.names[c]);
    if (format != TimeFormat::filetime && format != TimeFormat::jd && !is_fine) continue;
    take(format, second_ns, decimals, " by their size");
    return std::nullopt;
  }
  take(hint.format == TimeFormat::unix ? TimeFormat::unix : TimeFormat::elapsed, second_ns,
       decimals, "");
  return std::nullopt;
}

std::variant<Clock, Problem> Clock::find(const HeadCells& head, const TimeOptions& options,
                                         std::int64_t latest_ns) {
  return ClockFinder(head, options, latest_ns).run();
}

}  // namespace reident::telemetry_file
