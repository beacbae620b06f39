#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/history_access.hpp"
#include "service/cli/model_comparison.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/range_options.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/model/model_json.hpp"
#include "service/operations/commands.hpp"
#include "service/review/model_run.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::compare_verb {
namespace {

using nlohmann::ordered_json;
using RunResult = std::variant<ModelRun, std::string>;

struct Arguments {
  HistoryAccessOptions access;
  std::string equipment;
  std::string first, second;
  RangeOptions range;
  bool json = false;
};

/// All that is printed.
struct Outcome {
  StoredVersion a, b;
  ModelComparison models;
  storage::TimeRange range;  // of the errors
  storage::Time run_from = 0;
  RunResult run_a, run_b;
};

std::variant<StoredVersion, Refusal> story_of(const history::HistoryReader& history,
                                              Subject subject, const std::string& number) {
  subject.version = whole_number(number);
  if (!subject.version)
    return Refusal{fmt::format("{} is no version; give the numbers of two, such as 3 5", number)};
  auto story = find_stored_version(history, subject);
  if (const auto* found = std::get_if<StoredVersion>(&story);
      found != nullptr && !is_well_formed(found->model.dynamics))
    return Refusal{fmt::format("the stored model of version {} is damaged", number)};
  return story;
}

std::variant<Outcome, Refusal> compare(const Readers& readers, const Arguments& arguments) {
  const auto subject = parse_subject(arguments.equipment);
  if (const auto* refusal = std::get_if<Refusal>(&subject)) return *refusal;
  auto a = story_of(readers.history, std::get<Subject>(subject), arguments.first);
  if (const auto* refusal = std::get_if<Refusal>(&a)) return *refusal;
  auto b = story_of(readers.history, std::get<Subject>(subject), arguments.second);
  if (const auto* refusal = std::get_if<Refusal>(&b)) return *refusal;
  Outcome outcome{std::get<StoredVersion>(std::move(a)),
                  std::get<StoredVersion>(std::move(b)),
                  {},
                  {},
                  0,
                  "",
                  ""};
  const EquipmentModel &model_a = outcome.a.model, &model_b = outcome.b.model;
  if (signal_names(model_a.outputs) != signal_names(model_b.outputs))
    return Refusal{"the two versions have other outputs and cannot be compared"};
  const auto range = range_of(arguments.range, model_b.validated_on);
  if (const auto* refusal = std::get_if<Refusal>(&range)) return *refusal;
  outcome.range = std::get<storage::TimeRange>(range);
  // Where nothing else is asked for, as the gate ran them: the state is carried into the part.
  const bool chosen = arguments.range.begin || arguments.range.end;
  outcome.run_from = chosen ? outcome.range.begin : model_b.identified_from.begin;
  outcome.models =
      compare_models(model_a, outcome.a.version.number, model_b, outcome.b.version.number);
  const storage::TimeRange run{outcome.run_from, outcome.range.end};
  outcome.run_a = run_model(readers.telemetry, model_a, run, outcome.range.begin);
  outcome.run_b = run_model(readers.telemetry, model_b, run, outcome.range.begin);
  return outcome;
}

ordered_json poles_json(const std::vector<Pole>& poles) {
  ordered_json array = ordered_json::array();
  for (const Pole& pole : poles)
    array.push_back({{"real", pole.value.real()},
                     {"imag", pole.value.imag()},
                     {"time_constant_s", pole.time_constant_s},
                     {"frequency_hz", pole.frequency_hz}});
  return array;
}

ordered_json version_json(const StoredVersion& story, const std::vector<Pole>& poles,
                          const RunResult& run) {
  ordered_json inputs = ordered_json::array();
  for (const Signal& input : story.model.inputs)
    inputs.push_back(
        {{"name", input.name}, {"unit", input.unit}, {"expression", input.expression}});
  ordered_json json = {{"version", story.version.number},
                       {"status", story.version.status},
                       {"order", story.model.dynamics.order()},
                       {"sample_period_s", story.model.dynamics.period_s},
                       {"inputs", inputs},
                       {"poles", poles_json(poles)}};
  if (const auto* reason = std::get_if<std::string>(&run)) {
    json["errors"] = {{"reason", *reason}};
    return json;
  }
  const identification::Score& score = std::get<ModelRun>(run).score;
  json["errors"] = {{"rows", score.rows},
                    {"mrse_percent", to_json(score.mrse_percent)},
                    {"fit_percent", to_json(score.fit_percent)}};
  if (const auto& tracked = std::get<ModelRun>(run).tracked)
    json["errors"]["tracking_mrse_percent"] = to_json(tracked->score.mrse_percent);
  return json;
}

void print_json(const Outcome& outcome) {
  const ModelComparison& models = outcome.models;
  ordered_json channels = ordered_json::array();
  for (const Channel& channel : models.channels) {
    ordered_json json = {{"output", channel.output}, {"input", channel.input}};
    json["static_gain"] = {channel.gain_a ? ordered_json(*channel.gain_a) : ordered_json(nullptr),
                           channel.gain_b ? ordered_json(*channel.gain_b) : ordered_json(nullptr)};
    json["step_response"] = {channel.steps_a, channel.steps_b};
    channels.push_back(std::move(json));
  }
  const ordered_json object = {{"spacecraft", outcome.a.version.spacecraft},
                               {"equipment", outcome.a.version.equipment},
                               {"run_from", time_text(outcome.run_from)},
                               {"begin", time_text(outcome.range.begin)},
                               {"end", time_text(outcome.range.end)},
                               {"versions",
                                {version_json(outcome.a, models.poles_a, outcome.run_a),
                                 version_json(outcome.b, models.poles_b, outcome.run_b)}},
                               {"input_differences", models.input_differences},
                               {"step_times_s", models.times_s},
                               {"channels", channels}};
  fmt::print("{}\n", object.dump(2, ' ', false, ordered_json::error_handler_t::replace));
}

std::string heading(const StoredVersion& story) {
  return fmt::format("version {}", story.version.number);
}

void print_poles(const Outcome& outcome) {
  Table table({{"poles"},
               {"value"},
               {"time constant s", Table::Align::right},
               {"frequency Hz", Table::Align::right}});
  for (const auto& [story, poles] : {std::pair(&outcome.a, &outcome.models.poles_a),
                                     std::pair(&outcome.b, &outcome.models.poles_b)})
    for (const Pole& pole : *poles)
      table.add({heading(*story),
                 pole.value.imag() == 0
                     ? fmt::format("{:.6g}", pole.value.real())
                     : fmt::format("{:.6g} \u00b1 {:.6g}j", pole.value.real(), pole.value.imag()),
                 fmt::format("{:.4g}", pole.time_constant_s),
                 pole.frequency_hz == 0 ? "-" : fmt::format("{:.4g}", pole.frequency_hz)});
  fmt::print("{}\n", table.text(0));
}

std::string number_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.4g}", *value) : "-";
}

