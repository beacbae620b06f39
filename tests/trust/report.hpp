// What the suite prints: the table by kind of scenario, one scenario in words, and the figures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tests/trust/group_run.hpp"

namespace reident::trust {

using Outcomes = std::vector<const ScenarioOutcome*>;

/// Those of one half.
Outcomes half_of(const std::vector<ScenarioOutcome>& outcomes, Half half);

/// The figures that are asked for, over some scenarios.
struct Figures {
  int scenarios = 0;
  std::vector<double> regrets;  // of each equipment with a champion
  int versions = 0;             // published and judged
  int wrong_approvals = 0;
  int changes = 0;  // that mattered
  int recovered = 0;
  double quiet_months = 0;  // of equipment to which nothing happened
  int quiet_publications = 0;
  int false_alarms = 0;  // drift requests there
  std::vector<std::int64_t> orbits_to_recover{};

  void add(const ScenarioOutcome& outcome);
  double recovered_fraction() const;
  double regret() const;
  double regret_quantile(double share) const;  // 1 where nothing changed
  double publications_per_month() const;       // that replace a version, of one equipment
  double false_alarms_per_month() const;
  std::int64_t recovery_quantile(double share) const;  // orbits; 0 where nothing changed
};

Figures figures_of(const Outcomes& outcomes);
nlohmann::ordered_json to_json(const Figures& figures);

/// Rows by life, and rows by fault, in Markdown. With `details`, the worst case of each row is
/// named and linked to its picture (picture_name), and collected in `worst`.
std::string table(const Outcomes& outcomes, bool details, Outcomes* worst = nullptr);

std::string picture_name(int scenario);

/// Both halves, apart; no scenario of the held-out one is named.
std::string tables(const std::vector<ScenarioOutcome>& outcomes, Outcomes* worst = nullptr);

/// The figures of both halves as one object.
nlohmann::ordered_json figures_json(const std::vector<ScenarioOutcome>& outcomes);

/// report.md, and next to it the pictures that it links to. Throws std::runtime_error where a file
/// cannot be written.
void write_report(const std::vector<ScenarioOutcome>& outcomes,
                  const std::filesystem::path& folder);

/// What happened in one scenario, for a person.
std::string story(const ScenarioOutcome& outcome);

}  // namespace reident::trust
