#include "service/cli/output/throughput.hpp"

#include <cmath>

#include <fmt/format.h>

namespace reident::cli {

std::string short_count(double count) {
  struct Scale {
    double from;
    double unit;
    const char* name;
  };
  for (const Scale& scale : {Scale{1e9, 1e9, " G"}, Scale{1e6, 1e6, " M"}, Scale{1e4, 1e3, " k"}})
    if (count >= scale.from) return fmt::format("{:.3g}{}", count / scale.unit, scale.name);
  return fmt::format("{:.0f}", count);
}

std::string rough_duration(double seconds) {
  constexpr double minute = 60, hour = 3600, day = 86400;
  if (seconds < 2 * minute) return fmt::format("{:.3g}s", seconds);
  if (seconds < 2 * hour) return fmt::format("{:.0f}min", seconds / minute);
  if (seconds < 2 * day) return fmt::format("{:.1f}h", seconds / hour);
  return fmt::format("{:.1f}d", seconds / day);
}

std::string Throughput::text(double fraction, std::uint64_t done, Clock::time_point now) {
  const double all = static_cast<double>(done);
  std::string text = fmt::format("{} samples", short_count(all));
  const double elapsed = seconds(now);
  if (elapsed > 0) text += fmt::format(", {}/s", short_count(all / elapsed));
  if (!first_) first_ = Mark{now, fraction};
  const double gained = fraction - first_->fraction;
  if (gained <= 0) return text;
  const double since = std::chrono::duration<double>(now - first_->time).count();
  return text +
         fmt::format(", {} left", rough_duration(std::ceil(since * (1 - fraction) / gained)));
}

}  // namespace reident::cli
