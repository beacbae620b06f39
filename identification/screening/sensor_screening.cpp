#include "identification/screening/sensor_screening.hpp"

#include <algorithm>
#include <cassert>

#include "identification/samples/tick_ranges.hpp"
#include "identification/screening/channels.hpp"
#include "identification/screening/fill_values.hpp"
#include "identification/screening/noise.hpp"
#include "identification/screening/spikes.hpp"
#include "identification/screening/stuck.hpp"

namespace reident::identification {
namespace {

TickRange ticks_of(const Record& record, std::size_t segment, Index begin, Index end) {
  const Segment& within = record.segments[segment];
  const std::int64_t first = within.first_tick + (begin - within.begin);
  return {first, first + (end - begin)};
}

std::vector<SensorFault> fills_of(const Record& record) {
  std::vector<SensorFault> faults;
  const Index inputs = record.u.cols(), outputs = record.y.cols();
  for (Index c = 0; c < inputs + outputs; ++c) {
    const Vector values = c < inputs ? record.u.col(c) : record.y.col(c - inputs);
    const std::vector<double> fills = fill_values(values);
    if (fills.empty()) continue;
    const auto is_fill = [&](Index row) {
      return std::find(fills.begin(), fills.end(), values(row)) != fills.end();
    };
    for (std::size_t s = 0; s < record.segments.size(); ++s)
      for (Index row = record.segments[s].begin; row < record.segments[s].end; ++row) {
        if (!is_fill(row)) continue;
        const Index begin = row;
        while (row < record.segments[s].end && is_fill(row)) ++row;
        faults.push_back({SensorFaultKind::fill, c, ticks_of(record, s, begin, row)});
      }
  }
  return faults;
}

std::vector<SensorFault> scattered_fills_of(const std::vector<Channel>& channels,
                                            const Record& record) {
  std::vector<SensorFault> faults;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (!channels[c].is_analog) continue;
    for (const Plateau& fill : scattered_fills(channels, c))
      faults.push_back({SensorFaultKind::fill, static_cast<Index>(c),
                        ticks_of(record, fill.segment, fill.begin, fill.end)});
  }
  return faults;
}

Record without_faults(const Record& record, const std::vector<SensorFault>& faults) {
  std::vector<TickRange> ticks;
  for (const SensorFault& fault : faults) ticks.push_back(fault.ticks);
  return without(record, united(std::move(ticks)));
}

}  // namespace

std::string_view name(SensorFaultKind kind) {
  switch (kind) {
    case SensorFaultKind::fill:
      return "fill";
    case SensorFaultKind::stuck:
      return "stuck";
    case SensorFaultKind::spike:
      return "spike";
    case SensorFaultKind::noise:
      break;
  }
  return "noise";
}

std::vector<SensorFault> sensor_faults(const Record& whole, const std::vector<bool>& analog) {
  assert(static_cast<Index>(analog.size()) == whole.u.cols() + whole.y.cols());
  std::vector<SensorFault> faults = fills_of(whole);
  // What stands for no sample would hide what is unusual in the others.
  Record rest;
  if (!faults.empty()) rest = without_faults(whole, faults);
  const Record& filled = faults.empty() ? whole : rest;
  if (filled.rows() == 0) return faults;
  std::vector<Channel> channels = channels_of(filled, analog);
  if (const auto scattered = scattered_fills_of(channels, filled); !scattered.empty()) {
    faults.insert(faults.end(), scattered.begin(), scattered.end());
    rest = without_faults(whole, faults);
    channels = rest.rows() > 0 ? channels_of(rest, analog) : std::vector<Channel>();
  }
  const Record& record = faults.empty() ? whole : rest;
  const auto bursts = noise_bursts(channels, record);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (!channels[c].is_analog) continue;
    const auto add = [&](SensorFaultKind kind, std::size_t segment, Index begin, Index end) {
      faults.push_back({kind, static_cast<Index>(c), ticks_of(record, segment, begin, end)});
    };
    for (const Plateau& plateau : stuck_plateaus(channels, c))
      add(SensorFaultKind::stuck, plateau.segment, plateau.begin, plateau.end);
    for (const Plateau& spike : spikes_of(channels, c))
      add(SensorFaultKind::spike, spike.segment, spike.begin, spike.end);
    for (const NoisyRows& rows : bursts[c])
      add(SensorFaultKind::noise, rows.segment, rows.begin, rows.end);
  }
  std::stable_sort(faults.begin(), faults.end(), [](const SensorFault& a, const SensorFault& b) {
    return a.channel < b.channel;
  });
  return faults;
}

}  // namespace reident::identification
