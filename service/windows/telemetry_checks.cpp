#include "service/windows/telemetry_checks.hpp"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "identification/screening/relation_check.hpp"
#include "identification/screening/sensor_screening.hpp"
#include "service/support/time_text.hpp"

namespace reident {
namespace {

using identification::Record;
using identification::TickRange;
using nlohmann::ordered_json;

constexpr std::size_t most_told = 20;

std::int64_t length(const Implausible& one) {
  return one.ticks.end - one.ticks.begin;
}

void screen(const WindowData& described, const Record& samples, Plausibility& result) {
  std::vector<bool> analog;
  for (const auto* channels : {&described.input_channels, &described.output_channels})
    for (const Channel& channel : *channels) analog.push_back(channel.is_analog);
  const auto name_of = [&](std::size_t channel) {
    const std::size_t inputs = described.input_channels.size();
    return channel < inputs ? described.input_channels[channel].name
                            : described.output_channels[channel - inputs].name;
  };
  for (const identification::SensorFault& fault : sensor_faults(samples, analog))
    result.found.push_back({.check = std::string(name(fault.kind)),
                            .relation = {},
                            .parameters = {name_of(static_cast<std::size_t>(fault.channel))},
                            .ticks = fault.ticks});
}

}  // namespace

Checks checks_of(const EquipmentConfig& equipment) {
  return {equipment.screening, equipment.relations};
}

PlausibilityChecks::PlausibilityChecks(const WindowRequest& request, const Checks& checks)
    : screening_(checks.screening) {
  for (const Relation& relation : checks.relations) {
    BoundRelation bound{relation, parameters_of(relation), request, {}, {}};
    bound.request.inputs = {relation.name};
    bound.request.derived = {{relation.name, relation.expression, ""}};
    bound.request.outputs.clear();
    relations_.push_back(std::move(bound));
  }
}

void PlausibilityChecks::look(const storage::SampleReader& archive, BoundRelation& bound,
                              TickRange ticks, Plausibility& result) {
  const auto described = describe_window(archive, bound.request);
  if (const auto* unknown = std::get_if<UnknownParameter>(&described)) {
    result.not_applied.push_back(
        fmt::format("{}: telemetry has not described {}", bound.relation.name, unknown->name));
    return;
  }
  result.applied.push_back(bound.relation);
  std::vector<std::uint32_t> ids;
  for (const Channel& channel : std::get<WindowData>(described).input_channels)
    ids.push_back(channel.id);
  if (ids != bound.ids) bound.residuals.clear();
  bound.ids = std::move(ids);
  const Duration period = bound.request.period;
  Record residual = bound.residuals.over(ticks, [&](TickRange missing) {
    auto loaded =
        load_window(archive, bound.request, {missing.begin * period, missing.end * period});
    return std::get<WindowData>(std::move(loaded)).record;
  });
  std::swap(residual.u, residual.y);
  for (const auto& one : inconsistencies(residual, bound.relation.tolerance))
    result.found.push_back({.check = one.is_shift ? "shift" : "relation",
                            .relation = bound.relation,
                            .parameters = bound.parameters,
                            .ticks = one.ticks,
                            .residual = one.residual});
}

Plausibility PlausibilityChecks::look(const storage::SampleReader& archive,
                                      const WindowData& described, const Record& samples,
                                      TickRange ticks) {
  Plausibility result;
  for (BoundRelation& bound : relations_) look(archive, bound, ticks, result);
  if (screening_) screen(described, samples, result);
  std::vector<TickRange> ranges;
  for (const Implausible& one : result.found) ranges.push_back(one.ticks);
  result.holes = identification::united(std::move(ranges));
  return result;
}

void PlausibilityChecks::forget(TickRange ticks) {
  for (BoundRelation& bound : relations_) bound.residuals.forget(ticks);
}

ordered_json to_json(const Plausibility& plausibility, Duration period) {
  std::vector<const Implausible*> told;
  for (const Implausible& one : plausibility.found) told.push_back(&one);
  std::stable_sort(told.begin(), told.end(), [](const Implausible* a, const Implausible* b) {
    return length(*a) > length(*b);
  });
  if (told.size() > most_told) told.resize(most_told);
  ordered_json json = {{"stretches", plausibility.found.size()},
                       {"ticks", size(plausibility.holes)}};
  for (const Implausible* one : told) {
    ordered_json item = {{"check", one->check},
                         {"parameters", one->parameters},
                         {"begin_ns", one->ticks.begin * period},
                         {"end_ns", one->ticks.end * period}};
    if (!one->relation.name.empty()) {
      item["relation"] = one->relation.name;
      item["residual"] = one->residual;
      item["tolerance"] = one->relation.tolerance;
    }
    json["longest"].push_back(std::move(item));
  }
  if (!plausibility.not_applied.empty()) json["not_applied"] = plausibility.not_applied;
  return json;
}

double fault_share(const Plausibility& plausibility, TickRange ticks) {
  return static_cast<double>(inside(plausibility.holes, ticks).size()) /
         static_cast<double>(ticks.end - ticks.begin);
}

std::string worst_of(const Plausibility& plausibility, Duration period) {
  assert(!plausibility.found.empty());
  const Implausible& worst = *std::max_element(
      plausibility.found.begin(), plausibility.found.end(),
      [](const Implausible& a, const Implausible& b) { return length(a) < length(b); });
  const std::string when = fmt::format("from {} to {}", time_text(worst.ticks.begin * period),
                                       time_text(worst.ticks.end * period));
  const std::string parameters = fmt::format("{}", fmt::join(worst.parameters, ", "));
  if (worst.relation.name.empty())
    return fmt::format("{} shows a fault ({}) {}", parameters, worst.check, when);
  return fmt::format("relation {} ({}) does not hold {}: it is {:.4g}, {} {:g}; one of {} is wrong",
                     worst.relation.name, worst.relation.expression, when, worst.residual,
                     worst.check == "shift" ? "which is not its usual value, with a tolerance of"
                                            : "with a tolerance of",
                     worst.relation.tolerance, parameters);
}

}  // namespace reident
