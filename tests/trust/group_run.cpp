#include "tests/trust/group_run.hpp"

#include <algorithm>
#include <functional>
#include <memory>

#include "service/model/model_json.hpp"
#include "service/model/reasons.hpp"
#include "tests/trust/flight.hpp"

namespace reident::trust {
namespace {

using satcs::FaultKind;

/// With the group's equipment alone.
Config config_of(const LifeGroup& group, Config config) {
  std::erase_if(config.spacecraft.front().equipment, [&group](const EquipmentConfig& equipment) {
    return std::find(group.equipment.begin(), group.equipment.end(), equipment.name) ==
           group.equipment.end();
  });
  return config;
}

/// One scenario on its way: its faults and its service.
class Telling {
 public:
  Telling(const Scenario& scenario, const LifeGroup& group, const Config& config,
          const std::vector<storage::ParameterDescriptor>& descriptors,
          const std::filesystem::path& folder, Databases databases)
      : scenario_(scenario), folder_(folder), databases_(databases), config_(config) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    config_.database = folder_ / "reident.db";
    satcs::FaultInjectorOptions options;
    options.seed = group.seed;
    options.family = group.family;
    injector_.emplace(scenario.faults, descriptors, options);
    service_.emplace(config_);
    service_->describe(descriptors);
  }
  ~Telling() {
    service_.reset();
    if (databases_ == Databases::removed) std::filesystem::remove_all(folder_);
  }

  /// A frame of the spacecraft.
  void take(const storage::TelemetryFrame& frame) {
    storage::TelemetryFrame copy = frame;
    injector_->take(std::move(copy), received_);
    hand_over();
  }
  void take_simulated(const storage::TelemetryFrame& frame) {
    storage::TelemetryFrame copy = frame;
    service_->receive(std::move(copy));
  }
  void finish() {
    injector_->flush(received_);
    hand_over();
    service_->finish();
  }

  const Scenario& scenario() const { return scenario_; }
  const SimulatedService& service() const { return *service_; }

 private:
  void hand_over() {
    for (storage::TelemetryFrame& frame : received_) service_->receive(std::move(frame));
    received_.clear();
  }

