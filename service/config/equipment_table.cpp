#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "service/config/config_tables.hpp"
#include "service/model/regime_inputs.hpp"
#include "service/support/time_text.hpp"

namespace reident {
namespace {

constexpr std::int64_t max_window_ticks = 50'000'000;  // 8 bytes for each channel of each
constexpr int max_order = 100;
constexpr int max_members = 100;
constexpr int max_horizon = 500;

void read_signals(TableReader& reader, EquipmentConfig& equipment) {
  reader.require("inputs", "[\"I_BDRIN1\", \"I_BDRIN2\"]");
  reader.require("outputs", "[\"I_BDROUT\"]");
  std::set<std::string> seen;
  const auto read = [&](std::string_view key, std::vector<std::string>& target) {
    const auto names = reader.texts(key);
    if (!names) return;
    target = *names;
    for (const std::string& name : target) {
      if (const std::string mistake = name_mistake(name); !mistake.empty())
        reader.mistake(key, fmt::format("each name in {} {}", key, mistake));
      if (seen.insert(name).second) continue;
      const bool is_input = key == "outputs" &&
                            std::count(equipment.inputs.begin(), equipment.inputs.end(), name) != 0;
      reader.mistake(key, is_input ? fmt::format("output {} is also an input; a model cannot be "
                                                 "driven by what it computes",
                                                 name)
                                   : fmt::format("{} names {} twice", key, name));
    }
  };
  read("inputs", equipment.inputs);
  read("outputs", equipment.outputs);
}

/// Derived inputs that are whole, each checked against the signals of the equipment. Their names
/// are those of inputs, which are checked there.
void read_derived(TableReader& reader, ConfigDocument& document, EquipmentConfig& equipment) {
  std::vector<TableReader> readers;  // of the whole ones
  for (const toml::table* table : reader.sections("derived")) {
    TableReader derived(*table, fmt::format("{} derived input:", reader.title()), document);
    derived.require("name", "\"P_IN\"");
    const auto name = derived.text("name");
    if (name) derived.set_title(fmt::format("{} derived input {}:", reader.title(), *name));
    derived.require("expression", "\"U_IN * I_IN\"");
    derived.require("unit", "\"W\"");
    const auto expression = derived.text("expression");
    const auto unit = derived.text("unit");
    derived.refuse_unknown_keys();
    if (!name || !expression || !unit) continue;
    equipment.derived.push_back({*name, *expression, *unit});
    readers.push_back(std::move(derived));
  }
  for (const DerivedInputMistake& mistake :
       mistakes_in(equipment.derived, equipment.inputs, equipment.outputs))
    readers[mistake.index].mistake(mistake.key, fmt::format("{} {}", mistake.key, mistake.message));
}

/// Adds the inputs of the equipment's operating regimes, once the others are whole.
void read_regimes(TableReader& reader, bool others_are_whole, EquipmentConfig& equipment) {
  const auto regimes = reader.texts("regimes");
  if (!regimes || !others_are_whole || equipment.inputs.empty()) return;
  const std::size_t before = equipment.inputs.size();
  for (const std::string& regime : *regimes) {
    const auto mistakes =
        mistakes_in({{regime_name(regime), regime, ""}}, {regime_name(regime)}, equipment.outputs);
    for (const DerivedInputMistake& mistake : mistakes)
      reader.mistake("regimes", fmt::format("regime \"{}\" {}", regime, mistake.message));
    if (!mistakes.empty()) return;
    if (std::count(regimes->begin(), regimes->end(), regime) > 1)
      return reader.mistake("regimes", fmt::format("regimes names \"{}\" twice", regime));
  }
  add_regime_inputs(*regimes, equipment.inputs, equipment.derived);
  equipment.regime_inputs = static_cast<int>(equipment.inputs.size() - before);
  // Inputs that an expression can name, within the regimes.
  for (const DerivedInputMistake& mistake :
       mistakes_in(equipment.derived, equipment.inputs, equipment.outputs))
    reader.mistake("regimes", fmt::format("regimes: {} {}", equipment.derived[mistake.index].name,
                                          mistake.message));
}

void read_order(TableReader& reader, EquipmentConfig& equipment) {
  const toml::array* range = reader.array("order");
  if (range != nullptr) {
    const auto bound = [&](std::size_t i) { return range->get(i)->value_exact<std::int64_t>(); };
    const bool pair = range->size() == 2 && bound(0) && bound(1);
    if (!pair || *bound(0) < 1 || *bound(1) > max_order || *bound(0) > *bound(1)) {
      reader.mistake("order", fmt::format("order must be [least, most] with 1 <= least <= most <= "
                                          "{}, a number, or \"auto\"",
                                          max_order));
      return;
    }
    equipment.min_order = static_cast<int>(*bound(0));
    equipment.max_order = static_cast<int>(*bound(1));
  } else if (const auto order = reader.integer_or_auto("order", 1, max_order)) {
    equipment.min_order = equipment.max_order = static_cast<int>(*order);
  }
}

/// Least horizon s with which the largest order can be seen: s blocks of p outputs hold more rows
/// than there are states.
int least_horizon(const EquipmentConfig& equipment) {
  const int outputs = static_cast<int>(std::max<std::size_t>(1, equipment.outputs.size()));
  return (equipment.max_order + outputs - 1) / outputs + 1;
}

void check_window(TableReader& reader, const EquipmentConfig& equipment) {
  const Duration period = equipment.sample_period;
  const std::int64_t ticks = equipment.window / period;
  if (equipment.window % period != 0)
    reader.mistake("window", fmt::format("window must be a multiple of sample_period {}; {} is",
                                         duration_text(period),
                                         duration_text(std::max<Duration>(1, ticks) * period)));
  const std::int64_t least = least_window_ticks(equipment);
  if (ticks < least)
    reader.mistake(
        "window",
        fmt::format("window {} holds {} samples of {}; orders up to {} with {} inputs and {} "
                    "outputs need {}: make it at least {} or lower the order",
                    duration_text(equipment.window), ticks, duration_text(period),
                    equipment.max_order, equipment.inputs.size(), equipment.outputs.size(), least,
                    duration_text(least * period)));
  if (ticks > max_window_ticks)
    reader.mistake("window", fmt::format("window {} holds {} samples of {}; at most {} are allowed",
                                         duration_text(equipment.window), ticks,
                                         duration_text(period), max_window_ticks));
}

void check_slide(TableReader& reader, const EquipmentConfig& equipment) {
  const Duration period = equipment.sample_period;
  if (equipment.slide > equipment.window)
    reader.mistake("slide",
                   fmt::format("slide {} is longer than the window {}: telemetry between "
                               "windows would never be used",
                               duration_text(equipment.slide), duration_text(equipment.window)));
  if (equipment.slide % period != 0)
    reader.mistake("slide", fmt::format("slide must be a multiple of sample_period {}; {} is",
                                        duration_text(period),
                                        duration_text((equipment.slide / period + 1) * period)));
}

/// Reads the times of an equipment; what depends on a value that is missing or wrong is not judged.
void read_timing(TableReader& reader, bool signals_and_orders_are_right,
                 EquipmentConfig& equipment) {
  reader.require("sample_period", "\"1s\"");
  reader.require("window", "\"200min\"");
  const auto period = reader.duration("sample_period", millisecond, day);
  const auto hold = reader.duration("hold", millisecond, 30 * day);
  const auto phase = reader.duration("phase", 0, day);
  const auto window = reader.duration("window", second, 3650 * day);
  const auto slide = reader.duration("slide", millisecond, 3650 * day);
  const auto min_interval = reader.duration("min_interval", 0, 3650 * day);
  const auto cycle = reader.duration("cycle", period.value_or(millisecond), 3650 * day);
  if (!period) return;
  equipment.sample_period = *period;
  equipment.sample_hold = hold.value_or(3 * *period);
  if (hold && *hold < *period)
    reader.mistake("hold", fmt::format("hold {} is shorter than sample_period {}: there would be "
                                       "holes between samples",
                                       duration_text(*hold), duration_text(*period)));
  equipment.phase = phase;
  if (phase && *phase >= *period)
    reader.mistake("phase", fmt::format("phase {} must be below sample_period {}: what comes later "
                                        "belongs to the next tick",
                                        duration_text(*phase), duration_text(*period)));
  if (!window || *window < *period) {
    if (window) reader.mistake("window", "window is shorter than sample_period");
    return;
  }
  equipment.window = *window;
  if (signals_and_orders_are_right) check_window(reader, equipment);
  // As long as the validation part, so that each candidate is judged on telemetry that is new.
  const std::int64_t ticks = *window / *period;
  const auto share_ticks =
      static_cast<std::int64_t>(equipment.validation_share * static_cast<double>(ticks));
  equipment.slide = slide.value_or(std::max<std::int64_t>(1, share_ticks) * *period);
  // Shorter than it takes to notice that a champion drifts.
  equipment.min_interval = min_interval.value_or(equipment.slide / 4);
  equipment.cycle = cycle.value_or(std::max<std::int64_t>(1, share_ticks) * *period);
  if (slide || !reader.has("slide")) check_slide(reader, equipment);
}

}  // namespace

void read_equipment(const toml::table& table, ConfigDocument& document,
                    std::vector<EquipmentConfig>& siblings) {
  TableReader reader(table, "[[spacecraft.equipment]]", document);
  EquipmentConfig equipment;
  reader.require("name", "\"BDR\"");
  read_name(reader, "equipment", siblings, equipment);
  const std::size_t before = document.mistakes.size();
  read_signals(reader, equipment);
  read_derived(reader, document, equipment);
  read_regimes(reader, document.mistakes.size() == before, equipment);
  read_order(reader, equipment);
  assign(equipment.horizon, reader.integer_or_auto("horizon", 2, max_horizon));
  if (equipment.horizon && *equipment.horizon < least_horizon(equipment))
    reader.mistake("horizon",
                   fmt::format("horizon {} is too short for orders up to {}; make it at "
                               "least {}, or \"auto\"",
                               *equipment.horizon, equipment.max_order, least_horizon(equipment)));
  assign(equipment.validation_share, reader.number("validation_share", 0.05, 0.8));
  assign(equipment.tune_share, reader.number("tune_share", 0.05, 0.8));
  if (equipment.tune_share + equipment.validation_share > 0.9)
    reader.mistake("tune_share",
                   fmt::format("tune_share {:g} and validation_share {:g} leave less than a tenth "
                               "of the window to identify from; make their sum at most 0.9",
                               equipment.tune_share, equipment.validation_share));
  assign(equipment.min_coverage, reader.number("min_coverage", 0, 1));
  const bool right = document.mistakes.size() == before && !equipment.outputs.empty();
  read_timing(reader, right, equipment);
  assign(equipment.max_mrse_percent, reader.number("max_mrse", 0, 1e6));
  assign(equipment.margin_percent, reader.number("margin", 0, 99));
  assign(equipment.confidence_percent, reader.number("confidence", 50, 99.99));
  if (const auto members = reader.integer("members", 1, max_members))
    equipment.members = static_cast<int>(*members);
  assign(equipment.baseline_mrse_percent, reader.number("baseline_mrse", 0, 1e6));
  read_choice(reader, "approval", equipment.approval,
              {{"automatic", ApprovalPolicy::automatic}, {"by_hand", ApprovalPolicy::by_hand}});
  read_choice(reader, "bias", equipment.bias,
              {{"wait", BiasPolicy::wait}, {"approve", BiasPolicy::approve}});
  read_choice(reader, "on_failure", equipment.on_failure,
              {{"keep", FailurePolicy::keep}, {"withdraw", FailurePolicy::withdraw}});
  read_choice(reader, "screening", equipment.screening, {{"on", true}, {"off", false}});
  reader.refuse_unknown_keys(
      {{"min_fit",
        "remove it; a version has to err less than the mean of the outputs, and max_mrse "
        "limits its error"},
       {"max_disagreement",
        "remove it; a version is compared with the champion on telemetry of "
        "every operating regime"},
       {"confirmation",
        "remove it; every version proves itself on the telemetry after its window, "
        "for as long as that takes, beside at most `members` others"},
       {"unvouched", "use bias, with the same values"}});
  siblings.push_back(std::move(equipment));
}

std::int64_t least_window_ticks(const EquipmentConfig& equipment) {
  const double horizon = equipment.horizon.value_or(equipment.max_order + 1);
  const auto channels = static_cast<double>(equipment.inputs.size() + equipment.outputs.size());
  const double rows = 2 * horizon * (channels + 1);
  return static_cast<std::int64_t>(
      std::ceil(rows / (1 - equipment.tune_share - equipment.validation_share)));
}

}  // namespace reident
