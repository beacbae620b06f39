#include "service/telemetry_file/clock_watch.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "service/support/floor_divide.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

struct Wrap {
  double counts;  // of the clock's unit
  std::string_view text;
};
constexpr std::array<Wrap, 8> wraps = {{{65'536, "65,536"},
                                        {16'777'216, "2^24"},
                                        {2'147'483'648, "2^31"},
                                        {4'294'967'296, "2^32"},
                                        {1024 * 604'800.0, "1024 weeks"},
                                        {604'800, "a week of seconds"},
                                        {604'800'000, "a week of milliseconds"},
                                        {86'400, "a day of seconds"}}};

}  // namespace

std::optional<ClockStep> ClockWatch::next(std::int64_t time_ns, std::uint64_t line) {
  // With the newest first, it goes on in a mirror as other clocks do.
  if (is_newest_first_ && __builtin_sub_overflow(-1, time_ns, &time_ns)) return std::nullopt;
  std::optional<ClockStep> step;
  if (last_ns_ && (time_ns < *last_ns_ || repeats_an_hour(time_ns)))
    step = explained(time_ns, line);
  if (last_ns_ && time_ns > *last_ns_) {
    if (hour_ahead_line_ == 0 && begins_daylight_saving(time_ns)) hour_ahead_line_ = line;
    if (__builtin_sub_overflow(time_ns, *last_ns_, &usual_ns_)) usual_ns_ = 0;
  }
  last_ns_ = time_ns;
  if (is_newest_first_ && step && step->kind != ClockStep::Kind::hour) step.reset();
  return step;
}

/// Whether hourly telemetry has one time twice where daylight saving ends: in the night of a
/// Sunday.
bool ClockWatch::repeats_an_hour(std::int64_t time_ns) const {
  constexpr std::int64_t sunday = 3;  // days since 1970-01-01
  const std::int64_t days = floor_divide(time_ns, day_ns);
  return may_be_local_ && !is_newest_first_ && !since_ns_ && time_ns == *last_ns_ &&
         usual_ns_ == hour_ns && ((days % 7) + 7) % 7 == sunday &&
         time_ns - days * day_ns < 4 * hour_ns;
}

bool ClockWatch::begins_daylight_saving(std::int64_t time_ns) const {
  if (!may_be_local_ || is_newest_first_ || since_ns_ || usual_ns_ == 0 || usual_ns_ > hour_ns)
    return false;
  std::int64_t expected_ns = 0;
  if (__builtin_add_overflow(*last_ns_, usual_ns_, &expected_ns)) return false;
  const std::int64_t of_day_ns = ((expected_ns % day_ns) + day_ns) % day_ns;
  return of_day_ns < 4 * hour_ns && of_day_ns % hour_ns <= usual_ns_ &&
         std::abs(static_cast<double>(time_ns) - static_cast<double>(expected_ns) -
                  static_cast<double>(hour_ns)) <=
             static_cast<double>(std::max(second_ns, usual_ns_ / 2));
}

ClockStep ClockWatch::explained(std::int64_t time_ns, std::uint64_t line) const {
  ClockStep step;
  step.line = line;
  if (__builtin_sub_overflow(*last_ns_, time_ns, &step.back_ns)) return step;
  // What the clock would have shown if it had gone on as before.
  const auto usual_ns = static_cast<double>(usual_ns_);
  const double lost_ns = static_cast<double>(step.back_ns) + usual_ns;
  const double tolerance_ns = std::max(static_cast<double>(second_ns), 2 * usual_ns);
  const auto by_about = [&](double ns) { return std::abs(lost_ns - ns) <= tolerance_ns; };
  const std::string back = duration_text(step.back_ns);
  const auto hour_of_day = [](std::int64_t ns) {
    return (ns - floor_divide(ns, day_ns) * day_ns) / hour_ns;
  };
  if (hour_of_day(*last_ns_) == 12 && hour_of_day(time_ns) == 1 &&
      by_about(static_cast<double>(12 * hour_ns))) {
    step.kind = ClockStep::Kind::half_day;
    step.what = fmt::format(
        "the clock goes back {}, twelve hours less a step: a clock of twelve hours, without AM "
        "and PM",
        back);
    return step;
  }
  if (may_be_local_ && by_about(static_cast<double>(hour_ns))) {
    step.kind = ClockStep::Kind::hour;
    step.missing_ns = hour_ns;
    step.what = step.back_ns == 0
                    ? "the clock shows an hour twice: a local time at the end of daylight saving"
                    : fmt::format(
                          "the clock goes back {}, an hour less a step: a local time at the end of "
                          "daylight saving",
                          back);
    return step;
  }
  for (const Wrap& wrap : wraps) {
    const double ns = wrap.counts * static_cast<double>(unit_ns_);
    if (!since_ns_ || ns > 9e18 || !by_about(ns) || ns < 4 * usual_ns) continue;
    step.kind = ClockStep::Kind::wrap;
    step.missing_ns = static_cast<std::int64_t>(ns);
    step.what = fmt::format("the clock goes back {}: a counter that wraps at {}", back, wrap.text);
    return step;
  }
  if (since_ns_ &&
      std::abs(static_cast<double>(time_ns) - static_cast<double>(*since_ns_)) <= tolerance_ns) {
    step.kind = ClockStep::Kind::restart;
    step.what =
        fmt::format("the clock goes back {} to zero: whatever counts was started again", back);
    return step;
  }
  step.what = fmt::format("the clock goes back {}", back);
  return step;
}

}  // namespace reident::telemetry_file
