#include "service/daemon/window_data.hpp"

#include <algorithm>
#include <cassert>

#include "identification/grid.hpp"

namespace reident {
namespace {

struct Channel {
  storage::Series series;
  std::vector<std::uint8_t> usable;

  explicit Channel(storage::Series&& read) : series(std::move(read)) {
    usable.reserve(series.quality.size());
    for (const storage::Quality quality : series.quality)
      usable.push_back(quality <= storage::Quality::out_of_limits);
  }
};

std::vector<identification::ChannelSamples> views(const std::vector<Channel>& channels) {
  std::vector<identification::ChannelSamples> samples;
  samples.reserve(channels.size());
  for (const Channel& channel : channels)
    samples.push_back({channel.series.time, channel.series.value, channel.usable});
  return samples;
}

}  // namespace

std::variant<WindowData, UnknownParameter> load_window(const storage::Archive& archive,
                                                       const WindowRequest& request,
                                                       storage::TimeRange window) {
  WindowData data;
  const storage::TimeRange read{window.begin - request.hold, window.end};
  std::vector<Channel> inputs, outputs;
  const auto load = [&](const std::vector<std::string>& names, auto& descriptors,
                        auto& channels) -> const std::string* {
    for (const std::string& name : names) {
      const auto descriptor = archive.parameter(request.spacecraft, name);
      if (!descriptor) return &name;
      channels.emplace_back(archive.read(request.spacecraft, request.origin, descriptor->id, read));
      descriptors.push_back(*descriptor);
    }
    return nullptr;
  };
  if (const auto* name = load(request.inputs, data.inputs, inputs)) return UnknownParameter{*name};
  if (const auto* name = load(request.outputs, data.outputs, outputs))
    return UnknownParameter{*name};

  data.record = identification::make_record(views(inputs), views(outputs), window.begin, window.end,
                                            {.period_ns = request.period, .hold_ns = request.hold});
  const double ticks =
      static_cast<double>(window.end - window.begin) / static_cast<double>(request.period);
  data.coverage = std::min(1.0, static_cast<double>(data.record.rows()) / ticks);
  return data;
}

storage::Time time_of_row(const identification::Record& record, identification::Index row,
                          Duration period) {
  const auto segment =
      std::find_if(record.segments.begin(), record.segments.end(),
                   [row](const identification::Segment& s) { return row < s.end; });
  assert(segment != record.segments.end() && row >= segment->begin);
  return (segment->first_tick + (row - segment->begin)) * period;
}

}  // namespace reident
