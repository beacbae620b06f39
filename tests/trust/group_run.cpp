#include "tests/trust/group_run.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "service/daemon/window_data.hpp"
#include "service/model/model_json.hpp"
#include "service/satcs/handwritten_eps.hpp"
#include "service/satcs/parameter_id.hpp"
#include "service/satcs/reference_spacecraft.hpp"

namespace reident::trust {
namespace {

using satcs::LieKind;
using satcs::reference::Spacecraft;

constexpr Duration second = 1'000'000'000;
/// The hand-written simulator is compared with for so long; its telemetry costs as much as the
/// spacecraft's.
constexpr Duration simulator_sends = 12 * 86'400 * second;

Duration orbit_ns() {
  return static_cast<Duration>(std::llround(satcs::reference::OrbitConstants{}.period_s)) * second;
}

std::vector<std::string> parameter_names(const SpacecraftConfig& spacecraft) {
  std::set<std::string> names;
  for (const EquipmentConfig& equipment : spacecraft.equipment)
    for (const std::string& name : parameters_of(equipment)) names.insert(name);
  return {names.begin(), names.end()};
}

std::vector<storage::ParameterDescriptor> descriptors_of(const std::string& spacecraft,
                                                         const std::vector<std::string>& names) {
  auto all = satcs::reference::telemetry_descriptors(spacecraft);
  std::erase_if(all, [&names](const auto& descriptor) {
    return std::find(names.begin(), names.end(), descriptor.name) == names.end();
  });
  return all;
}

/// One scenario on its way: its lies and its service.
class Telling {
 public:
  Telling(const Scenario& scenario, const LifeGroup& group, const Config& config,
          const std::vector<storage::ParameterDescriptor>& descriptors,
          const std::filesystem::path& folder)
      : scenario_(scenario), folder_(folder), config_(config) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    config_.database = folder_ / "reident.db";
    satcs::LiarOptions options;
    options.seed = group.seed;
    liar_.emplace(scenario.lies, descriptors, options);
    service_.emplace(config_);
    service_->describe(descriptors);
  }
  ~Telling() {
    service_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// A frame of the spacecraft.
  void take(const storage::TelemetryFrame& frame) {
    storage::TelemetryFrame copy = frame;
    liar_->take(std::move(copy), received_);
    hand_over();
  }
  void take_simulated(const storage::TelemetryFrame& frame) {
    storage::TelemetryFrame copy = frame;
    service_->receive(std::move(copy));
  }
  void finish() {
    liar_->flush(received_);
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
  Config config_;
  std::optional<satcs::Liar> liar_;
  std::optional<SimulatedService> service_;
  std::vector<storage::TelemetryFrame> received_;
};

/// What is known of a life beside what the services hear.
struct Known {
  KnownSeries truth, clean, simulated;
  Known(const std::vector<storage::ParameterDescriptor>& spacecraft,
        const std::vector<storage::ParameterDescriptor>& simulator,
        const std::vector<std::string>& names)
      : truth(spacecraft, names), clean(spacecraft, names), simulated(simulator, names) {}
};

/// Goes through the life second by second; a frame every `period`, which holds the last sample of
/// each point that was due since the one before.
class Flight {
 public:
  Flight(const LifeGroup& group, const std::string& spacecraft, Duration period,
         const std::vector<std::string>& names)
      : spacecraft_(spacecraft),
        period_(period),
        plant_({}, group.events, group.start, group.seed),
        simulator_({}, group.events, group.start, group.seed) {
    const auto points = satcs::reference::telemetry_points();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::find(names.begin(), names.end(), points[i].name) == names.end()) continue;
      wanted_.emplace(satcs::parameter_id(points[i].name), Point{i, points[i].every_s > 1});
    }
  }

  storage::Time time() const { return plant_.time(); }

