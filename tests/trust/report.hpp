// What the suite prints: the table by kind of scenario, one scenario in words, and the figures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tests/trust/group_run.hpp"

namespace reident::trust {

using Outcomes = std::vector<const ScenarioOutcome*>;

/// The figures that are asked for, over some scenarios.
struct Figures {
  int scenarios = 0;
  std::vector<double> regrets;  // of each equipment with a champion
  int versions = 0;             // published and judged
  int wrong = 0;
  int bias_wrong = 0;  // in scenarios with a bias
  int changes = 0;     // that mattered
  int recovered = 0;
  int hindsight = 0;        // recovered by the best versions of those that existed
  int asked = 0;            // of the others, those of which an operator was asked
  double quiet_months = 0;  // of equipment to which nothing happened
  int quiet_publications = 0;
  double late_months = 0;  // of these, after the third week
  int late_publications = 0;
  int false_alarms = 0;  // drift requests there
  std::vector<std::int64_t> orbits_to_recover{};

  void add(const ScenarioOutcome& outcome);
  double recovered_fraction() const;
  double recovered_or_asked_fraction() const;
  double hindsight_fraction() const;
  double regret() const;
  double regret_quantile(double share) const;  // 1 where nothing changed
  double publications_per_month() const;       // that replace a version, of one equipment
  double late_publications_per_month() const;
  double false_alarms_per_month() const;
  std::int64_t recovery_quantile(double share) const;  // orbits; 0 where nothing changed
};

Figures figures_of(const Outcomes& outcomes);

/// The figures, with 95 % intervals by scenario where `intervals`.
nlohmann::ordered_json to_json(const Outcomes& outcomes, bool intervals);

/// Rows by life, and rows by fault, in Markdown. The worst case of each row is named and linked to
/// its picture (picture_name), and collected in `worst`.
std::string table(const Outcomes& outcomes, Outcomes* worst = nullptr);

std::string picture_name(int scenario);

/// Both families, apart.
std::string tables(const std::vector<ScenarioOutcome>& outcomes, Outcomes* worst = nullptr);

/// The figures of each family that has outcomes, under its name, and by life under `lives`.
nlohmann::ordered_json figures_json(const std::vector<ScenarioOutcome>& outcomes);

/// report.md, which ends with `more`, and next to it the pictures that it links to. Throws
/// std::runtime_error where a file cannot be written.
void write_report(const std::vector<ScenarioOutcome>& outcomes, const std::string& more,
                  const std::filesystem::path& folder);

/// What happened in one scenario, for a person.
std::string story(const ScenarioOutcome& outcome);

}  // namespace reident::trust