  const Scenario& scenario_;
  std::filesystem::path folder_;
  Databases databases_;
  Config config_;
  std::optional<satcs::FaultInjector> injector_;
  std::optional<SimulatedService> service_;
  std::vector<storage::TelemetryFrame> received_;
};

/// Whether the fault keeps an equipment of these parameters from hearing the truth while it lasts.
bool misleads(const satcs::Fault& fault, const std::vector<std::string>& parameters) {
  const auto is_one = [&parameters](const std::string& name) {
    return std::find(parameters.begin(), parameters.end(), name) != parameters.end();
  };
  switch (fault.kind) {
    case FaultKind::frames_lost:
      return fault.magnitude >= 1;  // nothing is heard at all
    case FaultKind::two_stations:
    case FaultKind::two_stamping_stations:
    case FaultKind::duplicated_day:
    case FaultKind::repeated_day:
      return false;
    case FaultKind::passes_lost:
    case FaultKind::backwards_playback:
    case FaultKind::time_jump:
    case FaultKind::simulated_as_real:
      return true;
    default:
      return fault.parameter.empty() || is_one(fault.parameter) || is_one(fault.other);
  }
}

/// What a service made of a scenario.
struct Made {
  const storage::Registry& registry;
  std::vector<Attempted> attempts;
  /// When, on the spacecraft's clock, simulators got what was approved.
  std::function<storage::Time(const storage::Decision&, const storage::Version&)> published;
  /// When, on the same clock, a version was made.
  std::function<storage::Time(const storage::Version&)> made;
};

Made made_by(const SimulatedService& service) {
  return {service.registry(), service.attempts(),
          [](const storage::Decision& decision, const auto&) { return decision.time; },
          [](const storage::Version& version) { return version.created; }};
}

/// Where the telemetry ends that an approval rests on: the version's window, or what came after it.
storage::Time rests_until(const storage::Decision& decision, const storage::Version& version) {
  return judged_until(decision).value_or(version.window.end);
}

/// By a service whose clock was not the spacecraft's.
Made made_elsewhere(const storage::Registry& registry) {
  Made made{registry, {}, rests_until, [](const storage::Version& version) {
              return version.window.end;
            }};
  for (storage::Attempt& attempt : registry.attempts()) {
    const std::int64_t version = attempt.version.value_or(0);
    const storage::Time time = attempt.window.end;
    made.attempts.push_back({std::move(attempt.equipment), attempt.window, time,
                             std::move(attempt.trigger), std::move(attempt.outcome),
                             std::move(attempt.reason), version});
  }
  return made;
}

std::vector<Tenure> tenures_of(const Made& made, const std::string& spacecraft,
                               const std::string& equipment, storage::Time start) {
  std::vector<Tenure> tenures{{start, 0, {}}};
  for (const storage::Decision& decision : made.registry.decisions(spacecraft, equipment)) {
    if (decision.kind != storage::DecisionKind::approve &&
        decision.kind != storage::DecisionKind::roll_back)
      continue;
    const auto version = made.registry.version(spacecraft, equipment, decision.version);
    tenures.push_back({std::max(tenures.back().since, made.published(decision, *version)),
                       decision.version, equipment_model_from_json(version->model_json)});
  }
  return tenures;
}

/// All versions, by the time at which they were made.
std::vector<Tenure> versions_of(const Made& made, const std::string& spacecraft,
                                const std::string& equipment) {
  std::vector<Tenure> versions;
  for (const storage::VersionSummary& summary : made.registry.summaries(spacecraft, equipment)) {
    const auto version = made.registry.version(spacecraft, equipment, summary.number);
    versions.push_back(
        {made.made(*version), summary.number, equipment_model_from_json(version->model_json)});
  }
  return versions;
}

/// Whether within `range` the gate asked an operator about a version, since a sensor's bias may
/// look like what it has learnt.
bool asks(const Made& made, const std::string& spacecraft, const std::string& equipment,
          storage::TimeRange range) {
  const auto decisions = made.registry.decisions(spacecraft, equipment);
  return std::any_of(decisions.begin(), decisions.end(), [&](const storage::Decision& decision) {
    if (last_code(decision) != name(ReasonCode::bias_unverified)) return false;
    const auto version = made.registry.version(spacecraft, equipment, decision.version);
    const storage::Time asked = made.published(decision, *version);
    return range.begin <= asked && asked < range.end;
  });
}

/// Scores the scenarios of a group; what an oracle identified for one serves the others.
class Grader {
 public:
  Grader(const LifeGroup& group, const SpacecraftConfig& spacecraft, const Known& known)
      : group_(group),
        spacecraft_(spacecraft),
        known_(known),
        extent_(extent_of(group)),
        changes_(true_changes(group.events)) {}

  ScenarioOutcome score(const Scenario& scenario, const Made& made) {
    ScenarioOutcome outcome = planned(group_, scenario);
    for (const EquipmentConfig& equipment : spacecraft_.equipment)
      outcome.equipment.push_back(score(scenario, made, equipment));
    return outcome;
  }

