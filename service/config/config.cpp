#include "service/config/config.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include <fmt/format.h>

#include "identification/search/identify.hpp"
#include "service/config/config_document.hpp"
#include "service/model/regime_inputs.hpp"
#include "service/support/rate_text.hpp"
#include "service/support/sha256.hpp"
#include "service/support/time_text.hpp"

namespace reident {
namespace {

constexpr Duration millisecond = 1'000'000;
constexpr Duration second = 1'000 * millisecond;
constexpr Duration minute = 60 * second;
constexpr Duration hour = 60 * minute;
constexpr Duration day = 24 * hour;

constexpr std::size_t max_file_bytes = 4u << 20;
constexpr std::size_t max_name_bytes = 128;
constexpr std::int64_t max_window_ticks = 50'000'000;  // 8 bytes for each channel of each
constexpr std::uint64_t least_max_size = 1'000'000;
constexpr double least_tolerance = 1e-12;
constexpr double max_rate = 10'000;  // frames a second
constexpr int max_order = 100;
constexpr int max_members = 100;
constexpr int max_horizon = 500;

template <class Target, class Value>
void assign(Target& target, const std::optional<Value>& value) {
  if (value) target = static_cast<Target>(*value);
}

/// What is wrong with a name that becomes a DDS key, a part of SPACECRAFT/EQUIPMENT@VERSION and a
/// column of a terminal; empty when nothing is.
std::string name_mistake(std::string_view name) {
  if (name.empty()) return "must not be empty";
  if (name.size() > max_name_bytes)
    return fmt::format("must have at most {} bytes, not {}", max_name_bytes, name.size());
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (std::any_of(name.begin(), name.end(), is_control)) return "must not hold control characters";
  if (name.front() == ' ' || name.back() == ' ') return "must not begin or end with a blank";
  return {};
}

void check_name(TableReader& reader, std::string_view key, const std::string& name) {
  std::string mistake = name_mistake(name);
  if (mistake.empty() && name.find_first_of("/@") != std::string::npos)
    mistake = "must not hold / or @, which separate spacecraft, equipment and version";
  if (!mistake.empty()) reader.mistake(key, fmt::format("{} {}", key, mistake));
}

/// The name of one of several, which those before it do not have; `kind` is what they are.
template <class Named>
void read_name(TableReader& reader, std::string_view kind, const std::vector<Named>& siblings,
               Named& target) {
  const std::optional<std::string> name = reader.text("name");
  if (!name) return;
  target.name = *name;
  check_name(reader, "name", *name);
  const auto same = [&](const Named& other) { return other.name == *name; };
  if (std::any_of(siblings.begin(), siblings.end(), same))
    reader.mistake("name", fmt::format("name {} is taken by {} {} above", *name,
                                       kind == "equipment" ? "an" : "a", kind));
  reader.set_title(fmt::format("{} {}:", kind, *name));
}

template <class Enum>
void read_choice(TableReader& reader, std::string_view key, Enum& target,
                 std::initializer_list<std::pair<std::string_view, Enum>> choices) {
  const std::optional<std::string> text = reader.text(key);
  if (!text) return;
  std::string allowed;
  for (const auto& [name, value] : choices) {
    if (*text == name) {
      target = value;
      return;
    }
    allowed += fmt::format("{}\"{}\"", allowed.empty() ? "" : ", ", name);
  }
  reader.mistake(key, fmt::format("{} must be one of {}, not \"{}\"", key, allowed, *text));
}

void read_service(const toml::table& table, ConfigDocument& document, Config& config) {
  TableReader reader(table, "[service]", document);
  if (const auto name = reader.text("name")) {
    check_name(reader, "name", *name);
    config.service_name = *name;
  }
  read_choice<std::string>(
      reader, "log_level", config.log_level,
      {{"debug", "debug"}, {"info", "info"}, {"warning", "warning"}, {"error", "error"}});
  assign(config.workers, reader.integer("workers", 1, 256));
  const auto strength = reader.integer("strength", 1, 2);
  assign(config.strength, strength);
  if (reader.boolean("standby").value_or(false)) {
    config.pair = config.service_name;
    config.service_name = fmt::format("{}-{}", config.pair, config.strength);
    if (!strength)
      reader.mistake(
          "standby",
          "a pair of services needs a strength each: strength = 2 for the one that leads "
          "when both start, and 1 for the other");
  } else if (strength) {
    reader.mistake("strength", "strength counts in a pair alone: add standby = true, or remove it");
  }
  reader.refuse_unknown_keys();
}

void read_archive(const toml::table& table, ConfigDocument& document, Config& config) {
  TableReader reader(table, "[archive]", document);
  if (const auto path = reader.text("database")) {
    if (path->empty() || path->find('\0') != std::string::npos)
      reader.mistake("database", "database must be the path of a file, such as \"reident.db\"");
    config.database = *path;
  }
  read_choice(reader, "durability", config.durability,
              {{"power_cut", storage::Durability::power_cut}, {"kill", storage::Durability::kill}});
  assign(config.batch_frames, reader.integer("batch_frames", 1, 1'000'000));
  assign(config.recent_samples, reader.integer("recent_samples", 10'000, 100'000'000));
  assign(config.batch_delay, reader.duration("batch_delay", millisecond, minute));
  config.keep = reader.duration("keep", hour, 36500 * day);
  config.max_size = reader.size("max_size", least_max_size);
  reader.refuse_unknown_keys();
}

void read_cut(TableReader& reader, Config& config) {
  assign(config.cut, reader.duration("cut", second, day));
  if (const auto text = reader.text("rate")) {
    config.rate = parse_rate(*text).value_or(0);
    if (config.rate <= 0 || config.rate > max_rate)
      reader.mistake("rate", fmt::format("rate must be the frames that a source sends, such as "
                                         "\"100/s\" or \"6/min\", at most \"{:g}/s\", not \"{}\"",
                                         max_rate, *text));
  }
  if (reader.has("cut") != reader.has("rate"))
    reader.mistake(reader.has("cut") ? "cut" : "rate",
                   "cut and rate belong together: what is kept for a cut of the network is its "
                   "length times the rate of frames");
}

void read_dds(const toml::table& table, ConfigDocument& document, Config& config) {
  TableReader reader(table, "[dds]", document);
  assign(config.domain, reader.integer("domain", 0, 230));
  if (const auto partition = reader.text("partition")) {
    const std::string mistake = name_mistake(*partition);
    if (!mistake.empty()) {
      reader.mistake("partition", "partition " + mistake);
    } else if (partition->find_first_of("*?[]") != std::string::npos) {
      reader.mistake("partition",
                     "partition must be one name: with * ? [ or ] it would match others too");
    }
    config.partition = *partition;
  }
  read_cut(reader, config);
  if (const auto security = reader.text("security")) {
    if (security->empty() || security->find('\0') != std::string::npos)
      reader.mistake("security",
                     "security must be a folder that 'reident security grant' made; leave the key "
                     "out where the domain is not secured");
    config.security = *security;
  }
  reader.refuse_unknown_keys();
}

void read_limits(const toml::table& table, ConfigDocument& document, Config& config) {
  TableReader reader(table, "[limits]", document);
  assign(config.queue_frames, reader.integer("queue_frames", 1, 10'000'000));
  assign(config.queue_mib, reader.integer("queue_mib", 1, 1'000'000));
  assign(config.max_frame_samples, reader.integer("max_frame_samples", 1, 10'000'000));
  assign(config.max_clock_lead, reader.duration("max_clock_lead", 0, 365 * day));
  assign(config.settle, reader.duration("settle", 0, day));
  reader.refuse_unknown_keys();
}

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
void read_regimes(TableReader& reader, EquipmentConfig& equipment) {
  const auto regimes = reader.texts("regimes");
  if (!regimes || equipment.inputs.empty()) return;
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
  const auto window = reader.duration("window", second, 3650 * day);
  const auto slide = reader.duration("slide", millisecond, 3650 * day);
  if (!period) return;
  equipment.sample_period = *period;
  equipment.sample_hold = hold.value_or(3 * *period);
  if (hold && *hold < *period)
    reader.mistake("hold", fmt::format("hold {} is shorter than sample_period {}: there would be "
                                       "holes between samples",
                                       duration_text(*hold), duration_text(*period)));
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
  equipment.min_interval =
      reader.duration("min_interval", 0, 3650 * day).value_or(equipment.slide / 4);
  const auto cycle = reader.duration("cycle", *period, 3650 * day);
  equipment.cycle = cycle.value_or(std::max<std::int64_t>(1, share_ticks) * *period);
  if (slide || !reader.has("slide")) check_slide(reader, equipment);
}

void read_equipment(const toml::table& table, ConfigDocument& document,
                    std::vector<EquipmentConfig>& siblings) {
  TableReader reader(table, "[[spacecraft.equipment]]", document);
  EquipmentConfig equipment;
  reader.require("name", "\"BDR\"");
  read_name(reader, "equipment", siblings, equipment);
  const std::size_t before = document.mistakes.size();
  read_signals(reader, equipment);
  read_derived(reader, document, equipment);
  if (document.mistakes.size() == before) read_regimes(reader, equipment);
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

std::string expression_mistake(const std::string& text) {
  const auto parsed = Expression::parse(text);
  if (const auto* mistake = std::get_if<ExpressionMistake>(&parsed)) return mistake->message;
  if (std::get<Expression>(parsed).variables().empty())
    return "uses no parameter; name the parameters that it binds";
  return {};
}

void read_relation(const toml::table& table, ConfigDocument& document,
                   std::vector<Relation>& siblings) {
  TableReader reader(table, "[[spacecraft.relation]]", document);
  Relation relation;
  reader.require("name", "\"bus currents\"");
  read_name(reader, "relation", siblings, relation);
  reader.require("expression", "\"I_SG2 + I_BDROUT - I_BUS\"");
  if (const auto expression = reader.text("expression")) {
    relation.expression = *expression;
    if (const std::string mistake = expression_mistake(*expression); !mistake.empty())
      reader.mistake("expression", fmt::format("expression {}", mistake));
  }
  reader.require("tolerance", "0.5");
  assign(relation.tolerance, reader.number("tolerance", least_tolerance, 1e12));
  reader.refuse_unknown_keys();
  siblings.push_back(std::move(relation));
}

/// Gives each equipment the relations that name one of its parameters. Of what was read without a
/// mistake.
void apply_relations(SpacecraftConfig& spacecraft) {
  for (EquipmentConfig& equipment : spacecraft.equipment) {
    std::vector<std::string> own =
        InputExpressions(equipment.inputs, equipment.derived).parameters();
    own.insert(own.end(), equipment.outputs.begin(), equipment.outputs.end());
    for (const Relation& relation : spacecraft.relations) {
      const auto parsed = Expression::parse(relation.expression);
      const auto& bound = std::get<Expression>(parsed).variables();
      if (std::find_first_of(own.begin(), own.end(), bound.begin(), bound.end()) != own.end())
        equipment.relations.push_back(relation);
    }
  }
}

void read_spacecraft(const toml::table& table, ConfigDocument& document, Config& config) {
  TableReader reader(table, "[[spacecraft]]", document);
  SpacecraftConfig spacecraft;
  reader.require("name", "\"CBERS-4\"");
  read_name(reader, "spacecraft", config.spacecraft, spacecraft);
  const std::vector<const toml::table*> tables = reader.sections("equipment");
  if (!reader.has("equipment") && document.complete)
    reader.mistake("equipment", "has no equipment; add [[spacecraft.equipment]]");
  for (const toml::table* equipment : tables)
    read_equipment(*equipment, document, spacecraft.equipment);
  for (const toml::table* relation : reader.sections("relation"))
    read_relation(*relation, document, spacecraft.relations);
  reader.refuse_unknown_keys();
  if (document.mistakes.empty()) apply_relations(spacecraft);
  config.spacecraft.push_back(std::move(spacecraft));
}

/// Telemetry that goes before a window has used it would never be used.
void check_keep(const toml::table& archive, ConfigDocument& document, const Config& config) {
  if (!config.keep) return;
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      if (const Duration needed = equipment.window + equipment.slide; *config.keep < needed)
        return TableReader(archive, "[archive]", document)
            .mistake("keep", fmt::format("keep {} is shorter than window and slide of {}/{}; make "
                                         "it at least {}",
                                         duration_text(*config.keep), spacecraft.name,
                                         equipment.name, duration_text(needed)));
}

void read_all(ConfigDocument& document, Config& config) {
  const toml::table& root = document.table;
  TableReader reader(root, "the file:", document);
  if (const toml::table* table = reader.section("service")) read_service(*table, document, config);
  if (const toml::table* table = reader.section("archive")) read_archive(*table, document, config);
  if (const toml::table* table = reader.section("dds")) read_dds(*table, document, config);
  if (const toml::table* table = reader.section("limits")) read_limits(*table, document, config);
  for (const toml::table* table : reader.sections("spacecraft"))
    read_spacecraft(*table, document, config);
  if (const toml::table* table = reader.section("archive")) check_keep(*table, document, config);
  if (!reader.has("spacecraft") && document.complete)
    document.mistakes.push_back(
        {0, "there is no spacecraft; add [[spacecraft]] with a name and equipment"});
  reader.refuse_unknown_keys();
}

std::variant<std::string, ConfigMistake> read_file(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    return ConfigMistake{0, "this is a folder; name the configuration file in it"};
  std::ifstream file(path, std::ios::binary);
  if (!file)
    return ConfigMistake{0,
                         fmt::format("cannot be read: {}", std::generic_category().message(errno))};
  std::string text(max_file_bytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) return ConfigMistake{0, "cannot be read to its end"};
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > max_file_bytes)
    return ConfigMistake{
        0, fmt::format("is larger than {} MiB; this is no configuration", max_file_bytes >> 20)};
  return text;
}

}  // namespace

std::variant<Config, std::vector<ConfigMistake>> parse_config(std::string_view text,
                                                              const std::filesystem::path& folder) {
  Config config;
  config.database = "reident.db";
  config.batch_delay = 100 * millisecond;
  config.max_clock_lead = hour;
  config.settle = second;
  ConfigDocument document = parse_document(text);
  if (document.readable) read_all(document, config);
  if (!document.mistakes.empty()) {
    std::stable_sort(
        document.mistakes.begin(), document.mistakes.end(),
        [](const ConfigMistake& a, const ConfigMistake& b) { return a.line < b.line; });
    return std::move(document.mistakes);
  }
  if (config.database.is_relative()) config.database = folder / config.database;
  if (!config.security.empty() && config.security.is_relative())
    config.security = folder / config.security;
  config.digest = sha256_hex(text);
  return config;
}

std::variant<Config, std::vector<ConfigMistake>> load_config(const std::filesystem::path& path) {
  const std::variant<std::string, ConfigMistake> read = read_file(path);
  if (const auto* mistake = std::get_if<ConfigMistake>(&read)) return std::vector{*mistake};
  return parse_config(std::get<std::string>(read), path.parent_path());
}

std::int64_t least_window_ticks(const EquipmentConfig& equipment) {
  const double horizon = equipment.horizon.value_or(equipment.max_order + 1);
  const auto channels = static_cast<double>(equipment.inputs.size() + equipment.outputs.size());
  const double rows = 2 * horizon * (channels + 1);
  return static_cast<std::int64_t>(
      std::ceil(rows / (1 - equipment.tune_share - equipment.validation_share)));
}

}  // namespace reident
