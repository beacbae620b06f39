#include "service/client/simulator.hpp"

#include "service/support/utc_clock.hpp"

namespace reident {
namespace {

constexpr std::size_t take_at_most = 256;
// What a simulator may lag behind before it loses telemetry: it must never slow the source, which
// the archive depends on.
constexpr std::int32_t frames_kept = 16384;

}  // namespace

Simulator::Simulator(const SimulatorOptions& options)
    : options_(options),
      report_(options.json),
      participant_(options.endpoint),
      models_(participant_, options.subscription),
      descriptors_(participant_),
      frames_(participant_, {.keep_last = frames_kept}),
      ready_(participant_) {
  models_.attach_to(ready_);
  ready_.attach(descriptors_);
  ready_.attach(frames_);
}

void Simulator::run(const std::stop_token& stop) {
  const std::stop_callback wake(stop, [this] { ready_.wake(); });
  auto next_report = Clock::now() + options_.report_period;
  while (!stop.stop_requested()) {
    ready_.wait(std::max<Clock::duration>(next_report - Clock::now(), std::chrono::nanoseconds(1)));
    models_.poll([this](const ModelVersion& version) { adopt(version); },
                 [this](const ModelSubscriber::Refusal& refusal) { report_.refused(refusal); });
    take_telemetry();
    if (Clock::now() < next_report) continue;
    report_running();
    next_report = Clock::now() + options_.report_period;
  }
  for (const auto& [name, running] : equipment_) report_.running(name, running.live, true);
}

void Simulator::adopt(const ModelVersion& version) {
  const std::string& name = version.model.equipment;
  const auto running = equipment_.find(name);
  std::optional<ModelRunner::Swap> swap;
  if (running == equipment_.end()) {
    equipment_.emplace(name, Running{LiveEquipment(version), utc_now(), 0});
  } else {
    report_.running(name, running->second.live, true);
    swap = running->second.live.adopt(version);
    running->second.since = utc_now();
    running->second.reported = 0;
  }
  Running& current = equipment_.at(name);
  for (const auto& [id, descriptor] : parameters_) current.live.describe(descriptor);
  report_.adopted(version, swap);
  models_.acknowledge(name, current.since, std::numeric_limits<double>::quiet_NaN());
}

void Simulator::take_telemetry() {
  descriptors_.take(take_at_most, [this](storage::ParameterDescriptor&& descriptor) {
    if (descriptor.spacecraft != options_.subscription.spacecraft) return;
    for (auto& [name, running] : equipment_) running.live.describe(descriptor);
    parameters_[descriptor.id] = std::move(descriptor);
  });
  frames_.take(take_at_most, [this](storage::TelemetryFrame&& frame) {
    for (auto& [name, running] : equipment_) running.live.add(frame);
  });
}

void Simulator::report_running() {
  for (auto& [name, running] : equipment_) {
    const identification::Score score = running.live.score();
    if (score.rows == running.reported && score.rows > 0) continue;
    running.reported = score.rows;
    report_.running(name, running.live, false);
    if (score.rows > 0) models_.acknowledge(name, running.since, score.mrse());
  }
}

}  // namespace reident
