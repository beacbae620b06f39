#include "service/daemon/window_data.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

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

WindowRequest request_of(const std::string& spacecraft, const EquipmentConfig& equipment) {
  return {spacecraft, equipment.inputs, equipment.outputs, equipment.sample_period, equipment.hold};
}

WindowRequest request_of(const EquipmentModel& model) {
  return {model.spacecraft, signal_names(model.inputs), signal_names(model.outputs),
          static_cast<Duration>(std::llround(model.dynamics.period_s * 1e9)), model.hold_ns};
}

std::variant<WindowData, UnknownParameter> describe_window(const storage::Archive& archive,
                                                           const WindowRequest& request) {
  WindowData data;
  const auto describe = [&](const std::vector<std::string>& names,
                            std::vector<storage::ParameterDescriptor>& descriptors) {
    for (const std::string& name : names) {
      const auto descriptor = archive.parameter(request.spacecraft, name);
      if (!descriptor) return &name;
      descriptors.push_back(*descriptor);
    }
    return static_cast<const std::string*>(nullptr);
  };
  if (const auto* name = describe(request.inputs, data.inputs)) return UnknownParameter{*name};
  if (const auto* name = describe(request.outputs, data.outputs)) return UnknownParameter{*name};
  return data;
}

double coverage_of(const identification::Record& record, storage::TimeRange window,
                   Duration period) {
  const double ticks = static_cast<double>(window.end - window.begin) / static_cast<double>(period);
  return std::min(1.0, static_cast<double>(record.rows()) / ticks);
}

std::variant<WindowData, UnknownParameter> load_window(const storage::Archive& archive,
                                                       const WindowRequest& request,
                                                       storage::TimeRange window) {
  auto described = describe_window(archive, request);
  if (const auto* unknown = std::get_if<UnknownParameter>(&described)) return *unknown;
  WindowData data = std::get<WindowData>(std::move(described));
  const storage::TimeRange read{window.begin - request.hold, window.end};
  const auto channels = [&](const std::vector<storage::ParameterDescriptor>& descriptors) {
    std::vector<Channel> result;
    for (const storage::ParameterDescriptor& descriptor : descriptors)
      result.emplace_back(archive.read(request.spacecraft, request.origin, descriptor.id, read));
    return result;
  };
  const std::vector<Channel> inputs = channels(data.inputs), outputs = channels(data.outputs);
  data.record = identification::make_record(views(inputs), views(outputs), window.begin, window.end,
                                            {.period_ns = request.period, .hold_ns = request.hold});
  data.coverage = coverage_of(data.record, window, request.period);
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
