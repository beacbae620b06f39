#include "tests/trust/flight.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/reference/handwritten_eps.hpp"
#include "service/satcs/reference/reference_spacecraft.hpp"
#include "service/windows/window_data.hpp"
#include "tests/trust/score.hpp"

namespace reident::trust {
namespace {

using satcs::reference::Spacecraft;

constexpr Duration second = 1'000'000'000;

std::vector<std::string> parameter_names(const SpacecraftConfig& spacecraft) {
  std::set<std::string> names;
  for (const EquipmentConfig& equipment : spacecraft.equipment)
    for (const std::string& name : parameters_of(equipment)) names.insert(name);
  return {names.begin(), names.end()};
}

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

  /// Goes on to the next frame. `truth` has what perfect sensors would have sent in it, and
  /// `simulated` what the simulator says.
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

}  // namespace

Duration orbit_ns() {
  return static_cast<Duration>(std::llround(satcs::reference::OrbitConstants{}.period_s)) * second;
}

storage::TimeRange extent_of(const LifeGroup& group) {
  return {group.start, group.start + group.duration + judged_orbits * orbit_ns()};
}

std::vector<storage::ParameterDescriptor> telemetry_of(const SpacecraftConfig& spacecraft) {
  const auto names = parameter_names(spacecraft);
  auto all = satcs::reference::telemetry_descriptors(spacecraft.name);
  std::erase_if(all, [&names](const auto& descriptor) {
    return std::find(names.begin(), names.end(), descriptor.name) == names.end();
  });
  return all;
}

Known fly(const LifeGroup& group, const SpacecraftConfig& spacecraft, const Heard& heard) {
  const auto names = parameter_names(spacecraft);
  const auto descriptors = telemetry_of(spacecraft);
  Known known{{descriptors, names},
              {descriptors, names},
              {satcs::handwritten_descriptors(spacecraft.name), names}};
  Flight flight(group, spacecraft.name, spacecraft.equipment.front().sample_period, names);
  storage::TelemetryFrame frame, simulated;
  std::vector<storage::Sample> truth;
  while (flight.time() < extent_of(group).end) {
    flight.next(frame, truth, simulated);
    known.truth.append(flight.time(), truth);
    known.clean.append(flight.time(), frame.samples);
    known.simulated.append(flight.time(), simulated.samples);
    if (flight.time() < group.start + group.duration) heard(frame, simulated);
  }
  return known;
}

}  // namespace reident::trust
