#include "service/cli/output/axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "service/support/floor_divide.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli {
namespace {

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t minute = 60 * second;
constexpr std::int64_t hour = 60 * minute;
constexpr std::int64_t day = 24 * hour;
constexpr std::array time_steps = {second,      2 * second,  5 * second, 10 * second, 15 * second,
                                   30 * second, minute,      2 * minute, 5 * minute,  10 * minute,
                                   15 * minute, 30 * minute, hour,       2 * hour,    3 * hour,
                                   6 * hour,    12 * hour,   day,        2 * day,     7 * day,
                                   14 * day,    28 * day,    84 * day,   364 * day};

}  // namespace

Scale scale_around(double low, double high, double from, double to) {
  double room = 0.05 * (high - low);
  if (room <= 0) room = std::max(0.01 * std::abs(low), 1e-9);
  return {low - room, high + room, from, to};
}

std::vector<Tick> ticks_of(const Scale& scale, int most) {
  const double width = scale.high - scale.low;
  const double power = std::pow(10, std::floor(std::log10(width / most)));
  double step = 10 * power;
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= width / most) {
      step = factor * power;
      break;
    }
  std::vector<Tick> ticks;
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  for (double k = std::ceil(scale.low / step); k * step <= scale.high; ++k) {
    const double value = k * step + 0.0;  // no -0
    ticks.push_back({value, std::abs(value) >= 1e6 || decimals > 6
                                ? fmt::format("{:.4g}", value)
                                : fmt::format("{:.{}f}", value, decimals)});
  }
  return ticks;
}

std::vector<Tick> time_ticks(storage::TimeRange range, int most) {
  const std::int64_t width = range.end - range.begin;
  const auto fits = [width, most](std::int64_t step) { return (width - 1) / step < most; };
  const auto* found = std::find_if(time_steps.begin(), time_steps.end(), fits);
  const std::int64_t step = found == time_steps.end() ? time_steps.back() : *found;
  std::vector<Tick> ticks;
  std::string last_day;
  for (std::int64_t time = -floor_divide(-range.begin, step) * step; time < range.end;
       time += step) {
    const std::string text = time_text(time);  // 2023-04-29T16:22:37Z
    const std::string date = text.substr(0, 10);
    std::string label = step >= day ? date : text.substr(11, step < minute ? 8 : 5);
    if (step < day && date != last_day) label = date + " " + label;
    last_day = date;
    ticks.push_back({static_cast<double>(time - range.begin) * 1e-9, label});
  }
  return ticks;
}

}  // namespace reident::cli