  /// Goes on to the next frame, beside which `truth` has what perfect sensors would have sent in it
  /// and `simulated` what the simulator says.
  void next(storage::TelemetryFrame& frame, std::vector<storage::Sample>& truth,
            storage::TelemetryFrame& simulated) {
    frame.samples.clear();
    truth.clear();
    for (Duration passed = second; passed <= period_; passed += second) {
      plant_.advance();
      simulator_.advance();
      take(passed == period_, frame.samples, truth);
    }
    ++sequence_;
    head(frame, "station", storage::Origin::real);
    head(simulated, "simulator", storage::Origin::simulated);
    simulator_.read(simulated.samples);
    std::erase_if(simulated.samples, [this](const storage::Sample& sample) {
      return !wanted_.contains(sample.parameter);
    });
  }

 private:
  struct Point {
    std::size_t index;  // among the telemetry points
    bool slow;          // less than one sample a second
  };

  void take(bool is_frame, std::vector<storage::Sample>& samples,
            std::vector<storage::Sample>& truth) {
    plant_.read(due_);
    std::vector<double> noise_free;
    for (const storage::Sample& sample : due_) {
      const auto point = wanted_.find(sample.parameter);
      if (point == wanted_.end() || (!is_frame && !point->second.slow)) continue;
      if (noise_free.empty()) noise_free = plant_.noise_free();
      const auto replaced = [&sample](const storage::Sample& before) {
        return before.parameter == sample.parameter;
      };
      std::erase_if(samples, replaced);
      std::erase_if(truth, replaced);
      samples.push_back(sample);
      truth.push_back({sample.parameter, sample.quality, noise_free[point->second.index]});
    }
  }

  void head(storage::TelemetryFrame& frame, const char* source, storage::Origin origin) const {
    frame.spacecraft = spacecraft_;
    frame.source = source;
    frame.origin = origin;
    frame.sequence = sequence_;
    frame.generation_time = frame.reception_time = plant_.time();
  }

  std::string spacecraft_;
  Duration period_;
  Spacecraft plant_;
  satcs::HandwrittenEps simulator_;
  std::map<std::uint32_t, Point> wanted_;
  std::vector<storage::Sample> due_;
  std::uint64_t sequence_ = 0;
};

/// Whether the lie keeps an equipment of these parameters from hearing the truth while it lasts.
bool misleads(const satcs::Lie& lie, const std::vector<std::string>& parameters) {
  const auto is_one = [&parameters](const std::string& name) {
    return std::find(parameters.begin(), parameters.end(), name) != parameters.end();
  };
  switch (lie.kind) {
    case LieKind::frames_lost:
    case LieKind::two_stations:
    case LieKind::two_stamping_stations:
    case LieKind::duplicated_day:
    case LieKind::repeated_day:
      return false;
    case LieKind::passes_lost:
    case LieKind::backwards_playback:
    case LieKind::time_jump:
    case LieKind::simulated_as_real:
      return true;
    default:
      return lie.parameter.empty() || is_one(lie.parameter) || is_one(lie.other);
  }
}

std::vector<Tenure> tenures_of(const storage::Registry& registry, const std::string& spacecraft,
                               const std::string& equipment, storage::Time start) {
  std::vector<Tenure> tenures{{start, 0, {}}};
  for (const storage::Decision& decision : registry.decisions(spacecraft, equipment)) {
    if (decision.kind != storage::DecisionKind::approve) continue;
    const auto version = registry.version(spacecraft, equipment, decision.version);
    tenures.push_back(
        {decision.time, decision.version, equipment_model_from_json(version->model_json)});
  }
  return tenures;
}

/// Scores the scenarios of a group; what an oracle identified for one serves the others.
class Judge {
 public:
  Judge(const LifeGroup& group, const SpacecraftConfig& spacecraft, const Known& known,
        storage::TimeRange extent)
      : group_(group),
        spacecraft_(spacecraft),
        known_(known),
        extent_(extent),
        changes_(true_changes(group.events)) {}