void print_gains(const Outcome& outcome) {
  Table table({{"output"},
               {"input"},
               {"static gain " + heading(outcome.a), Table::Align::right},
               {heading(outcome.b), Table::Align::right}});
  for (const Channel& channel : outcome.models.channels)
    table.add(
        {channel.output, channel.input, number_text(channel.gain_a), number_text(channel.gain_b)});
  fmt::print("{}\n", table.text(0));
}

/// A row for each time, two columns for each channel.
void print_steps(const Outcome& outcome) {
  for (const Channel& channel : outcome.models.channels) {
    Table table({{"time s", Table::Align::right},
                 {heading(outcome.a), Table::Align::right},
                 {heading(outcome.b), Table::Align::right}});
    const auto at = [](const std::vector<double>& values, std::size_t i) {
      return values.empty() ? std::nullopt : std::optional(values[i]);
    };
    for (std::size_t i = 0; i < outcome.models.times_s.size(); ++i)
      table.add({fmt::format("{:g}", outcome.models.times_s[i]),
                 number_text(at(channel.steps_a, i)), number_text(at(channel.steps_b, i))});
    fmt::print("{} after a step of 1 of {}:\n{}\n", channel.output, channel.input, table.text(0));
  }
}

void print_errors(const Outcome& outcome) {
  Table table({{"version"},
               {"output"},
               {"rows", Table::Align::right},
               {"MRSE %", Table::Align::right},
               {"fit %", Table::Align::right},
               {"following telemetry: MRSE %", Table::Align::right}});
  std::string reasons;
  for (const auto& [story, run] :
       {std::pair(&outcome.a, &outcome.run_a), std::pair(&outcome.b, &outcome.run_b)}) {
    if (const auto* reason = std::get_if<std::string>(run)) {
      reasons += fmt::format("{} cannot be run there: {}\n", heading(*story), *reason);
      continue;
    }
    const auto& [data, y_hat, score, tracked] = std::get<ModelRun>(*run);
    for (std::size_t q = 0; q < story->model.outputs.size(); ++q) {
      const auto at = static_cast<identification::Index>(q);
      table.add({fmt::format("{}", story->version.number), story->model.outputs[q].name,
                 fmt::format("{}", score.rows), fmt::format("{:.4g}", score.mrse_percent(at)),
                 fmt::format("{:.4g}", score.fit_percent(at)),
                 tracked ? fmt::format("{:.4g}", tracked->score.mrse_percent(at)) : "-"});
    }
  }
  fmt::print("free run from {}, errors from {} to {}:\n{}{}", time_text(outcome.run_from),
             time_text(outcome.range.begin), time_text(outcome.range.end),
             table.empty() ? "" : table.text(0), reasons);
}

void print_text(const Outcome& outcome) {
  for (const StoredVersion* story : {&outcome.a, &outcome.b})
    fmt::print("{} {} ({}): {}, sample period {:g} s\n",
               full_name({story->version.spacecraft, story->version.equipment}), heading(*story),
               story->version.status, story->model.method, story->model.dynamics.period_s);
  if (outcome.models.input_differences.empty()) fmt::print("inputs: the same\n");
  for (const std::string& sentence : outcome.models.input_differences)
    fmt::print("inputs: {}\n", sentence);
  fmt::print("\n");
  print_errors(outcome);
  fmt::print("\n");
  print_poles(outcome);
  print_gains(outcome);
  print_steps(outcome);
}

int run(const Arguments& arguments) {
  return with_readers(arguments.access, [&](const Readers& readers) {
    const auto outcome = compare(readers, arguments);
    if (const auto* refusal = std::get_if<Refusal>(&outcome)) return refuse(*refusal);
    if (arguments.json)
      print_json(std::get<Outcome>(outcome));
    else
      print_text(std::get<Outcome>(outcome));
    return static_cast<int>(exit_done);
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("equipment", arguments->equipment, "SPACECRAFT/EQUIPMENT")->required();
  command.add_option("first", arguments->first, "number of a version")->required();
  command.add_option("second", arguments->second, "number of another")->required();
  add_range_options(command, arguments->range, "the validation part of the second version");
  add_access_options(command, arguments->access);
  command.add_flag("--json", arguments->json, "one JSON object");
  command.footer("Example:\n  reident compare CBERS-4/BDR 3 5 --config reident.toml");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"compare", "Compare two versions: poles, gains, step responses, errors on archived telemetry",
     WorksOn::history, declare});

}  // namespace

}  // namespace reident::cli::compare_verb