 private:
  EquipmentOutcome score(const Scenario& scenario, const Made& made,
                         const EquipmentConfig& equipment) {
    const Truth truth(known_.truth, known_.simulated, spacecraft_, equipment, extent_, orbit_ns());
    const auto tenures = tenures_of(made, spacecraft_.name, equipment.name, extent_.begin);
    const auto versions =
        version_curves(truth, versions_of(made, spacecraft_.name, equipment.name));
    auto parameters = InputExpressions(equipment.inputs, equipment.derived).parameters();
    parameters.insert(parameters.end(), equipment.outputs.begin(), equipment.outputs.end());
    const auto honest = [&](storage::TimeRange range) {
      return std::none_of(scenario.faults.begin(), scenario.faults.end(),
                          [&](const satcs::Fault& fault) {
                            return fault.when.begin < range.end && range.begin < fault.when.end &&
                                   misleads(fault, parameters);
                          });
    };
    EquipmentOutcome outcome{
        equipment.name,
        score_publications(truth, tenures, changes_),
        score_changes(
            truth, tenures, versions, changes_,
            [&](storage::Time begin) { return oracle_of(equipment, begin); }, honest),
        {},
        {},
        regret(truth, tenures, versions),
        champion_curve(truth, tenures),
        truth.output_extremes({group_.start, group_.start + group_.duration}, orbit_ns() / 10)};
    for (std::size_t i = 0; i < changes_.size(); ++i)
      outcome.changes[i].is_asked =
          asks(made, spacecraft_.name, equipment.name,
               {changes_[i].begin, changes_[i].end + recovery_orbits * orbit_ns()});
    for (const Attempted& attempt : made.attempts) {
      if (attempt.equipment != equipment.name) continue;
      outcome.attempts.push_back(attempt);
      if (attempt.trigger == "drift") outcome.drifts.push_back({attempt.equipment, attempt.time});
    }
    return outcome;
  }

  std::optional<EquipmentModel> oracle_of(const EquipmentConfig& equipment, storage::Time begin) {
    const auto key = std::pair(equipment.name, begin);
    const auto known = oracles_.find(key);
    if (known != oracles_.end()) return known->second;
    return oracles_[key] =
               oracle(known_.clean, spacecraft_, equipment, {begin, begin + equipment.window});
  }

  const LifeGroup& group_;
  const SpacecraftConfig& spacecraft_;
  const Known& known_;
  const storage::TimeRange extent_;
  const std::vector<TrueChange> changes_;
  std::map<std::pair<std::string, storage::Time>, std::optional<EquipmentModel>> oracles_;
};

}  // namespace

ScenarioOutcome planned(const LifeGroup& group, const Scenario& scenario) {
  return {.number = scenario.number,
          .seed = group.seed,
          .life = group.life,
          .fault = scenario.fault,
          .extent = {group.start, group.start + group.duration},
          .equipment = {},
          .events = group.events,
          .faults = scenario.faults,
          .family = group.family};
}

std::vector<ScenarioOutcome> run_group(const LifeGroup& group, const Config& config,
                                       const std::filesystem::path& folder, Databases databases) {
  const Config chosen = config_of(group, config);
  const SpacecraftConfig& spacecraft = chosen.spacecraft.front();
  const auto descriptors = telemetry_of(spacecraft);
  std::vector<std::unique_ptr<Telling>> tellings;
  for (const Scenario& scenario : group.scenarios)
    tellings.push_back(std::make_unique<Telling>(
        scenario, group, chosen, descriptors, folder / std::to_string(scenario.number), databases));
  const Known known = fly(group, spacecraft, [&](const auto& frame, const auto& simulated) {
    for (const auto& telling : tellings) {
      if (frame.generation_time < group.start + simulator_sends) telling->take_simulated(simulated);
      telling->take(frame);
    }
  });
  std::vector<ScenarioOutcome> outcomes;
  Grader grader(group, spacecraft, known);
  for (const auto& telling : tellings) {
    telling->finish();
    outcomes.push_back(grader.score(telling->scenario(), made_by(telling->service())));
  }
  return outcomes;
}

std::vector<ScenarioOutcome> score_databases(const LifeGroup& group, const Config& config,
                                             const std::filesystem::path& folder) {
  const Config chosen = config_of(group, config);
  const SpacecraftConfig& spacecraft = chosen.spacecraft.front();
  const Known known = fly(group, spacecraft, [](const auto&, const auto&) {});
  std::vector<ScenarioOutcome> outcomes;
  Grader grader(group, spacecraft, known);
  for (const Scenario& scenario : group.scenarios) {
    storage::Database database(folder / (std::to_string(scenario.number) + ".db"),
                               storage::Database::Mode::read_only);
    const storage::Registry registry(database);
    outcomes.push_back(grader.score(scenario, made_elsewhere(registry)));
  }
  return outcomes;
}

}  // namespace reident::trust
