#include "service/windows/ticks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "service/model/model_json.hpp"
#include "service/support/floor_divide.hpp"
#include "service/support/time_text.hpp"
#include "service/windows/provenance.hpp"
#include "service/windows/window_data.hpp"
#include "storage/types/error.hpp"

namespace reident {
namespace {

constexpr std::size_t least_steps = 10;  // that show a grid
constexpr std::int64_t ticks_tried = 1000;
constexpr double outliers = 0.005;  // of the times
constexpr double least_gap = 0.1;   // of a period
constexpr double as_wide = 0.95;    // as the widest

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

/// The equipment's parameters that telemetry has described.
std::vector<std::uint32_t> described_parameters(const storage::Archive& archive,
                                                const std::string& spacecraft,
                                                const EquipmentConfig& equipment) {
  std::vector<std::uint32_t> ids;
  for (const std::string& name : parameters_of(equipment))
    if (const auto parameter = archive.parameter(spacecraft, name)) ids.push_back(parameter->id);
  return ids;
}

/// From when on all that ever come have come; absent where none has.
std::optional<storage::Time> first_of_all(const storage::Archive& archive,
                                          const std::string& spacecraft,
                                          const EquipmentConfig& equipment) {
  std::optional<storage::Time> begin;
  for (const std::uint32_t id : described_parameters(archive, spacecraft, equipment))
    if (const auto first = archive.first_at_or_after(spacecraft, storage::Origin::real, id,
                                                     std::numeric_limits<storage::Time>::min()))
      begin = std::max(begin.value_or(*first), *first);
  return begin;
}

/// Times of the samples of each parameter; none of one that is damaged.
std::vector<std::vector<std::int64_t>> times_of(const storage::Archive& archive,
                                                const std::string& spacecraft,
                                                const EquipmentConfig& equipment,
                                                storage::TimeRange range) {
  std::vector<std::vector<std::int64_t>> times;
  for (const std::uint32_t id : described_parameters(archive, spacecraft, equipment)) try {
      times.push_back(archive.read(spacecraft, storage::Origin::real, id, range).time);
    } catch (const storage::Error& error) {
      if (error.kind() != storage::Error::Kind::corrupt) throw;  // a window says what is damaged
    }
  return times;
}

/// Absent where there is no version, or it was made of other telemetry.
std::optional<Duration> phase_of_newest(const storage::Registry& registry,
                                        const std::string& spacecraft, EquipmentConfig equipment) {
  std::optional<Duration> phase;
  storage::RowFilter newest;
  newest.spacecraft = spacecraft;
  newest.equipment = equipment.name;
  newest.newest_first = true;
  registry.each_version(newest, [&](const storage::Version& version) {
    if (mistake_in(version)) return true;
    const WindowRequest request = request_of(equipment_model_from_json(version.model_json));
    equipment.phase = request.phase;
    if (request == request_of(spacecraft, equipment)) phase = request.phase;
    return false;
  });
  return phase;
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
  std::int64_t begin = std::numeric_limits<std::int64_t>::min();
  for (const auto& times : channels_ns)
    if (!times.empty()) begin = std::max(begin, times.front());
  const std::int64_t last_tick = floor_divide(begin, period_ns) + ticks_tried - 1;
  std::vector<std::int64_t> phases;
  for (const auto& times : channels_ns)
    for (auto time = std::lower_bound(times.begin(), times.end(), begin);
         time != times.end() && floor_divide(*time, period_ns) <= last_tick; ++time)
      phases.push_back(*time - floor_divide(*time, period_ns) * period_ns);
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
  const auto earliest = static_cast<double>(after);
  return roundest(earliest, earliest + width / 10) % period_ns;
}

EquipmentConfig with_phase(EquipmentConfig equipment, const std::string& spacecraft,
                           const storage::Archive& archive, const storage::Registry& registry) {
  if (!equipment.phase) equipment.phase = phase_of_newest(registry, spacecraft, equipment);
  if (equipment.phase) return equipment;
  const auto first = first_of_all(archive, spacecraft, equipment);
  if (!first) return equipment;
  // All of it has come before any window can give a model: the first one is on the same ticks
  // whenever it is tried.
  const Duration period = equipment.sample_period;
  const auto least =
      static_cast<Duration>(equipment.min_coverage * static_cast<double>(equipment.window));
  const Duration length = std::clamp<Duration>(least - period, 0, ticks_tried * period);
  const storage::TimeRange range{
      *first, std::min(*first, std::numeric_limits<storage::Time>::max() - length) + length};
  equipment.phase = suitable_phase(times_of(archive, spacecraft, equipment, range), period);
  return equipment;
}

std::optional<std::string> advised_phase(const storage::Archive& archive,
                                         const storage::Registry& registry,
                                         const std::string& spacecraft,
                                         const EquipmentConfig& equipment, storage::Time end) {
  if (equipment.phase) return std::nullopt;
  const Duration period = equipment.sample_period;
  const Duration phase = with_phase(equipment, spacecraft, archive, registry).phase.value_or(0);
  auto channels = times_of(archive, spacecraft, equipment, {end - ticks_tried * period, end});
  const Duration suitable = suitable_phase(channels, period);
  for (auto& times : channels)
    for (storage::Time& time : times) time -= phase;
  if (suitable_phase(channels, period) == 0) return std::nullopt;
  return fmt::format(
      "{}/{}: not all parameters have come at the ticks, {} behind the multiples of {}; phase = "
      "\"{}\" for the equipment puts them where they have, for versions from then on",
      spacecraft, equipment.name, duration_text(phase), duration_text(period),
      duration_text(suitable));
}

}  // namespace reident
