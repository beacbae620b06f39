#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "service/cli/history_access.hpp"
#include "service/cli/output/model_text.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/model/reasons.hpp"
#include "service/operations/commands.hpp"
#include "service/review/evidence.hpp"
#include "service/review/verdict.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::why_verb {
namespace {

using nlohmann::ordered_json;
using Sentences = std::vector<std::string>;

struct Arguments {
  HistoryAccessOptions access;
  std::string subject;
  bool json = false;
};

const ordered_json* member(const ordered_json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? nullptr : &*found;
}

std::optional<double> number(const ordered_json& object, const char* key) {
  const ordered_json* value = member(object, key);
  return value && value->is_number() ? std::optional(value->get<double>()) : std::nullopt;
}

std::string figure(const ordered_json& object, const char* key) {
  return evidence_number(object, key);
}

void window_sentences(const StoredVersion& story, const ordered_json& evidence,
                      Sentences& sentences) {
  const storage::TimeRange window = story.version.window;
  sentences.push_back(fmt::format("The window from {} to {} ({}) was tried because of: {}.",
                                  time_text(window.begin), time_text(window.end),
                                  duration_text(window.end - window.begin), story.attempt.trigger));
  if (member(evidence, "rows_tuned"))
    sentences.push_back(fmt::format(
        "{} rows identified a model, the next {} chose its order and poles, both fitted its B, D "
        "and offset, and {} that neither had seen judged it.",
        figure(evidence, "rows_identified"), figure(evidence, "rows_tuned"),
        figure(evidence, "rows_validated")));
  if (const ordered_json* adapted = member(evidence, "adapted"))
    sentences.push_back(
        fmt::format("The model identified from the window errs by {} % there, version {} adapted "
                    "to it (A and C "
                    "stay) by {} %: the better one is the candidate.",
                    figure(*adapted, "identified_mrse_percent"), figure(*adapted, "version"),
                    figure(*adapted, "mrse_percent")));
  if (member(evidence, "static_mrse_percent"))
    sentences.push_back(
        fmt::format("A static gain errs by {} % there.", figure(evidence, "static_mrse_percent")));
  sentences.push_back(fmt::format("It is of order {} ({}); its poles are {}.",
                                  story.model.dynamics.order(), story.model.method,
                                  poles_text(story.model.dynamics)));
}

/// One of the ranges that was left out (service/windows/telemetry_checks.hpp).
std::string implausible_text(const ordered_json& range) {
  const auto parameters = range.value("parameters", std::vector<std::string>());
  const std::string when = fmt::format("from {} to {}", time_text(range.value("begin_ns", 0LL)),
                                       time_text(range.value("end_ns", 0LL)));
  const ordered_json* relation = member(range, "relation");
  if (!relation)
    return fmt::format("{} ({}) {}", fmt::join(parameters, ", "), range.value("check", ""), when);
  return fmt::format("{} {}, where relation {} is {} with a tolerance of {}",
                     fmt::join(parameters, ", "), when, relation->get<std::string>(),
                     figure(range, "residual"), figure(range, "tolerance"));
}

void implausible_sentences(const ordered_json& evidence, Sentences& sentences) {
  constexpr std::size_t most_told = 3;
  const ordered_json* implausible = member(evidence, "implausible");
  if (!implausible) return;
  if (const ordered_json* longest = member(*implausible, "longest"))
    for (std::size_t i = 0; i < std::min(most_told, longest->size()); ++i)
      sentences.push_back(
          fmt::format("Not believed, and left out: {}.", implausible_text((*longest)[i])));
  if (const auto ranges = implausible->value("stretches", std::size_t{0}); ranges > most_told)
    sentences.push_back(
        fmt::format("Shorter stretches that were left out too: {}.", ranges - most_told));
  if (const ordered_json* not_applied = member(*implausible, "not_applied"))
    for (const ordered_json& relation : *not_applied)
      sentences.push_back(
          fmt::format("A relation was not applied: {}.", relation.get<std::string>()));
}

void score_sentences(const StoredVersion& story, const ordered_json& evidence,
                     Sentences& sentences) {
  std::string free_run =
      fmt::format("Its free run errs by {} % (MRSE) and explains {} % (fit)",
                  figure(evidence, "mrse_percent"), figure(evidence, "fit_percent"));
  if (const ordered_json* diagnostics = member(evidence, "diagnostics"))
    if (const ordered_json* interval = member(*diagnostics, "mrse_interval_percent"))
      free_run += fmt::format("; the 95 % interval of the error is {} to {} %",
                              figure(*interval, "mean_low"), figure(*interval, "mean_high"));
  sentences.push_back(free_run + ".");
  if (story.model.tracking)
    sentences.push_back(
        fmt::format("Corrected by the integral feedback of live telemetry it errs by {:.4g} %: "
                    "what a simulator that follows the satellite sees.",
                    story.model.tracking->validation.mrse()));
}

std::string comparison_text(const ordered_json& comparison) {
  std::string text =
      fmt::format("{} % against {} % on the same {} rows", figure(comparison, "mrse_percent"),
                  figure(comparison, "rival_mrse_percent"), figure(comparison, "rows"));
  if (const auto sure = number(comparison, "sure_reduction_percent"))
    text += fmt::format(", a reduction of {} %, and {:.4g} % with the required confidence",
                        figure(comparison, "reduction_percent"), *sure);
  else
    text += ", which is too little to be sure of anything";
  return text;
}

/// Of programs before version 0.2, which compared at the window alone.
void rival_sentences(const ordered_json& evidence, Sentences& sentences) {
  if (const ordered_json* mean = member(evidence, "mean"))
    sentences.push_back(fmt::format("Beside a constant at the mean: {}.", comparison_text(*mean)));
  if (const ordered_json* baseline = member(evidence, "baseline"))
    sentences.push_back(fmt::format("Compared with the simulator's own telemetry: {}.",
                                    comparison_text(*baseline)));
  if (member(evidence, "baseline_mrse_percent"))
    sentences.push_back(
        fmt::format("The simulator's own model errs by {} %, as the configuration says.",
                    figure(evidence, "baseline_mrse_percent")));
  const ordered_json* champion = member(evidence, "champion");
  if (!champion) return;
  const std::string version = figure(*champion, "version");
  if (const ordered_json* comparison = member(*champion, "comparison"))
    sentences.push_back(
        fmt::format("Compared with champion {}: {}.", version, comparison_text(*comparison)));
  else if (member(*champion, "mrse_percent"))  // of a program before comparisons were kept
    sentences.push_back(fmt::format("Champion {} errs by {} % on the same rows.", version,
                                    figure(*champion, "mrse_percent")));
  else
    sentences.push_back(fmt::format("Champion {} cannot run on these samples.", version));
  if (const ordered_json* comparison = member(*champion, "where_validated"))
    sentences.push_back(fmt::format("Where champion {} was validated, before this window: {}.",
                                    version, comparison_text(*comparison)));
  if (const ordered_json* elsewhere = member(*champion, "elsewhere")) {
    std::string apart = figure(*elsewhere, "disagreement_percent") + " % of the output's range";
    if (member(*elsewhere, "without_offset_percent"))
      apart += fmt::format(" ({} % but for the champion's mean error here)",
                           figure(*elsewhere, "without_offset_percent"));
    sentences.push_back(fmt::format(
        "On {} rows of the window of champion {}, with inputs that this one was not validated "
        "with, the two differ by {}; there they err by {} % and the champion by {} %.",
        figure(*elsewhere, "rows"), version, apart, figure(*elsewhere, "mrse_percent"),
        figure(*elsewhere, "champion_mrse_percent")));
  }
}

void hold_and_warning_sentences(const ordered_json& evidence, Sentences& sentences) {
  if (const ordered_json* hold = member(evidence, "hold"))
    sentences.push_back(fmt::format("The equipment was held by {}: {}.", hold->value("actor", ""),
                                    hold->value("reason", "")));
  if (const ordered_json* warnings = member(evidence, "warnings"))
    for (const ordered_json& warning : *warnings)
      if (warning.is_string()) sentences.push_back("Warning: " + warning.get<std::string>() + ".");
}

Sentences sentences_of(const StoredVersion& story) {
  const ordered_json evidence = evidence_of(story.attempt);
  Sentences sentences;
  window_sentences(story, evidence, sentences);
  implausible_sentences(evidence, sentences);
  score_sentences(story, evidence, sentences);
  rival_sentences(evidence, sentences);
  hold_and_warning_sentences(evidence, sentences);
  sentences.push_back(
      fmt::format("At its window: {}. {}", story.attempt.outcome, story.attempt.reason));
  for (const storage::Decision& decision : story.decisions)
    sentences.push_back(fmt::format("{} {} by {}: {}", time_text(decision.time),
                                    past(decision.kind), decision.actor, decision.reason));
  return sentences;
}

std::string table_of(const std::vector<Condition>& conditions) {
  Table table({{"rule"}, {"holds"}, {"asked"}, {"found"}});
  for (const Condition& condition : conditions)
    table.add({std::string(condition.rule),
               condition.holds ? (*condition.holds ? "yes" : "no") : "-", condition.asked,
               condition.found});
  return table.text(terminal_width());
}

int print(const history::HistoryReader& history, const StoredVersion& story, bool json) {
  const Verdict verdict = verdict_of(history, story);
  const Sentences sentences = sentences_of(story);
  if (json) {
    ordered_json conditions = ordered_json::array();
    for (const Condition& condition : verdict.conditions)
      conditions.push_back(
          {{"rule", condition.rule},
           {"asked", condition.asked},
           {"found", text_json(condition.found)},
           {"holds", condition.holds ? ordered_json(*condition.holds) : ordered_json()}});
    const ordered_json object = {{"spacecraft", story.version.spacecraft},
                                 {"equipment", story.version.equipment},
                                 {"version", story.version.number},
                                 {"status", story.version.status},
                                 {"verdict", verdict.sentence},
                                 {"conditions", std::move(conditions)},
                                 {"outcome", story.attempt.outcome},
                                 {"reason", story.attempt.reason},
                                 {"sentences", sentences},
                                 {"evidence", evidence_of(story.attempt)}};
    fmt::print("{}\n", object.dump(2, ' ', false, ordered_json::error_handler_t::replace));
    return exit_done;
  }
  fmt::print("{} version {}: {}\n", full_name({story.version.spacecraft, story.version.equipment}),
             story.version.number, story.version.status);
  fmt::print("{}\n", verdict.sentence);
  if (!verdict.conditions.empty()) fmt::print("\n{}\n", table_of(verdict.conditions));
  for (const std::string& sentence : sentences) fmt::print("{}\n", sentence);
  return exit_done;
}

int run(const Arguments& arguments) {
  return with_version(arguments.access, arguments.subject,
                      [&](const Readers& readers, const StoredVersion& story) {
                        return print(readers.history, story, arguments.json);
                      });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_version_argument(command, arguments->subject);
  add_access_options(command, arguments->access);
  command.add_flag("--json", arguments->json, "one JSON object with the evidence itself");
  command.footer("Example:\n  reident why CBERS-4/BDR@3 --config reident.toml");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"why",
                                   "Say in words why a version was approved, refused or waits",
                                   WorksOn::history, declare});

}  // namespace

}  // namespace reident::cli::why_verb
