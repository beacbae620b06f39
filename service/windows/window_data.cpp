#include "service/windows/window_data.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>

#include "identification/samples/grid.hpp"
#include "service/support/floor_divide.hpp"

namespace reident {
namespace {

struct ReadChannel {
  storage::Series series;
  std::vector<std::uint8_t> usable;

  ReadChannel(storage::Series&& read, Duration phase) : series(std::move(read)) {
    for (storage::Time& time : series.time) time -= phase;
    usable.reserve(series.quality.size());
    for (const storage::Quality quality : series.quality)
      usable.push_back(storage::is_usable(quality));
  }
};

std::vector<identification::ChannelSamples> views(const std::vector<ReadChannel>& channels) {
  std::vector<identification::ChannelSamples> samples;
  samples.reserve(channels.size());
  for (const ReadChannel& channel : channels)
    samples.push_back({channel.series.time, channel.series.value, channel.usable});
  return samples;
}

/// The parameters that the equipment's signals are, or are computed from.
std::vector<std::string> own_parameters(const EquipmentConfig& equipment) {
  std::vector<std::string> names =
      InputExpressions(equipment.inputs, equipment.derived).parameters();
  names.insert(names.end(), equipment.outputs.begin(), equipment.outputs.end());
  return names;
}

}  // namespace

WindowRequest request_of(const std::string& spacecraft, const EquipmentConfig& equipment) {
  std::vector<DerivedInput> derived;  // in the order of the inputs, as a model has them
  for (const std::string& input : equipment.inputs)
    for (const DerivedInput& one : equipment.derived)
      if (one.name == input) derived.push_back(one);
  return {spacecraft,
          equipment.inputs,
          std::move(derived),
          equipment.outputs,
          equipment.sample_period,
          equipment.sample_hold,
          equipment.phase.value_or(0)};
}

WindowRequest request_of(const EquipmentModel& model) {
  return {model.spacecraft,
          signal_names(model.inputs),
          derived_inputs(model.inputs),
          signal_names(model.outputs),
          static_cast<Duration>(std::llround(model.dynamics.period_s * 1e9)),
          model.sample_hold_ns,
          model.phase_ns.value_or(0)};
}

std::vector<std::string> parameters_of(const EquipmentConfig& equipment) {
  std::vector<std::string> names = own_parameters(equipment);
  for (const Relation& relation : equipment.relations)
    for (const std::string& name : parameters_of(relation))
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

std::vector<std::string> parameters_of(const Relation& relation) {
  return InputExpressions({relation.name}, {{relation.name, relation.expression, ""}}).parameters();
}

std::vector<Relation> applying_relations(const storage::SampleReader& archive,
                                         const std::string& spacecraft,
                                         const EquipmentConfig& equipment) {
  std::vector<Relation> relations;
  for (const Relation& relation : equipment.relations)
    if (std::ranges::all_of(parameters_of(relation), [&](const std::string& parameter) {
          return archive.parameter(spacecraft, parameter).has_value();
        }))
      relations.push_back(relation);
  return relations;
}

std::vector<std::string> unbound_parameters(const EquipmentConfig& equipment,
                                            const std::vector<Relation>& relations) {
  std::vector<std::string> unbound = own_parameters(equipment);
  for (const Relation& relation : relations)
    for (const std::string& parameter : parameters_of(relation)) std::erase(unbound, parameter);
  return unbound;
}

std::variant<WindowData, UnknownParameter> describe_window(const storage::SampleReader& archive,
                                                           const WindowRequest& request) {
  WindowData data;
  std::map<std::string, std::string> units;
  const auto describe = [&](const std::vector<std::string>& names, std::vector<Channel>& channels) {
    for (const std::string& name : names) {
      const auto descriptor = archive.parameter(request.spacecraft, name);
      if (!descriptor) return &name;
      channels.push_back(
          {name, descriptor->id, descriptor->kind == storage::ParameterKind::analog});
      units[name] = descriptor->unit;
    }
    return static_cast<const std::string*>(nullptr);
  };
  const InputExpressions expressions(request.inputs, request.derived);
  if (const auto* name = describe(expressions.parameters(), data.input_channels))
    return UnknownParameter{*name};
  if (const auto* name = describe(request.outputs, data.output_channels))
    return UnknownParameter{*name};
  for (const std::string& name : request.inputs) data.inputs.push_back({name, units[name]});
  for (const std::string& name : request.outputs) data.outputs.push_back({name, units[name]});
  for (Signal& input : data.inputs)
    for (const DerivedInput& derived : request.derived)
      if (derived.name == input.name) {
        input.unit = derived.unit;
        input.expression = derived.expression;
      }
  return data;
}

double coverage_of(const identification::Record& record, storage::TimeRange window,
                   Duration period) {
  const double ticks = static_cast<double>(window.end - window.begin) / static_cast<double>(period);
  return std::min(1.0, static_cast<double>(record.rows()) / ticks);
}

identification::Record load_samples(const storage::SampleReader& archive,
                                    const WindowRequest& request, const WindowData& described,
                                    storage::TimeRange window) {
  const storage::Time latest = std::numeric_limits<storage::Time>::max() - request.phase;
  const storage::TimeRange read{window.begin - request.sample_hold + request.phase,
                                std::min(window.end, latest) + request.phase};
  const auto channels = [&](const std::vector<Channel>& wanted) {
    std::vector<ReadChannel> result;
    for (const Channel& channel : wanted)
      result.emplace_back(archive.read(request.spacecraft, request.origin, channel.id, read),
                          request.phase);
    return result;
  };
  const std::vector<ReadChannel> inputs = channels(described.input_channels);
  const std::vector<ReadChannel> outputs = channels(described.output_channels);
  return identification::make_record(
      views(inputs), views(outputs), window.begin, window.end,
      {.period_ns = request.period, .sample_hold_ns = request.sample_hold});
}

ParameterCoverage least_covered(const storage::SampleReader& archive, const WindowRequest& request,
                                const WindowData& described, storage::TimeRange window) {
  ParameterCoverage least{{}, std::numeric_limits<double>::infinity()};
  for (const auto* channels : {&described.input_channels, &described.output_channels})
    for (const Channel& channel : *channels) {
      WindowData alone;
      alone.output_channels = {channel};
      const double coverage =
          coverage_of(load_samples(archive, request, alone, window), window, request.period);
      if (coverage < least.coverage) least = {channel.name, coverage};
    }
  return least;
}

std::variant<WindowData, UnknownParameter> load_window(const storage::SampleReader& archive,
                                                       const WindowRequest& request,
                                                       storage::TimeRange window) {
  auto described = describe_window(archive, request);
  if (const auto* unknown = std::get_if<UnknownParameter>(&described)) return *unknown;
  WindowData data = std::get<WindowData>(std::move(described));
  data.record = InputExpressions(request.inputs, request.derived)
                    .evaluate(load_samples(archive, request, data, window));
  data.coverage = data.read_coverage = coverage_of(data.record, window, request.period);
  return data;
}

identification::TickRange ticks_of(storage::TimeRange range, Duration period) {
  return {-floor_divide(-range.begin, period), -floor_divide(-range.end, period)};
}

storage::Time time_of_row(const identification::Record& record, identification::Index row,
                          Duration period) {
  return tick_of_row(record, row) * period;
}

}  // namespace reident
