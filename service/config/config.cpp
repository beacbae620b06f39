#include "service/config/config.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "identification/search/identify.hpp"
#include "service/config/config_tables.hpp"
#include "service/support/rate_text.hpp"
#include "service/support/sha256.hpp"
#include "service/support/time_text.hpp"

namespace reident {
namespace {

constexpr std::uint64_t least_max_size = 1'000'000;
constexpr double least_tolerance = 1e-12;
constexpr double max_rate = 10'000;  // frames a second

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

}  // namespace

std::string name_mistake(std::string_view name) {
  constexpr std::size_t max_name_bytes = 128;
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

}  // namespace reident
