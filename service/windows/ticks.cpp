#include "service/windows/ticks.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "service/support/floor_divide.hpp"
#include "service/support/time_text.hpp"
#include "service/windows/window_data.hpp"
#include "storage/types/error.hpp"

namespace reident {
namespace {

constexpr std::size_t least_steps = 10;    // that show a grid
constexpr std::size_t times_tried = 2000;  // of a channel
constexpr double outliers = 0.005;         // of the times
constexpr double least_gap = 0.1;          // of a period
constexpr double as_wide = 0.95;           // as the widest

/// The roundest number from `low` to `high`.
std::int64_t roundest(double low, double high) {
  for (double unit = 1e18; unit >= 1; unit /= 10)
    if (const double round = std::ceil(low / unit) * unit; round <= high)
      return static_cast<std::int64_t>(round);
  return static_cast<std::int64_t>(std::ceil(low));
}

/// The longest stretch of steps that are about as long as `median`.
std::span<const std::int64_t> longest_stretch(std::span<const std::int64_t> steps,
                                              std::int64_t median) {
  std::span<const std::int64_t> longest;
  for (std::size_t begin = 0; begin < steps.size();) {
    std::size_t end = begin;
    while (end < steps.size() && 2 * steps[end] > median && 2 * steps[end] < 3 * median) ++end;
    if (end - begin > longest.size()) longest = steps.subspan(begin, end - begin);
    begin = std::max(end, begin + 1);
  }
  return longest;
}

}  // namespace

std::int64_t usual_step(std::span<const std::int64_t> steps_ns) {
  std::vector<std::int64_t> sorted(steps_ns.begin(), steps_ns.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const std::int64_t median = *middle;
  const auto stretch = longest_stretch(steps_ns, median);
  if (stretch.size() < least_steps) return median;
  double sum = 0;
  for (const std::int64_t step : stretch) sum += static_cast<double>(step);
  const auto count = static_cast<double>(stretch.size());
  const double mean = sum / count;
  double off = 0, least = 0, most = 0;  // from the grid of that period
  for (const std::int64_t step : stretch) {
    off += static_cast<double>(step) - mean;
    least = std::min(least, off);
    most = std::max(most, off);
  }
  const double spread = most - least;
  if (2 * spread > static_cast<double>(median)) return median;  // no grid
  return std::max<std::int64_t>(1, roundest(mean - spread / count, mean + spread / count));
}

std::int64_t suitable_phase(const std::vector<std::vector<std::int64_t>>& channels_ns,
                            std::int64_t period_ns) {
  std::vector<std::int64_t> phases;
  for (const auto& times : channels_ns) {
    const std::size_t every = std::max<std::size_t>(1, times.size() / times_tried);
    for (std::size_t i = 0; i < times.size(); i += every)
      phases.push_back(times[i] - floor_divide(times[i], period_ns) * period_ns);
  }
  if (phases.empty()) return 0;
  std::sort(phases.begin(), phases.end());
  const std::size_t count = phases.size();
  const auto passed = static_cast<std::size_t>(outliers * static_cast<double>(count));
  std::int64_t widest = 0, after = 0, at_multiples = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = i + passed + 1;
    const std::int64_t end = phases[next % count] + (next >= count ? period_ns : 0);
    const std::int64_t gap = end - phases[i];
    // A sample at a tick belongs to it.
    if (phases[i] == 0 || end > period_ns) at_multiples = std::max(at_multiples, gap);
    if (gap <= widest) continue;
    widest = gap;
    after = phases[i];
  }
  const auto width = static_cast<double>(widest);
  if (static_cast<double>(at_multiples) >= as_wide * width ||
      width < least_gap * static_cast<double>(period_ns))
    return 0;
  const auto begin = static_cast<double>(after);
  return roundest(begin, begin + width / 10) % period_ns;
}

std::optional<std::string> advised_phase(const storage::SampleReader& telemetry,
                                         const std::string& spacecraft,
                                         const EquipmentConfig& equipment, storage::Time end) {
  constexpr std::int64_t ticks = 2000;
  if (equipment.phase != 0) return std::nullopt;
  std::vector<std::vector<std::int64_t>> channels;
  for (const std::string& name : parameters_of(equipment)) try {
      if (const auto parameter = telemetry.parameter(spacecraft, name))
        channels.push_back(telemetry
                               .read(spacecraft, storage::Origin::real, parameter->id,
                                     {end - ticks * equipment.sample_period, end})
                               .time);
    } catch (const storage::Error& error) {
      if (error.kind() != storage::Error::Kind::corrupt) throw;  // a window says what is damaged
    }
  const Duration phase = suitable_phase(channels, equipment.sample_period);
  if (phase == 0) return std::nullopt;
  return fmt::format(
      "{}/{}: not all parameters have come at the multiples of {}; phase = \"{}\" for the "
      "equipment puts its ticks where they have, as reident identify does",
      spacecraft, equipment.name, duration_text(equipment.sample_period), duration_text(phase));
}

}  // namespace reident
