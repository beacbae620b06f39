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

constexpr Index longest_bridged = 30;  // rows, as of a lost packet

TickRange ticks_of(const Record& record, std::size_t segment, Index begin, Index end) {
  const Segment& within = record.segments[segment];
  const std::int64_t first = within.tick_of(begin);
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

/// Gives rows [begin, end) of a channel the straight line from the row before to the row behind.
void draw_line(Eigen::Ref<Vector> values, Index begin, Index end) {
  const double before = values(begin - 1), rise = values(end) - before;
  for (Index row = begin; row < end; ++row)
    values(row) = before + rise * double(row - begin + 1) / double(end - begin + 1);
}

/// The record with a line in place of each fault: the other channels have samples there, and rows
/// that stand still do so before and behind. Where a fault is long, or one at an end of a segment,
/// its rows are left out.
Record without_faults(Record record, const std::vector<SensorFault>& faults) {
  std::vector<TickRange> left_out;
  const Index inputs = record.u.cols();
  for (Index c = 0; c < inputs + record.y.cols(); ++c) {
    std::vector<TickRange> ticks;
    for (const SensorFault& fault : faults)
      if (fault.channel == c) ticks.push_back(fault.ticks);
    auto values = c < inputs ? record.u.col(c) : record.y.col(c - inputs);
    auto segment = record.segments.begin();
    for (const TickRange& hole : united(std::move(ticks))) {
      while (segment->end_tick() < hole.end) ++segment;
      const Index begin = segment->begin + (hole.begin - segment->first_tick);
      const Index end = begin + (hole.end - hole.begin);
      if (end - begin <= longest_bridged && begin > segment->begin && end < segment->end)
        draw_line(values, begin, end);
      else
        left_out.push_back(hole);
    }
  }
  return without(std::move(record), united(std::move(left_out)));
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
  Record rest;  // without these faults, where there are some
  const auto record = [&]() -> const Record& { return faults.empty() ? whole : rest; };
  if (!faults.empty()) rest = without_faults(whole, faults);
  if (record().rows() == 0) return faults;
  std::vector<Channel> channels = channels_of(record(), analog);
  const auto find = [&](SensorFaultKind kind, const auto& rows_of) {
    std::vector<SensorFault> found;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      if (!channels[c].is_analog && kind != SensorFaultKind::fill) continue;
      for (const auto& rows : rows_of(c))
        found.push_back(
            {kind, static_cast<Index>(c), ticks_of(record(), rows.segment, rows.begin, rows.end)});
    }
    return found;
  };
  const auto add = [&](const std::vector<SensorFault>& found) {
    faults.insert(faults.end(), found.begin(), found.end());
  };
  // What is no sample would hide what is unusual in the others.
  const auto take_out = [&](const std::vector<SensorFault>& found) {
    if (found.empty()) return;
    add(found);
    rest = without_faults(whole, faults);
    channels = rest.rows() > 0 ? channels_of(rest, analog) : std::vector<Channel>();
  };
  take_out(
      find(SensorFaultKind::fill, [&](std::size_t c) { return scattered_fills(channels, c); }));
  const auto bursts = noise_bursts(channels, record());
  const auto noise = find(SensorFaultKind::noise, [&](std::size_t c) { return bursts[c]; });
  take_out(find(SensorFaultKind::stuck, [&](std::size_t c) {
    return stuck_plateaus(channels, c, static_cast<std::size_t>(whole.u.cols()));
  }));
  std::vector<SensorFault> spikes =
      find(SensorFaultKind::spike, [&](std::size_t c) { return spikes_of(channels, c); });
  // What stands out beside a line has no neighbours of its own.
  std::erase_if(spikes, [&](const SensorFault& spike) {
    return std::any_of(faults.begin(), faults.end(), [&](const SensorFault& other) {
      return other.channel == spike.channel &&
             (other.ticks.end == spike.ticks.begin || other.ticks.begin == spike.ticks.end);
    });
  });
  add(spikes);
  add(noise);
  std::stable_sort(faults.begin(), faults.end(), [](const SensorFault& a, const SensorFault& b) {
    return a.channel < b.channel;
  });
  return faults;
}

}  // namespace reident::identification
