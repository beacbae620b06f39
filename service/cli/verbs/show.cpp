#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>

#include "service/cli/history_access.hpp"
#include "service/cli/output/model_text.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/model/diagnostics_json.hpp"
#include "service/model/model_json.hpp"
#include "service/model/reasons.hpp"
#include "service/operations/commands.hpp"
#include "service/review/evidence.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::show_verb {
namespace {

using nlohmann::ordered_json;
using storage::Decision;

struct Arguments {
  HistoryAccessOptions access;
  std::string subject;
  bool json = false;
};

ordered_json range_json(const storage::TimeRange& range) {
  return {{"begin", time_text(range.begin)}, {"end", time_text(range.end)}};
}

/// null for a damaged model, which has no logarithm to look for.
ordered_json continuous_json(const identification::StateSpaceModel& dynamics) {
  if (!is_well_formed(dynamics)) return nullptr;
  return to_json(to_continuous(dynamics));
}

/// null for a version from before it was kept.
ordered_json provenance_json(const storage::Version& version) {
  if (version.provenance_json.empty()) return nullptr;
  return ordered_json::parse(version.provenance_json, nullptr, false);
}

void print_json(const StoredVersion& story) {
  const ordered_json object = {
      {"spacecraft", story.version.spacecraft},
      {"equipment", story.version.equipment},
      {"version", story.version.number},
      {"status", story.version.status},
      {"digest", story.version.digest},
      {"digest_matches", story.digest_matches},
      {"created", time_text(story.version.created)},
      {"window", range_json(story.version.window)},
      {"trigger", story.attempt.trigger},
      {"outcome", story.attempt.outcome},
      {"reason", story.attempt.reason},
      {"evidence", evidence_of(story.attempt)},
      {"decisions", decisions_json(story.decisions)},
      {"parent", story.version.parent ? ordered_json(*story.version.parent) : ordered_json()},
      {"hold", story.hold ? hold_json(*story.hold) : ordered_json()},
      {"samples_digest", story.version.samples_digest},
      {"provenance", provenance_json(story.version)},
      {"configuration_digest", story.attempt.configuration_digest},
      {"program_version", story.attempt.program_version},
      {"model", to_json(story.model)},
      {"continuous", continuous_json(story.model.dynamics)}};
  fmt::print("{}\n", object.dump(2, ' ', false, ordered_json::error_handler_t::replace));
}

std::string range_text(const storage::TimeRange& range) {
  return fmt::format("{} to {} ({})", time_text(range.begin), time_text(range.end),
                     duration_text(range.end - range.begin));
}

std::string signals_text(const EquipmentModel& model) {
  Table table({{"signal"},
               {""},
               {"unit"},
               {"lowest", Table::Align::right},
               {"highest", Table::Align::right}});
  for (const auto& [kind, signals] :
       {std::pair("input", &model.inputs), std::pair("output", &model.outputs)})
    for (const Signal& signal : *signals)
      table.add({signal.name, kind, signal.unit, fmt::format("{:.6g}", signal.low),
                 fmt::format("{:.6g}", signal.high)});
  std::string text = table.text(0);
  for (const DerivedInput& input : derived_inputs(model.inputs))
    text += fmt::format("{} = {}\n", input.name, input.expression);
  return text;
}

std::string scores_text(const EquipmentModel& model) {
  Table table({{"output"},
               {"MRSE %", Table::Align::right},
               {"fit %", Table::Align::right},
               {"following telemetry: MRSE %", Table::Align::right}});
  for (std::size_t q = 0; q < model.outputs.size(); ++q) {
    const auto at = static_cast<Eigen::Index>(q);
    table.add({model.outputs[q].name, fmt::format("{:.4g}", model.validation.mrse_percent(at)),
               fmt::format("{:.4g}", model.validation.fit_percent(at)),
               model.tracking ? fmt::format("{:.4g}", model.tracking->validation.mrse_percent(at))
                              : "-"});
  }
  return table.text(0);
}

std::string champion_text(const ordered_json& evidence) {
  const auto champion = evidence.find("champion");
  if (champion == evidence.end() || !champion->is_object()) return "";
  return fmt::format("the champion of that time, version {}, on the same rows: MRSE {} %\n",
                     evidence_number(*champion, "version"),
                     evidence_number(*champion, "mrse_percent"));
}

std::string decisions_text(const std::vector<Decision>& decisions) {
  Table table({{"decided (UTC)"}, {"what"}, {"by"}, {"reason"}});
  for (const Decision& decision : decisions)
    table.add({time_text(decision.time), std::string(past(decision.kind)), decision.actor,
               decision.reason});
  return table.text(terminal_width());
}

void print_continuous(
    const std::variant<identification::ContinuousModel, identification::Verdict>& continuous) {
  fmt::print("{}", continuous_text(continuous));
  if (const auto* model = std::get_if<identification::ContinuousModel>(&continuous))
    fmt::print("dx/dt = A x + B (u - u0), C, D, u0 and y0 as above\n{}{}",
               matrix_text("A", model->A), matrix_text("B", model->B));
}

void print_story(const StoredVersion& story) {
  const EquipmentModel& model = story.model;
  const identification::StateSpaceModel& dynamics = model.dynamics;
  fmt::print("{} version {}: {}\n", full_name({model.spacecraft, model.equipment}),
             story.version.number, story.version.status);
  fmt::print("window          {}\n", range_text(story.version.window));
  fmt::print("identified from {}\n", range_text(model.identified_from));
  if (const auto tune = tuned_on(story.version))
    fmt::print("chosen by       {}\n", range_text(*tune));
  fmt::print("validated on    {}\n", range_text(model.validated_on));
  fmt::print("trigger         {}\n", story.attempt.trigger);
  fmt::print("judged against  {}\n", story.version.parent
                                         ? fmt::format("version {}", *story.version.parent)
                                         : "no champion");
  fmt::print("method          {}, sample period {:g} s{}\n", model.method, dynamics.period_s,
             model.phase_ns ? ", phase " + duration_text(*model.phase_ns) : "");
  fmt::print("poles           {} (spectral radius {:.6g})\n", poles_text(dynamics),
             spectral_radius(dynamics));
  fmt::print("digest          {}{}\n", story.version.digest,
             story.digest_matches ? "" : " DOES NOT MATCH the stored model");
  if (!story.version.samples_digest.empty())
    fmt::print("samples         {}\n", story.version.samples_digest);
  fmt::print("configuration   {}\nprogram         {}\n", story.attempt.configuration_digest,
             story.attempt.program_version);
  fmt::print("\n{}\n", signals_text(model));
  fmt::print("free run over {} rows that the identification did not use:\n{}{}\n",
             model.validation.rows, scores_text(model), champion_text(evidence_of(story.attempt)));
  fmt::print("{}\n", decisions_text(story.decisions));
  if (story.hold)
    fmt::print("{}\n", hold_text({story.version.spacecraft, story.version.equipment}, *story.hold));
  fmt::print("x[k+1] = A x[k] + B (u[k] - u0),  y[k] = C x[k] + D (u[k] - u0) + y0\n");
  fmt::print("{}{}{}{}{}{}{}", matrix_text("A", dynamics.A), matrix_text("B", dynamics.B),
             matrix_text("C", dynamics.C), matrix_text("D", dynamics.D),
             matrix_text("K", dynamics.K), matrix_text("u0", dynamics.u0.transpose()),
             matrix_text("y0", dynamics.y0.transpose()));
  if (is_well_formed(dynamics)) print_continuous(to_continuous(dynamics));
}

int run(const Arguments& arguments) {
  return with_version(arguments.access, arguments.subject,
                      [&](const Readers&, const StoredVersion& story) {
                        if (arguments.json)
                          print_json(story);
                        else
                          print_story(story);
                        return static_cast<int>(exit_done);
                      });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_version_argument(command, arguments->subject);
  add_access_options(command, arguments->access);
  command.add_flag("--json", arguments->json, "one JSON object with the matrices");
  command.footer("Example:\n  reident show CBERS-4/BDR@3 --config reident.toml");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"show", "Show all that is stored about one version of a model",
                                   WorksOn::history, declare});

}  // namespace

}  // namespace reident::cli::show_verb
