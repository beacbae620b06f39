// Runs a group of scenarios: the plant once, each scenario's faults and service along with it, then
// the score of each.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/trust/scenario.hpp"
#include "tests/trust/score.hpp"
#include "tests/trust/simulated_service.hpp"

namespace reident::trust {

/// What became of one equipment in one scenario.
struct EquipmentOutcome {
  std::string equipment;
  std::vector<Publication> publications;
  std::vector<ChangeScore> changes;
  std::vector<Attempted> attempts;
  std::vector<DriftRequest> drifts;
  std::optional<double> regret;  // absent without a champion
  ErrorCurve champion;           // of what simulators ran
  std::vector<Extremes> output;  // of the truth, a tenth of an orbit each
};

struct ScenarioOutcome {
  int number = 0;
  std::uint64_t seed = 0;
  std::string life, fault;
  storage::TimeRange extent;  // of the telemetry
  std::vector<EquipmentOutcome> equipment;
  std::vector<satcs::reference::LifeEvent> events;
  std::vector<satcs::Fault> faults;
  satcs::Family family = satcs::Family::power;
};

/// The outcome of a scenario of the group before any equipment has one.
ScenarioOutcome planned(const LifeGroup& group, const Scenario& scenario);

/// What becomes of the databases of the scenarios once these are scored.
enum class Databases { removed, kept };

/// `config` is the suite's; the database of each scenario is made in `folder`, <number>/reident.db.
std::vector<ScenarioOutcome> run_group(const LifeGroup& group, const Config& config,
                                       const std::filesystem::path& folder,
                                       Databases databases = Databases::removed);

/// Scores what reidentd made of the scenarios: `folder` has the database of each, <number>.db.
/// Its clock was not the spacecraft's, so that a version counts from where the telemetry ended that
/// its approval rests on, and every window that was tried because of drift as a request. Throws
/// storage::Error where a database cannot be read.
std::vector<ScenarioOutcome> score_databases(const LifeGroup& group, const Config& config,
                                             const std::filesystem::path& folder);

}  // namespace reident::trust
