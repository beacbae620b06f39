#include "service/client/simulator.hpp"

#include <algorithm>

#include "service/client/name_pattern.hpp"
#include "service/support/utc_clock.hpp"

namespace reident {
namespace {

constexpr std::size_t take_at_most = 256;
// What a simulator may lag behind before it loses telemetry: it must never slow the source, which
// the archive depends on.
constexpr std::int32_t frames_kept = 16384;

std::optional<ModelCache> cache_of(const SimulatorOptions& options) {
  if (!options.cache) return std::nullopt;
  return ModelCache(*options.cache, options.endpoint.partition);
}

}  // namespace

Simulator::Simulator(const SimulatorOptions& options)
    : options_(options),
      report_(options.json),
      participant_(options.endpoint),
      models_(participant_, options.subscription, cache_of(options)),
      descriptors_(participant_),
      frames_(participant_, {.keep_last = frames_kept}),
      ready_(participant_) {
  models_.attach_to(ready_);
  ready_.attach(descriptors_);
  ready_.attach(frames_);
}

void Simulator::run(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { ready_.wake(); });
  const ModelSubscriber::Listener heard = listener();
  models_.poll(heard);  // what was kept, without waiting
  auto next_report = Clock::now() + options_.report_period;
  auto say_unpublished = Clock::now() + version_within;
  while (!stop.stop_requested()) {
    const auto next = std::min(next_report, say_unpublished);
    ready_.wait(std::max<Clock::duration>(next - Clock::now(), std::chrono::nanoseconds(1)));
    models_.poll(heard);
    take_telemetry();
    if (Clock::now() >= say_unpublished) {
      report_unpublished();
      say_unpublished = Clock::time_point::max();
    }
    if (Clock::now() < next_report) continue;
    report_running();
    next_report = Clock::now() + options_.report_period;
  }
  for (const auto& [name, running] : equipment_) report_.running(name, running.live, true);
}

ModelSubscriber::Listener Simulator::listener() {
  return {
      .adopt = [this](const ModelVersion& version,
                      const Arrival& arrival) { adopt(version, arrival); },
      .refuse = [this](const ModelSubscriber::Refusal& refusal) { report_.refused(refusal); },
      .confirm =
          [this](const ModelVersion& version, const Arrival&) {
            const storage::EquipmentName name{version.model.spacecraft, version.model.equipment};
            Running& running = equipment_.at(name);
            running.told.from_cache = false;
            report_.confirmed(name, version.number);
            acknowledge(name, running);
          },
      .cache_fault = [this](const CacheFault& fault) { report_.cache_fault(fault); },
  };
}

void Simulator::adopt(const ModelVersion& version, const Arrival& arrival) {
  const storage::EquipmentName name{version.model.spacecraft, version.model.equipment};
  const auto running = equipment_.find(name);
  std::optional<ModelRunner::Swap> swap;
  if (running == equipment_.end()) {
    equipment_.emplace(name, Running{LiveEquipment(version, options_.mode), {}, 0});
  } else {
    report_.running(name, running->second.live, true);
    swap = running->second.live.adopt(version);
    running->second.reported = 0;
  }
  Running& current = equipment_.at(name);
  for (const auto& [id, descriptor] : parameters_) current.live.describe(descriptor);
  current.told = {};
  current.told.version = version.number;
  current.told.from_cache = arrival.from_cache;
  current.told.decided = version.decided;
  current.told.since = utc_now();
  if (swap) {
    current.told.remaining_step = swap->largest;
    current.told.transition_steps = swap->transition;
  }
  report_.adopted(version, arrival, swap);
  acknowledge(name, current);
}

void Simulator::acknowledge(const storage::EquipmentName& name, Running& running) {
  const identification::Score score = running.live.score();
  if (score.rows > 0) running.told.mrse_percent = score.mrse();
  running.told.steps = static_cast<std::uint64_t>(score.rows);
  running.told.steps_outside = running.live.ticks_outside();
  running.told.mode = running.live.is_following() ? "following" : "free";
  models_.acknowledge(name, running.told);
}

void Simulator::take_telemetry() {
  descriptors_.take(take_at_most, [this](storage::ParameterDescriptor&& descriptor) {
    for (auto& [name, running] : equipment_) running.live.describe(descriptor);
    parameters_[{descriptor.spacecraft, descriptor.id}] = std::move(descriptor);
  });
  frames_.take(take_at_most, [this](storage::TelemetryFrame&& frame) {
    for (auto& [name, running] : equipment_) running.live.add(frame);
  });
}

void Simulator::report_unpublished() const {
  std::vector<std::string> wanted = options_.subscription.equipment;
  if (wanted.empty()) wanted.emplace_back("*");
  const std::string& spacecraft = options_.subscription.spacecraft;
  for (const std::string& equipment : wanted)
    if (std::none_of(equipment_.begin(), equipment_.end(), [&](const auto& running) {
          const auto& [name, run] = running;
          return !run.told.from_cache && matches(spacecraft, name.spacecraft) &&
                 matches(equipment, name.equipment);
        }))
      report_.unpublished({spacecraft, equipment},
                          models_.unpublished_text({spacecraft, equipment}));
}

void Simulator::report_running() {
  for (auto& [name, running] : equipment_) {
    const identification::Score score = running.live.score();
    if (score.rows == running.reported && score.rows > 0) continue;
    running.reported = score.rows;
    report_.running(name, running.live, false);
    if (score.rows > 0) acknowledge(name, running);
  }
}

}  // namespace reident
