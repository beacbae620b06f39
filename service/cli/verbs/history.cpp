#include <algorithm>
#include <cstdio>
#include <map>

#include <fmt/format.h>

#include "service/cli/history_access.hpp"
#include "service/cli/output/table.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/time_options.hpp"
#include "service/cli/verb.hpp"
#include "service/model/glossary.hpp"
#include "service/model/reasons.hpp"
#include "service/operations/commands.hpp"
#include "service/review/evidence.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::history_verb {
namespace {

using history::HistoryReader;
using nlohmann::ordered_json;
using storage::Attempt;
using storage::Decision;
using storage::EquipmentName;
using storage::HistoryFilter;
using storage::Hold;
using storage::VersionSummary;

constexpr std::size_t lines_for_people = 20;  // where nothing else is asked for

struct Arguments {
  HistoryAccessOptions access;
  std::string spacecraft;
  std::string equipment;
  std::string outcome;
  TimeOptions time;
  std::optional<std::size_t> last;
  bool all = false;
  bool versions_only = false;
  bool long_lines = false;
  bool csv = false;
  bool json = false;

  bool is_for_programs() const { return csv || json; }
};

bool is_selected(const EquipmentName& equipment, const Arguments& arguments) {
  return (arguments.spacecraft.empty() || arguments.spacecraft == equipment.spacecraft) &&
         (arguments.equipment.empty() || arguments.equipment == equipment.equipment);
}

/// What the registry says about the versions of the chosen equipment, and about holds.
class Decided {
 public:
  Decided(const HistoryReader& history, const Arguments& arguments) {
    for (const EquipmentName& equipment : history.equipment()) {
      if (!is_selected(equipment, arguments)) continue;
      for (VersionSummary& version : history.summaries(equipment))
        versions_[{equipment, version.number}].summary = std::move(version);
      for (Decision& decision : history.decisions(equipment))
        versions_[{equipment, decision.version}].decisions.push_back(std::move(decision));
      if (auto hold = history.hold(equipment)) holds_.emplace(equipment, *std::move(hold));
    }
  }
  struct Version {
    VersionSummary summary;
    std::vector<Decision> decisions;
  };
  /// The version that an attempt gave.
  const Version& version(const Attempt& attempt) const {
    return versions_.at({{attempt.spacecraft, attempt.equipment}, *attempt.version});
  }
  bool is_champion(const Attempt& attempt) const {
    return attempt.version && version(attempt).summary.status == "approved";
  }
  const std::map<EquipmentName, Hold>& holds() const { return holds_; }

