#include <algorithm>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/config_options.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/phase_advice.hpp"
#include "service/cli/verb.hpp"
#include "service/dds/network_cut.hpp"
#include "service/security/material.hpp"
#include "service/support/size_text.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

namespace reident::cli::check_config_verb {
namespace {

using nlohmann::ordered_json;

struct Arguments {
  std::string file;
  bool json = false;
};

void print_json(const ordered_json& object) {
  fmt::print("{}\n", object.dump(2, ' ', false, ordered_json::error_handler_t::replace));
}

int print_mistakes(const Arguments& arguments, const std::vector<ConfigMistake>& mistakes) {
  if (arguments.json) {
    ordered_json list = ordered_json::array();
    for (const ConfigMistake& mistake : mistakes)
      list.push_back({{"line", mistake.line}, {"message", mistake.message}});
    print_json({{"valid", false}, {"mistakes", list}});
  } else {
    for (const ConfigMistake& mistake : mistakes)
      print_error("{}", mistake_text(arguments.file, mistake));
    print_error("reident: {} has {} mistake{}", arguments.file, mistakes.size(),
                mistakes.size() == 1 ? "" : "s");
  }
  return exit_impossible;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string order_text(const EquipmentConfig& equipment) {
  return equipment.min_order == equipment.max_order
             ? fmt::format("{}", equipment.max_order)
             : fmt::format("{} to {}", equipment.min_order, equipment.max_order);
}

std::string signals_text(const EquipmentConfig& equipment) {
  std::string text = joined(equipment.inputs) + " -> " + joined(equipment.outputs);
  for (const DerivedInput& input : equipment.derived)
    text += fmt::format("; {} = {}", input.name, input.expression);
  return text;
}

/// Names of the equipment that a relation is a check of.
std::vector<std::string> checked_by(const Relation& relation, const SpacecraftConfig& spacecraft) {
  std::vector<std::string> names;
  for (const EquipmentConfig& equipment : spacecraft.equipment)
    if (std::find(equipment.relations.begin(), equipment.relations.end(), relation) !=
        equipment.relations.end())
      names.push_back(equipment.name);
  return names;
}

void print_relations(const Config& config) {
  Table table({{"relation"}, {"tolerance", Table::Align::right}, {"checks"}, {"is about 0"}});
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const Relation& relation : spacecraft.relations) {
      const auto names = checked_by(relation, spacecraft);
      table.add({spacecraft.name + "/" + relation.name, fmt::format("{:g}", relation.tolerance),
                 names.empty() ? "no equipment" : joined(names), relation.expression});
    }
  if (!table.empty()) fmt::print("\n{}", table.text(terminal_width()));
}

/// Parameters of the frames that the bound in bytes is shown for.
constexpr std::size_t shown_parameters = 1000;

dds::CutSettings cut_settings(const Config& config) {
  return dds::settings_for({std::chrono::nanoseconds(config.cut), config.rate}, shown_parameters);
}

void print_cut(const Config& config) {
  const dds::CutSettings settings = cut_settings(config);
  fmt::print(
      "network cut of {} at {:g} frames a second: lease {}; a source (--cut {} --rate {:g}/s) "
      "keeps {} frames, with {} parameters at most {}\n",
      duration_text(config.cut), config.rate, duration_text(settings.lease.count()),
      duration_text(config.cut), config.rate, settings.history, shown_parameters,
      size_text(settings.unacknowledged_bytes));
}

/// What is wrong with the folder that the configuration names.
std::vector<ConfigMistake> mistakes_of_security(const Config& config) {
  const auto read = security::read_material(config.security, utc_now());
  std::vector<ConfigMistake> mistakes;
  if (const auto* wrong = std::get_if<std::vector<std::string>>(&read)) {
    for (const std::string& one : *wrong) mistakes.push_back({0, "security: " + one});
  } else if (const auto& material = std::get<security::Material>(read);
             material.role != "service") {
    mistakes.push_back(
        {0, fmt::format("security: {} is of {} {}; reidentd needs a folder of the role service",
                        config.security.string(), material.role, material.name)});
  }
  return mistakes;
}

/// What the telemetry in the database says of the configuration; the service may run. A database
/// that cannot be read says nothing of it but that.
std::vector<std::string> advice(const Config& config) {
  if (!std::filesystem::exists(config.database)) return {};
  try {
    storage::Database database(config.database, storage::Database::Mode::read_only);
    return advised_phases(database, config);
  } catch (const storage::Error& error) {
    return {error.what()};
  }
}

void print_summary(const Config& config) {
  fmt::print("service {} on domain {}, partition {}; database {}\n", config.service_name,
             config.domain, config.partition, config.database.string());
  if (!config.pair.empty())
    fmt::print("one of the pair {}, strength {}\n", config.pair, config.strength);
  if (config.cut > 0) print_cut(config);
  if (!config.security.empty()) fmt::print("secured by {}\n", config.security.string());
  Table table(
      {{"equipment"}, {"every"}, {"window"}, {"slide"}, {"order"}, {"approval"}, {"signals"}});
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      table.add({spacecraft.name + "/" + equipment.name, duration_text(equipment.sample_period),
                 duration_text(equipment.window), duration_text(equipment.slide),
                 order_text(equipment),
                 equipment.approval == ApprovalPolicy::automatic ? "automatic" : "by hand",
                 signals_text(equipment)});
  fmt::print("{}", table.text(terminal_width()));
  print_relations(config);
  for (const std::string& sentence : advice(config)) print_error("reident: {}", sentence);
}

ordered_json derived_json(const std::vector<DerivedInput>& inputs) {
  ordered_json list = ordered_json::array();
  for (const DerivedInput& input : inputs)
    list.push_back({{"name", input.name}, {"expression", input.expression}, {"unit", input.unit}});
  return list;
}

ordered_json relations_json(const Config& config) {
  ordered_json list = ordered_json::array();
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const Relation& relation : spacecraft.relations)
      list.push_back({{"spacecraft", spacecraft.name},
                      {"relation", relation.name},
                      {"expression", relation.expression},
                      {"tolerance", relation.tolerance},
                      {"equipment", checked_by(relation, spacecraft)}});
  return list;
}

void print_summary_json(const Config& config) {
  ordered_json list = ordered_json::array();
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      list.push_back({{"spacecraft", spacecraft.name},
                      {"equipment", equipment.name},
                      {"inputs", equipment.inputs},
                      {"derived", derived_json(equipment.derived)},
                      {"outputs", equipment.outputs},
                      {"sample_period", duration_text(equipment.sample_period)},
                      {"window", duration_text(equipment.window)},
                      {"slide", duration_text(equipment.slide)}});
  ordered_json cut;
  if (config.cut > 0) {
    const dds::CutSettings settings = cut_settings(config);
    cut = {{"cut", duration_text(config.cut)},
           {"rate_per_s", config.rate},
           {"lease", duration_text(settings.lease.count())},
           {"source_history_frames", settings.history},
           {"parameters", shown_parameters},
           {"source_unacknowledged_bytes", settings.unacknowledged_bytes}};
  }
  print_json({{"valid", true},
              {"mistakes", ordered_json::array()},
              {"service", config.service_name},
              {"domain", config.domain},
              {"partition", config.partition},
              {"pair", config.pair.empty() ? ordered_json() : ordered_json(config.pair)},
              {"strength", config.pair.empty() ? ordered_json() : ordered_json(config.strength)},
              {"network_cut", cut},
              {"security", config.security.string()},
              {"database", config.database.string()},
              {"digest", config.digest},
              {"equipment", list},
              {"relations", relations_json(config)},
              {"advice", advice(config)}});
}

int run(const Arguments& arguments) {
  const auto loaded = load_config(arguments.file);
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&loaded))
    return print_mistakes(arguments, *mistakes);
  const auto& config = std::get<Config>(loaded);
  if (!config.security.empty())
    if (const auto mistakes = mistakes_of_security(config); !mistakes.empty())
      return print_mistakes(arguments, mistakes);
  if (arguments.json)
    print_summary_json(config);
  else
    print_summary(config);
  return exit_done;
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("file", arguments->file, "configuration of reidentd")->required();
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer(
      "Example:\n  reident check-config reident.toml\nExit status: 2 when there is a mistake.");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"check-config", "Check a configuration: every mistake at once, each with its line",
     WorksOn::files, declare});

}  // namespace

}  // namespace reident::cli::check_config_verb