  ScenarioOutcome score(const Telling& telling) {
    const Scenario& scenario = telling.scenario();
    ScenarioOutcome outcome{scenario.number,
                            group_.seed,
                            group_.half(),
                            group_.life,
                            scenario.lie,
                            {group_.start, group_.start + group_.duration},
                            {},
                            group_.events,
                            scenario.lies};
    for (const EquipmentConfig& equipment : spacecraft_.equipment)
      outcome.equipment.push_back(score(telling, equipment));
    return outcome;
  }

 private:
  EquipmentOutcome score(const Telling& telling, const EquipmentConfig& equipment) {
    const Truth truth(known_.truth, known_.simulated, spacecraft_, equipment, extent_, orbit_ns());
    const SimulatedService& service = telling.service();
    const auto tenures =
        tenures_of(service.registry(), spacecraft_.name, equipment.name, extent_.begin);
    auto parameters = InputExpressions(equipment.inputs, equipment.derived).parameters();
    parameters.insert(parameters.end(), equipment.outputs.begin(), equipment.outputs.end());
    const auto honest = [&](storage::TimeRange range) {
      return std::none_of(telling.scenario().lies.begin(), telling.scenario().lies.end(),
                          [&](const satcs::Lie& lie) {
                            return lie.when.begin < range.end && range.begin < lie.when.end &&
                                   misleads(lie, parameters);
                          });
    };
    EquipmentOutcome outcome{
        equipment.name,
        score_publications(truth, tenures, changes_),
        score_changes(
            truth, tenures, changes_,
            [&](storage::Time begin) { return oracle_of(equipment, begin); }, honest),
        {},
        {},
        champion_curve(truth, tenures),
        truth.output_extremes({group_.start, group_.start + group_.duration}, orbit_ns() / 10)};
    for (const Attempted& attempt : service.attempts())
      if (attempt.equipment == equipment.name) outcome.attempts.push_back(attempt);
    for (const DriftRequest& drift : service.drifts())
      if (drift.equipment == equipment.name) outcome.drifts.push_back(drift);
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

std::vector<ScenarioOutcome> run_group(const LifeGroup& group, const Config& config,
                                       const std::filesystem::path& folder) {
  Config chosen = config;
  SpacecraftConfig& spacecraft = chosen.spacecraft.front();
  std::erase_if(spacecraft.equipment, [&group](const EquipmentConfig& equipment) {
    return std::find(group.equipment.begin(), group.equipment.end(), equipment.name) ==
           group.equipment.end();
  });
  const Duration period = spacecraft.equipment.front().sample_period;
  const auto names = parameter_names(spacecraft);
  const auto descriptors = descriptors_of(spacecraft.name, names);
  Known known(descriptors, satcs::handwritten_descriptors(spacecraft.name), names);
  Flight flight(group, spacecraft.name, period, names);
  std::vector<std::unique_ptr<Telling>> tellings;
  for (const Scenario& scenario : group.scenarios)
    tellings.push_back(std::make_unique<Telling>(scenario, group, chosen, descriptors,
                                                 folder / std::to_string(scenario.number)));
  const storage::Time end = group.start + group.duration;
  // The last versions are judged on what comes after the telemetry.
  const storage::TimeRange extent{group.start, end + judged_orbits * orbit_ns()};
  storage::TelemetryFrame frame, simulated;
  std::vector<storage::Sample> truth;
  while (flight.time() < extent.end) {
    flight.next(frame, truth, simulated);
    known.truth.append(flight.time(), truth);
    known.clean.append(flight.time(), frame.samples);
    known.simulated.append(flight.time(), simulated.samples);
    if (flight.time() >= end) continue;
    for (const auto& telling : tellings) {
      if (flight.time() < group.start + simulator_sends) telling->take_simulated(simulated);
      telling->take(frame);
    }
  }
  std::vector<ScenarioOutcome> outcomes;
  Judge judge(group, spacecraft, known, extent);
  for (const auto& telling : tellings) {
    telling->finish();
    outcomes.push_back(judge.score(*telling));
  }
  return outcomes;
}

}  // namespace reident::trust
