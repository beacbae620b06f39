#include <algorithm>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/telemetry_file/clock_finder.hpp"
#include "service/telemetry_file/clock_words.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

using Problem = Clock::Problem;

bool is_digits(std::string_view cell) {
  return !cell.empty() && cell.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Whether a cell is a date that a time of day may stand behind.
bool is_date_alone(std::string_view cell, DateOrder order) {
  const auto date = read_date_text(cell, order);
  const auto both = read_date_text(std::string(cell) + " 01:00", order);
  return date && date->has_date && both && both->clock_ns == date->clock_ns + hour_ns;
}

bool has_clock(std::string_view cell) {
  return cell.find(':') != std::string_view::npos;
}

/// Whether a cell is a time of day; digits alone are one where the name says so.
bool is_clock_alone(std::string_view cell, bool is_named_so, DateOrder order) {
  if (is_digits(cell)) return is_named_so && cell.size() <= 6;
  const auto clock = read_date_text(cell, order);
  return clock && !clock->has_date && clock->clock_ns <= day_ns;
}

}  // namespace

std::optional<std::size_t> ClockFinder::column(std::string_view name) const {
  const auto found = std::find(head_.names.begin(), head_.names.end(), name);
  return found == head_.names.end()
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - head_.names.begin()));
}

std::optional<std::size_t> ClockFinder::part(TimePart part) const {
  for (std::size_t c = 0; c < head_.names.size(); ++c)
    if (part_of(head_.names[c]) == part) return c;
  if (part != TimePart::minute) return std::nullopt;
  for (std::size_t c = 1; c < head_.names.size(); ++c)  // HH, mm: what is a month elsewhere
    if (part_of(head_.names[c]) == TimePart::month && part_of(head_.names[c - 1]) == TimePart::hour)
      return c;
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

/// Adds the columns of a time of day; returns the unit of each, 0 for a text.
std::vector<std::int64_t> ClockFinder::add_time_of_day(std::vector<std::size_t>& columns) {
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
  if (of_day && units.back() == 0) {
    count_clock_digits(columns.back());
    if (clock_.clock_digits_ == 4) add(TimePart::second, second_ns);  // 2200, 30
  }
  if (!of_day && add(TimePart::hour, hour_ns)) {
    if (add(TimePart::minute, minute_ns)) add(TimePart::second, second_ns);
  } else if (!of_day) {
    add(TimePart::second, second_ns);
  }
  return units;
}

/// A date, and hours, minutes and seconds.
bool ClockFinder::find_date_and_parts() {
  const auto date = part(TimePart::date);
  if (!date || !part(TimePart::hour) || !is_date_alone(first_cell(*date).first, clock_.order_))
    return false;
  std::vector<std::size_t> columns = {*date};
  auto units = add_time_of_day(columns);
  return set_parts(Clock::Parts::dated, std::move(columns), std::move(units));
}

/// Year with month and day, or day of the year, and the time of day.
bool ClockFinder::find_calendar() {
  const auto year = part(TimePart::year), month = part(TimePart::month), day = part(TimePart::day);
  auto of_year = part(TimePart::day_of_year);
  if (year && !of_year && day && !month && (is_asked_ || counts_days_of_year(*day))) of_year = day;
  if (!year || (!of_year && (!month || !day))) return false;
  std::vector<std::size_t> columns =
      of_year ? std::vector{*year, *of_year} : std::vector{*year, *month, *day};
  auto units = add_time_of_day(columns);
  return set_parts(of_year ? Clock::Parts::day_of_year : Clock::Parts::calendar, std::move(columns),
                   std::move(units));
}

/// A column named day holds days of the year where one of them is behind the 31st, or has three
/// digits.
bool ClockFinder::counts_days_of_year(std::size_t c) const {
  return std::any_of(head_.columns[c].begin(), head_.columns[c].end(), [](std::string_view cell) {
    const auto day = plain_number(cell);
    return day && (*day >= 32 || trimmed(cell).substr(0, trimmed(cell).find('.')).size() >= 3);
  });
}

/// A column beside the dates whose cells are all zones, as MEZ and MESZ, or offsets by its name.
bool ClockFinder::find_zone_column() {
  for (std::size_t c = 0; c < head_.names.size(); ++c) {
    const auto& cells = head_.columns[c];
    if (clock_.uses(c) || cells.empty()) continue;
    const std::string_view first = trimmed(cells.front());
    const bool is_one = std::all_of(cells.begin(), cells.end(),
                                    [&](std::string_view cell) { return trimmed(cell) == first; });
    if (is_one && first.find('/') != std::string_view::npos)
      clock_.zone_ = TimeZone::named(std::string(first));
    if (clock_.zone_) {
      clock_.local_by_.clear();
      clock_.may_be_local_ = false;
      clock_.description_ += ", " + std::string(first);
      return true;
    }
    const bool is_named = is_named_like_a_zone(head_.names[c]);
    const auto is_zone = [&](std::string_view raw) {
      const std::string_view cell = trimmed(raw);
      const bool is_word = cell.size() >= 3 && cell[0] >= 'A' && cell[0] <= 'Z';
      return !cell.empty() && (is_named || is_word) && read_offset(cell).has_value();
    };
    if (!std::all_of(cells.begin(), cells.end(), is_zone)) {
      if (is_named && !trimmed(first_cell(c).first).empty())
        clock_.local_by_ = "column '" + head_.names[c] + "'";
      continue;
    }
    clock_.local_by_.clear();
    clock_.zone_column_ = c;
    clock_.may_be_local_ = false;
    clock_.description_ += ", zones in column " + head_.names[c];
    return true;
  }
  return false;
}

/// A column called sec, fraction or the like whose cells are all parts of a second, as 0.250.
bool ClockFinder::is_part_of_second(std::size_t c) const {
  const auto& cells = head_.columns[c];
  const bool has_point = std::any_of(cells.begin(), cells.end(), [](std::string_view cell) {
    return cell.find('.') != std::string_view::npos;
  });
  return is_named_like_a_part_of_second(head_.names[c]) && has_point &&
         std::all_of(cells.begin(), cells.end(), [](std::string_view cell) {
           const auto value = plain_number(trimmed(cell));
           return value && *value >= 0 && *value < 1;
         });
}

/// A column of milliseconds or the like right behind times of whole seconds.
void ClockFinder::find_fraction_column() {
  const std::size_t last = *std::max_element(clock_.columns_.begin(), clock_.columns_.end());
  const std::size_t c = last + 1;
  if (c >= head_.names.size() || clock_.parts_ == Clock::Parts::gps_week) return;
  const auto unit = is_part_of_second(c) ? std::optional(second_ns)
                                         : fraction_of_second(head_.names[c], head_.names[last]);
  if (!unit) return;
  const auto is_whole = [](std::string_view cell) {
    const auto clock = cell.rfind(':');
    return cell.substr(clock == std::string_view::npos ? 0 : clock).find_first_of(".,") ==
           std::string_view::npos;
  };
  const auto fits = [&](std::string_view cell) {
    const auto value = plain_number(trimmed(cell));
    return (is_digits(trimmed(cell)) || *unit == second_ns) && value &&
           *value * static_cast<double>(*unit) < 1e9;
  };
  const auto& cells = head_.columns[c];
  if (cells.empty() ||
      !std::all_of(head_.columns[last].begin(), head_.columns[last].end(), is_whole) ||
      !std::all_of(cells.begin(), cells.end(), fits))
    return;
  clock_.fraction_column_ = c;
  clock_.fraction_unit_ns_ = *unit;
  clock_.description_ += ", parts of a second in column " + head_.names[c];
}

/// Digits are seconds of the day where one of them is no time of day as 093000.
bool ClockFinder::counts_seconds(std::size_t c) const {
  bool any = false;
  for (const std::string_view raw : head_.columns[c]) {
    const auto value = plain_number(trimmed(raw));
    if (!value) continue;
    if (*value < 0 || *value > 86'400) return false;
    const auto whole = static_cast<std::int64_t>(*value);
    any = any || whole % 100 > 59 || whole / 100 % 100 > 59;
  }
  return any;
}

/// A date and a time of day side by side.
bool ClockFinder::find_date_and_clock() {
  const auto date = part(TimePart::date);
  if (!date) return false;
  auto clock = clock_beside(*date);
  if (!clock && is_date_alone(first_cell(*date).first, clock_.order_))
    clock = part(TimePart::second_of_day);
  return join(*date, clock);
}

/// The time of day that belongs to a column of dates alone.
std::optional<std::size_t> ClockFinder::clock_beside(std::size_t date) const {
  const auto cell = first_cell(date).first;
  if (!is_date_alone(cell, clock_.order_) && !are_midnights(date)) return std::nullopt;
  if (is_digits(cell) && part_of(head_.names[date]) != TimePart::date) return std::nullopt;
  for (std::size_t c = 0; c < head_.names.size(); ++c)
    if (c != date && is_clock_alone(first_cell(c).first, part_of(head_.names[c]) == TimePart::clock,
                                    clock_.order_))
      return c;
  return std::nullopt;
}

void ClockFinder::count_clock_digits(std::size_t c) {
  clock_.clock_digits_ = 0;
  for (const std::string_view cell : head_.columns[c])
    if (is_digits(trimmed(cell)))
      clock_.clock_digits_ = std::max(clock_.clock_digits_, trimmed(cell).size() > 4 ? 6UL : 4UL);
}

/// Whether the dates of a column have a clock, which shows midnight in all rows.
bool ClockFinder::are_midnights(std::size_t c) const {
  const auto& cells = head_.columns[c];
  return has_clock(first_cell(c).first) &&
         std::all_of(cells.begin(), cells.end(), [&](std::string_view cell) {
           const auto date = read_date_text(cell, clock_.order_);
           return trimmed(cell).empty() ||
                  (date && date->has_date && !date->offset_ns && date->clock_ns % day_ns == 0);
         });
}

bool ClockFinder::join(std::size_t date, std::optional<std::size_t> clock) {
  if (!clock) return false;
  const TimePart what = part_of(head_.names[*clock]);
  if (what == TimePart::second_of_day || what == TimePart::millisecond_of_day ||
      counts_seconds(*clock))
    return set_parts(Clock::Parts::joined, {date, *clock},
                     {what == TimePart::millisecond_of_day ? second_ns / 1000 : second_ns});
  count_clock_digits(*clock);
  clock_.adds_clock_ = has_clock(first_cell(date).first);
  return set_parts(Clock::Parts::joined, {date, *clock}, {});
}

bool ClockFinder::find_gps_week() {
  const auto week = part(TimePart::gps_week);
  auto second = part(TimePart::week_second);
  if (week && !second && part(TimePart::second) == *week + 1) second = *week + 1;
  if (!week || !second || !plain_number(first_cell(*week).first)) return false;
  clock_.unit_ns_ = options_.unit_ns.value_or(
      hint_of(head_.names[*second], unit(*second)).unit_ns.value_or(second_ns));
  return set_parts(Clock::Parts::gps_week, {*week, *second}, {});
}

/// Days since an epoch and milliseconds of the day, as CCSDS day-segmented times.
bool ClockFinder::find_day_count() {
  auto day = part(TimePart::day);
  for (std::size_t c = 0; c < head_.names.size() && !day; ++c) {
    const NameHint hint = hint_of(head_.names[c], unit(c));  // days since 1958-01-01
    if (hint.unit_ns == day_ns && hint.epoch_ns) day = c;
  }
  auto of_day = part(TimePart::millisecond_of_day);
  if (!of_day) of_day = part(TimePart::second_of_day);
  if (!day || !of_day || part(TimePart::year)) return false;
  constexpr double most_of_year = 366;
  const auto first = plain_number(first_cell(*day).first);
  return first && *first > most_of_year && set_day_count(*day, *of_day);
}

bool ClockFinder::set_day_count(std::size_t day, std::size_t of_day) {
  constexpr std::size_t most_digits = 5;  // more are a date
  if (!is_digits(first_cell(day).first) || first_cell(day).first.size() > most_digits) return false;
  const TimePart what = part_of(head_.names[of_day]);
  auto unit_ns = hint_of(head_.names[of_day], unit(of_day)).unit_ns.value_or(second_ns);
  if (what == TimePart::millisecond_of_day) unit_ns = second_ns / 1000;
  if (!clock_.epoch_ns_) clock_.epoch_ns_ = hint_of(head_.names[day], unit(day)).epoch_ns;
  clock_.counts_ = true;
  clock_.unit_ns_ = unit_ns;
  return set_parts(Clock::Parts::day_count, {day, of_day}, {unit_ns});
}

bool ClockFinder::find_set() {
  return find_calendar() || find_date_and_clock() || find_date_and_parts() || find_gps_week() ||
         find_day_count();
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
  for (const bool may_be_local : {false, true})
    for (std::size_t c = 0; c < head_.names.size(); ++c) {
      const auto zone = zone_hint_of(head_.names[c], unit(c));
      if ((may_be_local || !zone || !zone->is_local) && is_named_like_a_time(head_.names[c]) &&
          holds_time(c))
        return choose({c});
    }
  for (std::size_t c = 0; c < head_.names.size(); ++c)
    if (!read_number(first_cell(c).first, head_.style) &&
        read_date_text(first_cell(c).first, clock_.order_))
      return choose({c});
  if (find_seconds_and_parts()) return std::nullopt;
  for (std::size_t c = 0; c < head_.names.size(); ++c)
    if (auto problem = unknown_zone(c)) return problem;
  for (std::size_t c = 0; c < head_.names.size(); ++c)
    if (auto problem = no_year(c)) return problem;
  // Below the first name stands the unit of a time.
  if (!head_.names.empty() && hint_of({}, unit(0)).unit_ns && holds_time(0)) return choose({0});
  return Problem{head_.lines.empty() ? 0 : head_.lines.front(),
                 "no column looks like a time; name it with --time, or the line of the header "
                 "with --header (the columns are: " +
                     joined(head_.names) + ")"};
}

/// Seconds since 1970, and parts of a second behind them, as sec and nanosec.
bool ClockFinder::find_seconds_and_parts() {
  for (std::size_t c = 0; c + 1 < head_.names.size(); ++c) {
    const auto seconds = plain_number(first_cell(c).first);
    if (!seconds || !is_absolute_number({*seconds}) ||
        !fraction_of_second(head_.names[c + 1], head_.names[c]))
      continue;
    clock_.columns_ = {c};
    return true;
  }
  return false;
}

/// Dates that a word stands behind, and no zone that is known.
std::optional<Problem> ClockFinder::unknown_zone(std::size_t c) const {
  const auto [cell, line] = first_cell(c);
  const auto blank = cell.rfind(' ');
  if (blank == std::string_view::npos) return std::nullopt;
  const std::string_view word = cell.substr(blank + 1);
  const auto is_capital = [](char letter) { return letter >= 'A' && letter <= 'Z'; };
  if (word.size() < 2 || !std::all_of(word.begin(), word.end(), is_capital)) return std::nullopt;
  const auto date = read_date_text(cell.substr(0, blank), clock_.order_);
  if (!date || !date->has_date) return std::nullopt;
  return Problem{line,
                 fmt::format("'{}' in column '{}' is in a zone, {}, that is not known here or "
                             "stands for several; write the offset in its place, as +05:30",
                             cell, head_.names[c], word)};
}

/// Dates as syslog writes them.
std::optional<Problem> ClockFinder::no_year(std::size_t c) const {
  const auto [cell, line] = first_cell(c);
  const std::string mended = with_missing_year(cell);
  if (mended.empty()) return std::nullopt;
  return Problem{line, fmt::format("{} in column '{}' has no year; write it into each, as in {}",
                                   shown(cell), head_.names[c], shown(mended))};
}

std::optional<Problem> ClockFinder::choose(std::vector<std::size_t> columns) {
  const std::size_t first = columns.front();
  clock_.columns_ = std::move(columns);
  if (!options_.format || options_.format == TimeFormat::gps) join(first, clock_beside(first));
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
  is_asked_ = true;
  if (find_set() && clock_.columns_.size() == columns.size() &&
      std::is_permutation(columns.begin(), columns.end(), clock_.columns_.begin()))
    return std::nullopt;
  if (columns.size() == 2) {
    if (!set_day_count(columns[0], columns[1])) join(columns[0], columns[1]);
    return std::nullopt;
  }
  return Problem{
      0, "--time " + asked +
             " are no columns of one time: a date and a time of day; year, month and day, or year "
             "and doy, with hour, minute and second or sec_of_day; week and tow"};
}

}  // namespace reident::telemetry_file