 private:
  std::map<std::pair<EquipmentName, std::int64_t>, Version> versions_;
  std::map<EquipmentName, Hold> holds_;
};

std::string version_text(const Attempt& attempt, const Decided& decided) {
  if (!attempt.version) return "-";
  const std::string& status = decided.version(attempt).summary.status;
  return fmt::format("{}{}", *attempt.version,
                     status == "approved"    ? "*"
                     : status == "withdrawn" ? "x"
                                             : "");
}

/// A code in words, as it is where the glossary does not have it.
std::string words_of(const std::string& code) {
  const GlossaryEntry* entry = explanation_of(code);
  return entry ? std::string(entry->words) : code;
}

/// What became of the window, in words: of a version what it is now, and by whom.
std::string verdict_of(const Attempt& attempt, const Decided& decided) {
  if (!attempt.version) return words_of(attempt.outcome);
  const Decided::Version& version = decided.version(attempt);
  const Decision& last = version.decisions.back();
  const std::string by = last.actor == "gate" ? "" : " by " + last.actor;
  if (version.summary.status == "approved") return "champion now" + by;
  if (version.summary.status == "superseded") return "was champion";
  if (version.summary.status == "withdrawn") return "withdrawn" + by;
  if (version.summary.status == "waiting") {
    if (waits_for_operator(last)) return words_of(last_code(last));
    const bool is_judged = attempt.outcome == name(Outcome::challenger);
    return is_judged ? "challenges the champion" : words_of(attempt.outcome);
  }
  const std::string code = last_code(last);
  return "rejected" + (by.empty() ? ": " + words_of(code.empty() ? attempt.outcome : code) : by);
}

/// The outcome at first, and what was decided since.
std::string outcome_text(const Attempt& attempt, const Decided& decided) {
  std::string text = fmt::format("{}: {}", attempt.outcome, attempt.reason);
  if (!attempt.version) return text;
  const std::vector<Decision>& decisions = decided.version(attempt).decisions;
  for (std::size_t i = 1; i < decisions.size(); ++i)
    text += fmt::format(" Then {} by {} at {}{}.", past(decisions[i].kind), decisions[i].actor,
                        time_text(decisions[i].time), reason_text(decisions[i].reason));
  return text;
}

void print_long(const std::vector<Attempt>& attempts, const Decided& decided) {
  Table table({{"equipment"},
               {"window (UTC)"},
               {"length"},
               {"version", Table::Align::right},
               {"order", Table::Align::right},
               {"MRSE %", Table::Align::right},
               {"fit %", Table::Align::right},
               {"outcome and reason"}});
  for (const Attempt& attempt : attempts) {
    const ordered_json evidence = evidence_of(attempt);
    table.add({full_name({attempt.spacecraft, attempt.equipment}), time_text(attempt.window.begin),
               duration_text(attempt.window.end - attempt.window.begin),
               version_text(attempt, decided), evidence_number(evidence, "order"),
               evidence_number(evidence, "mrse_percent"), evidence_number(evidence, "fit_percent"),
               outcome_text(attempt, decided)});
  }
  fmt::print("{}", table.text(terminal_width()));
}

void print_short(const std::vector<Attempt>& attempts, const Decided& decided) {
  constexpr std::size_t minutes = sizeof "2026-03-01T12:00" - 1;
  Table table({{"equipment"},
               {"window ends (UTC)"},
               {"version", Table::Align::right},
               {"MRSE %", Table::Align::right},
               {"verdict"}});
  for (const Attempt& attempt : attempts)
    table.add({full_name({attempt.spacecraft, attempt.equipment}),
               time_text(attempt.window.end).substr(0, minutes), version_text(attempt, decided),
               evidence_number(evidence_of(attempt), "mrse_percent"),
               verdict_of(attempt, decided)});
  fmt::print("{}", table.text(terminal_width()));
}

void print_table(const std::vector<Attempt>& attempts, const Decided& decided,
                 const Arguments& arguments, bool is_cut) {
  if (arguments.long_lines)
    print_long(attempts, decided);
  else
    print_short(attempts, decided);
  fmt::print("* champion: what simulators run now; x withdrawn\n");
  if (is_cut) fmt::print("the last {}; --all shows every one, --long why\n", attempts.size());
  for (const auto& [equipment, hold] : decided.holds())
    fmt::print("{}\n", hold_text(equipment, hold));
}

std::string quoted(std::string text) {
  for (std::size_t at = text.find('"'); at != std::string::npos; at = text.find('"', at + 2))
    text.insert(at, 1, '"');
  return "\"" + text + "\"";
}

void print_csv(const std::vector<Attempt>& attempts, const Decided& decided) {
  fmt::print(
      "attempt,spacecraft,equipment,window_begin,window_end,time,outcome,version,status,order,"
      "mrse_percent,fit_percent,verdict,reason\n");
  for (const Attempt& attempt : attempts) {
    const ordered_json evidence = evidence_of(attempt);
    const auto number = [&](const char* key) {
      const auto found = evidence.find(key);
      return found != evidence.end() && found->is_number() ? found->dump() : std::string();
    };
    fmt::print("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", attempt.id,
               quoted(attempt.spacecraft), quoted(attempt.equipment),
               time_text(attempt.window.begin), time_text(attempt.window.end),
               time_text(attempt.time), attempt.outcome,
               attempt.version ? std::to_string(*attempt.version) : "",
               attempt.version ? decided.version(attempt).summary.status : "", number("order"),
               number("mrse_percent"), number("fit_percent"), quoted(verdict_of(attempt, decided)),
               quoted(attempt.reason));
  }
}

ordered_json attempt_json(const Attempt& attempt, const Decided& decided) {
  const ordered_json evidence = evidence_of(attempt);
  const auto number = [&](const char* key) { return evidence.value(key, ordered_json()); };
  ordered_json json = {
      {"attempt", attempt.id},
      {"spacecraft", attempt.spacecraft},
      {"equipment", attempt.equipment},
      {"window",
       {{"begin", time_text(attempt.window.begin)}, {"end", time_text(attempt.window.end)}}},
      {"trigger", attempt.trigger},
      {"time", time_text(attempt.time)},
      {"outcome", attempt.outcome},
      {"reason", attempt.reason},
      {"version", attempt.version ? ordered_json(*attempt.version) : ordered_json()},
      {"champion", decided.is_champion(attempt)},
      {"order", number("order")},
      {"mrse_percent", number("mrse_percent")},
      {"fit_percent", number("fit_percent")},
      {"evidence", evidence},
      {"configuration_digest", attempt.configuration_digest},
      {"program_version", attempt.program_version}};
  if (!attempt.version) return json;
  const Decided::Version& version = decided.version(attempt);
  json["status"] = version.summary.status;
  json["parent"] = version.summary.parent ? ordered_json(*version.summary.parent) : ordered_json();
  json["decisions"] = decisions_json(version.decisions);
  return json;
}

void print_json(const std::vector<Attempt>& attempts, const Decided& decided) {
  ordered_json list = ordered_json::array();
  for (const Attempt& attempt : attempts) list.push_back(attempt_json(attempt, decided));
  ordered_json holds = ordered_json::array();
  for (const auto& [equipment, hold] : decided.holds())
    holds.push_back({{"spacecraft", equipment.spacecraft},
                     {"equipment", equipment.equipment},
                     {"hold", hold_json(hold)}});
  const ordered_json object = {{"attempts", list}, {"holds", holds}};
  fmt::print("{}\n", object.dump(2, ' ', false, ordered_json::error_handler_t::replace));
}

/// Why a filter selects nothing.
Refusal nothing_selected(const Arguments& arguments, const HistoryReader& history) {
  HistoryFilter newest;
  newest.last = 1;
  const std::vector<Attempt> last = history.attempts(newest);
  if (last.empty())
    return {"no window has been tried yet; reident status shows what the service does"};
  const auto or_any = [](const std::string& name) { return name.empty() ? "(any)" : name; };
  const bool is_narrowed = !arguments.outcome.empty() || arguments.time.from || arguments.time.to;
  return {fmt::format(
      "no {}{}{}; the database has {}", arguments.versions_only ? "version" : "attempt",
      arguments.spacecraft.empty() && arguments.equipment.empty()
          ? ""
          : " of " + full_name({or_any(arguments.spacecraft), or_any(arguments.equipment)}),
      is_narrowed ? fmt::format(" with this outcome and time; the last window that was "
                                "tried ends at {}",
                                time_text(last.back().window.end))
                  : "",
      equipment_in(history))};
}

/// The attempts that are asked for, and whether more were left out.
std::pair<std::vector<Attempt>, bool> selected(const Arguments& arguments,
                                               std::optional<storage::TimeRange> window,
                                               const HistoryReader& history) {
  std::optional<std::size_t> last = arguments.last;
  if (!last && !arguments.all && !arguments.is_for_programs()) last = lines_for_people;
  HistoryFilter filter;
  filter.spacecraft = arguments.spacecraft;
  filter.equipment = arguments.equipment;
  filter.window = window;
  filter.versions_only = arguments.versions_only;
  if (last && arguments.outcome.empty()) filter.last = *last + 1;  // one more shows that there are
  std::vector<Attempt> attempts = history.attempts(filter);
  if (!arguments.outcome.empty())
    std::erase_if(attempts, [&](const Attempt& one) { return one.outcome != arguments.outcome; });
  const bool is_cut = last && attempts.size() > *last;
  if (is_cut) attempts.erase(attempts.begin(), attempts.end() - static_cast<std::ptrdiff_t>(*last));
  return {std::move(attempts), is_cut && !arguments.last};
}

int run(Arguments arguments) {
  if (const auto slash = arguments.equipment.find('/');
      arguments.spacecraft.empty() && slash != std::string::npos) {
    arguments.spacecraft = arguments.equipment.substr(0, slash);
    arguments.equipment.erase(0, slash + 1);
  }
  if (!arguments.outcome.empty() && !explanation_of(arguments.outcome)) {
    std::vector<std::string> codes;
    for (const GlossaryEntry& one : glossary()) codes.emplace_back(one.code);
    return refuse({fmt::format("there is no outcome {}{}; reident explain lists the codes",
                               arguments.outcome, did_you_mean(arguments.outcome, codes))});
  }
  std::optional<storage::TimeRange> window;
  if (arguments.time.from || arguments.time.to) {
    const auto range = chosen_range(arguments.time, {INT64_MIN, INT64_MAX});
    if (const auto* refusal = std::get_if<Refusal>(&range)) return refuse(*refusal);
    window = std::get<storage::TimeRange>(range);
  }
  return with_readers(arguments.access, [&](const Readers& readers) {
    const HistoryReader& history = readers.history;
    const std::vector<EquipmentName> known = history.equipment();
    const bool filtered = !arguments.spacecraft.empty() || !arguments.equipment.empty();
    if (filtered && std::none_of(known.begin(), known.end(), [&](const EquipmentName& one) {
          return is_selected(one, arguments);
        }))
      return refuse(nothing_selected(arguments, history));
    const auto [attempts, is_cut] = selected(arguments, window, history);
    if (attempts.empty() && (filtered || !arguments.is_for_programs()))
      return refuse(nothing_selected(arguments, history));
    const Decided decided(history, arguments);
    if (arguments.json)
      print_json(attempts, decided);
    else if (arguments.csv)
      print_csv(attempts, decided);
    else
      print_table(attempts, decided, arguments, is_cut);
    return static_cast<int>(exit_done);
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_access_options(command, arguments->access);
  command.add_option("--spacecraft", arguments->spacecraft, "of this spacecraft alone");
  command.add_option("--equipment", arguments->equipment,
                     "of this EQUIPMENT or SPACECRAFT/EQUIPMENT alone");
  command.add_option("--outcome", arguments->outcome,
                     "of windows with this outcome alone; reident explain lists the codes");
  add_time_options(command, arguments->time, "windows with telemetry");
  CLI::Option* last =
      command.add_option("--last", arguments->last, "the newest so many (20 for people)")
          ->check(above_zero());
  command.add_flag("--all", arguments->all, "every one")->excludes(last);
  command.add_flag("--versions-only", arguments->versions_only,
                   "leave out windows that gave no model");
  command.add_flag("--long", arguments->long_lines, "with the reasons, and what was decided since");
  CLI::Option* csv = command.add_flag("--csv", arguments->csv, "as CSV, every one");
  command.add_flag("--json", arguments->json, "one JSON object with all evidence, every one")
      ->excludes(csv);
  command.footer("Example:\n  reident history --config reident.toml --equipment BDR --from -7d");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"history", "List the windows that were tried and what came out, the latest last",
     WorksOn::history, declare});

}  // namespace

}  // namespace reident::cli::history_verb
