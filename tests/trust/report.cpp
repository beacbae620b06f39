#include "tests/trust/report.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/support/time_text.hpp"
#include "tests/trust/intervals.hpp"
#include "tests/trust/picture.hpp"

namespace reident::trust {
namespace {

constexpr double month_ns = 30.0 * 86'400e9;
constexpr Duration three_weeks = 21 * 86'400'000'000'000;

double days_after(storage::Time start, storage::Time time) {
  return static_cast<double>(time - start) / 86'400e9;
}

/// How bad an outcome is: any wrong approval before any missed change.
struct Badness {
  double value = 0;
  std::string words;
};

Badness badness_of(const ScenarioOutcome& outcome) {
  Badness worst;
  const auto consider = [&](double value, std::string words) {
    if (value > worst.value) worst = {value, std::move(words)};
  };
  for (const EquipmentOutcome& equipment : outcome.equipment) {
    for (const Publication& publication : equipment.publications)
      if (publication.wrong())
        consider(1e6 * publication.worse_over_tolerance(),
                 fmt::format("{} version {}: {:.3g} % after {:.3g} %", equipment.equipment,
                             publication.version, *publication.mrse_percent,
                             *publication.replaced_mrse_percent));
    for (const ChangeScore& change : equipment.changes)
      if (change.missed())
        consider(static_cast<double>(change.orbits),
                 fmt::format("{} bad for {} orbits, {:.3g} times the oracle", equipment.equipment,
                             change.orbits, change.worst_ratio));
  }
  return worst;
}

void add_row(std::string& text, const std::string& name, const Outcomes& outcomes,
             Outcomes* all_worst) {
  const Figures figures = figures_of(outcomes);
  text += fmt::format("| {} | {} | {} | {} | {} of {} | {} | {:.2g} |", name, figures.scenarios,
                      figures.versions, figures.wrong, figures.recovered, figures.changes,
                      figures.changes > 0 ? fmt::format("{} ({})", figures.recovery_quantile(0.5),
                                                        figures.recovery_quantile(1))
                                          : "",
                      figures.publications_per_month());
  const auto worst = std::max_element(outcomes.begin(), outcomes.end(),
                                      [](const ScenarioOutcome* a, const ScenarioOutcome* b) {
                                        return badness_of(*a).value < badness_of(*b).value;
                                      });
  const Badness badness = badness_of(**worst);
  if (badness.value > 0) {
    const int number = (*worst)->number;
    text += fmt::format(" [{}]({}): {} |", number, picture_name(number), badness.words);
    if (all_worst) all_worst->push_back(*worst);
  } else {
    text += " |";
  }
  text += '\n';
}

void add_rows(std::string& text, std::string_view by, const std::map<std::string, Outcomes>& rows,
              Outcomes* worst) {
  text += fmt::format(
      "| {} | scenarios | versions judged | wrong approvals | changes recovered | orbits, median "
      "(worst) | publications a month, nothing changing | worst case "
      "|\n|---|---|---|---|---|---|---|---|\n",
      by);
  for (const auto& [name, outcomes] : rows) add_row(text, name, outcomes, worst);
}

std::map<std::string, Outcomes> by(std::string ScenarioOutcome::*kind, const Outcomes& outcomes) {
  std::map<std::string, Outcomes> rows;
  for (const ScenarioOutcome* outcome : outcomes) rows[outcome->*kind].push_back(outcome);
  return rows;
}

std::map<std::string, Outcomes> by_family(const std::vector<ScenarioOutcome>& outcomes) {
  std::map<std::string, Outcomes> families;
  for (const ScenarioOutcome& outcome : outcomes)
    families[std::string(name(outcome.family))].push_back(&outcome);
  return families;
}

}  // namespace

void Figures::add(const ScenarioOutcome& outcome) {
  ++scenarios;
  const bool is_bias = std::any_of(outcome.faults.begin(), outcome.faults.end(), [](auto& fault) {
    return fault.kind == satcs::FaultKind::bias_step ||
           fault.kind == satcs::FaultKind::drifting_bias;
  });
  for (const EquipmentOutcome& equipment : outcome.equipment) {
    for (const Publication& publication : equipment.publications) {
      versions += publication.mrse_percent.has_value();
      wrong += publication.wrong();
      bias_wrong += publication.wrong() && is_bias;
    }
    if (equipment.regret) regrets.push_back(*equipment.regret);
    for (const ChangeScore& change : equipment.changes) {
      if (!change.mattered) continue;
      ++changes;
      recovered += !change.missed();
      hindsight += !change.missed_in_hindsight();
      asked += change.missed() && change.is_asked;
      orbits_to_recover.push_back(change.orbits);
    }
    if (!outcome.events.empty()) continue;
    quiet_months += static_cast<double>(outcome.extent.end - outcome.extent.begin) / month_ns;
    quiet_publications += std::max(0, static_cast<int>(equipment.publications.size()) - 1);
    false_alarms += static_cast<int>(equipment.drifts.size());
    const storage::Time late = outcome.extent.begin + three_weeks;
    late_months += std::max(0.0, static_cast<double>(outcome.extent.end - late) / month_ns);
    for (std::size_t i = 1; i < equipment.publications.size(); ++i)
      late_publications += equipment.publications[i].time >= late;
  }
}

double Figures::regret() const {
  double sum = 0;
  for (const double regret : regrets) sum += std::log(regret);
  return regrets.empty() ? 1 : std::exp(sum / static_cast<double>(regrets.size()));
}

double Figures::regret_quantile(double share) const {
  if (regrets.empty()) return 1;
  std::vector<double> sorted = regrets;
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

double Figures::recovered_fraction() const {
  return changes > 0 ? static_cast<double>(recovered) / changes : 1;
}

double Figures::recovered_or_asked_fraction() const {
  return changes > 0 ? static_cast<double>(recovered + asked) / changes : 1;
}

double Figures::hindsight_fraction() const {
  return changes > 0 ? static_cast<double>(hindsight) / changes : 1;
}

double Figures::publications_per_month() const {
  return quiet_months > 0 ? quiet_publications / quiet_months : 0;
}

double Figures::late_publications_per_month() const {
  return late_months > 0 ? late_publications / late_months : 0;
}

double Figures::false_alarms_per_month() const {
  return quiet_months > 0 ? false_alarms / quiet_months : 0;
}

std::int64_t Figures::recovery_quantile(double share) const {
  if (orbits_to_recover.empty()) return 0;
  std::vector<std::int64_t> sorted = orbits_to_recover;
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

Figures figures_of(const Outcomes& outcomes) {
  Figures figures;
  for (const ScenarioOutcome* outcome : outcomes) figures.add(*outcome);
  return figures;
}

nlohmann::ordered_json to_json(const Outcomes& outcomes, bool intervals) {
  const Figures figures = figures_of(outcomes);
  nlohmann::ordered_json json{
      {"scenarios", figures.scenarios},
      {"wrong", figures.wrong},
      {"wrong_upper_percent", 100 * upper_bound(figures.wrong, figures.versions)},
      {"bias_wrong", figures.bias_wrong},
      {"versions", figures.versions},
      {"changes", figures.changes},
      {"recovered_fraction", figures.recovered_fraction()},
      {"recovered_or_asked_fraction", figures.recovered_or_asked_fraction()},
      {"hindsight_fraction", figures.hindsight_fraction()},
      {"recovery_median_orbits", figures.recovery_quantile(0.5)},
      {"regret", figures.regret()},
      {"regret_p90", figures.regret_quantile(0.9)},
      {"publications_per_month", figures.publications_per_month()},
      {"late_publications_per_month", figures.late_publications_per_month()},
      {"false_alarms_per_month", figures.false_alarms_per_month()}};
  if (!intervals) return json;
  const auto bounds = [&](double (Figures::*figure)() const) {
    const auto [low, high] = interval(outcomes.size(), [&](const std::vector<std::size_t>& places) {
      Figures drawn;
      for (const std::size_t place : places) drawn.add(*outcomes[place]);
      return (drawn.*figure)();
    });
    return nlohmann::ordered_json{low, high};
  };
  json["intervals"] = {{"regret", bounds(&Figures::regret)},
                       {"recovered_fraction", bounds(&Figures::recovered_fraction)},
                       {"publications_per_month", bounds(&Figures::publications_per_month)}};
  return json;
}

std::string table(const Outcomes& outcomes, Outcomes* worst) {
  std::string text;
  add_rows(text, "life", by(&ScenarioOutcome::life, outcomes), worst);
  text += '\n';
  add_rows(text, "fault", by(&ScenarioOutcome::fault, outcomes), worst);
  return text;
}

std::string picture_name(int scenario) {
  return fmt::format("scenario-{}.svg", scenario);
}

std::string tables(const std::vector<ScenarioOutcome>& outcomes, Outcomes* worst) {
  std::string text;
  for (const auto& [family, of_family] : by_family(outcomes))
    text += fmt::format("## {}\n\n{}\n", family, table(of_family, worst));
  return text;
}

nlohmann::ordered_json figures_json(const std::vector<ScenarioOutcome>& outcomes) {
  nlohmann::ordered_json figures;
  for (const auto& [family, of_family] : by_family(outcomes)) {
    nlohmann::ordered_json json = to_json(of_family, true);
    for (const auto& [life, rows] : by(&ScenarioOutcome::life, of_family))
      json["lives"][life] = to_json(rows, false);
    figures[family] = std::move(json);
  }
  return figures;
}

void write_report(const std::vector<ScenarioOutcome>& outcomes, const std::string& more,
                  const std::filesystem::path& folder) {
  const auto write = [&folder](const std::string& name, const std::string& text) {
    std::ofstream file(folder / name);
    file << text;
    if (!file.flush()) throw std::runtime_error((folder / name).string() + " cannot be written");
  };
  std::filesystem::create_directories(folder);
  Outcomes worst;
  write("report.md", "# The trust suite\n\n" + tables(outcomes, &worst) + more);
  for (const ScenarioOutcome* outcome : worst)
    write(picture_name(outcome->number), picture(*outcome));
}

std::string story(const ScenarioOutcome& outcome) {
  std::string text =
      fmt::format("scenario {}: life {}, fault {}, seed {}, from {}\n", outcome.number,
                  outcome.life, outcome.fault, outcome.seed, time_text(outcome.extent.begin));
  const storage::Time start = outcome.extent.begin;
  for (const auto& event : outcome.events)
    text +=
        fmt::format("  day {:.2f} to {:.2f}: {} {:g} of unit {}\n", days_after(start, event.begin),
                    days_after(start, event.end), name(event.kind), event.magnitude, event.unit);
  for (const satcs::Fault& fault : outcome.faults)
    text +=
        fmt::format("  day {:.2f} to {:.2f}: {} {} {} {}\n", days_after(start, fault.when.begin),
                    days_after(start, fault.when.end), name(fault.kind), fault.parameter,
                    fault.other, fault.magnitude ? fmt::format("{:.3g}", *fault.magnitude) : "");
  for (const EquipmentOutcome& equipment : outcome.equipment) {
    std::map<std::string, int> outcomes;
    for (const Attempted& attempt : equipment.attempts) ++outcomes[attempt.outcome];
    text += fmt::format("  {}: {} windows", equipment.equipment, equipment.attempts.size());
    for (const auto& [what, count] : outcomes) text += fmt::format(", {} {}", what, count);
    text += fmt::format("; {} drift requests", equipment.drifts.size());
    if (equipment.regret) text += fmt::format("; regret {:.3f}", *equipment.regret);
    text += '\n';
    for (const Publication& publication : equipment.publications)
      text += fmt::format(
          "    day {:.2f} version {}: {:.4g} % after {:.4g} %, {:.2f} of the tolerance{}\n",
          days_after(start, publication.time), publication.version,
          publication.mrse_percent.value_or(NAN), publication.replaced_mrse_percent.value_or(NAN),
          publication.worse_over_tolerance(), publication.wrong() ? " WRONG" : "");
    for (const ChangeScore& change : equipment.changes)
      text += fmt::format(
          "    day {:.2f} {}: {}, bad for {} orbits ({} in hindsight), at most {:.3g} "
          "times the oracle{}\n",
          days_after(start, change.begin), change.kind,
          change.mattered ? "mattered" : "did not matter", change.orbits, change.hindsight_orbits,
          change.worst_ratio,
          !change.missed()  ? ""
          : change.is_asked ? " MISSED, an operator was asked"
                            : " MISSED");
  }
  return text;
}

}  // namespace reident::trust
