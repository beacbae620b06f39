#include "tests/trust/flight.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/platform/handwritten_platform.hpp"
#include "service/satcs/platform/platform_spacecraft.hpp"
#include "service/satcs/reference/handwritten_eps.hpp"
#include "service/satcs/reference/reference_spacecraft.hpp"
#include "service/windows/window_data.hpp"
#include "tests/trust/score.hpp"

namespace reident::trust {
namespace {

constexpr Duration second = 1'000'000'000;

std::vector<std::string> parameter_names(const SpacecraftConfig& spacecraft) {
  std::set<std::string> names;
  for (const EquipmentConfig& equipment : spacecraft.equipment)
    for (const std::string& name : parameters_of(equipment)) names.insert(name);
  return {names.begin(), names.end()};
}

/// Goes through the life second by second; a frame every `period`, which holds the last sample of
/// each point that was due since the one before.
template <class Spacecraft, class Simulator>
class Flight {
 public:
  /// Both are new at the group's start; `points` are the spacecraft's.
  template <class TelemetryPoint>
  Flight(Spacecraft plant, Simulator simulator, std::span<const TelemetryPoint> points,
         const std::string& spacecraft, Duration period, const std::vector<std::string>& names)
      : spacecraft_(spacecraft),
        period_(period),
        plant_(std::move(plant)),
        simulator_(std::move(simulator)) {
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
  Simulator simulator_;
  std::map<std::uint32_t, Point> wanted_;
  std::vector<storage::Sample> due_;
  std::uint64_t sequence_ = 0;
};

/// A spacecraft or a simulator at the start of a life.
template <class Model>
Model begun(const LifeGroup& group, const auto& fresh) {
  return Model(fresh, group.events, group.start, group.seed);
}

template <class Spacecraft, class Simulator>
Known fly_with(Flight<Spacecraft, Simulator> flight, const LifeGroup& group,
               const SpacecraftConfig& spacecraft, const std::vector<std::string>& names,
               const Heard& heard) {
  const auto descriptors = telemetry_of(spacecraft);
  Known known{{descriptors, names},
              {descriptors, names},
              {satcs::simulated_descriptors(group.family, spacecraft.name), names}};
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

}  // namespace

Duration orbit_ns() {
  return static_cast<Duration>(std::llround(satcs::reference::OrbitConstants{}.period_s)) * second;
}

storage::TimeRange extent_of(const LifeGroup& group) {
  return {group.start, group.start + group.duration + judged_orbits * orbit_ns()};
}

std::vector<storage::ParameterDescriptor> telemetry_of(const SpacecraftConfig& spacecraft) {
  const auto names = parameter_names(spacecraft);
  // No parameter is of both families.
  auto all = satcs::family_descriptors(satcs::Family::power, spacecraft.name);
  const auto platform = satcs::family_descriptors(satcs::Family::platform, spacecraft.name);
  all.insert(all.end(), platform.begin(), platform.end());
  std::erase_if(all, [&names](const auto& descriptor) {
    return std::find(names.begin(), names.end(), descriptor.name) == names.end();
  });
  return all;
}

Known fly(const LifeGroup& group, const SpacecraftConfig& spacecraft, const Heard& heard) {
  namespace power = satcs::reference;
  namespace platform = satcs::platform;
  const auto names = parameter_names(spacecraft);
  const Duration period = spacecraft.equipment.front().sample_period;
  if (group.family == satcs::Family::platform) {
    const platform::Constants fresh;
    return fly_with(Flight(begun<platform::PlatformSpacecraft>(group, fresh),
                           begun<platform::HandwrittenPlatform>(group, fresh),
                           platform::telemetry_points(), spacecraft.name, period, names),
                    group, spacecraft, names, heard);
  }
  const power::Constants fresh;
  return fly_with(
      Flight(begun<power::Spacecraft>(group, fresh), begun<satcs::HandwrittenEps>(group, fresh),
             power::telemetry_points(), spacecraft.name, period, names),
      group, spacecraft, names, heard);
}

}  // namespace reident::trust
