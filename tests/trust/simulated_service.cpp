#include "tests/trust/simulated_service.hpp"

#include <algorithm>
#include <utility>

namespace reident::trust {
namespace {

constexpr Duration batch_time = 600'000'000'000;

}  // namespace

SimulatedService::SimulatedService(const Config& config)
    : config_(config),
      database_(config.database, storage::Database::Mode::read_write, config.durability),
      archive_(database_, {.recent_samples = config.recent_samples}),
      registry_(database_),
      feed_(
          config, [this] { return now_; }, [this] { return now_; }),
      leagues_(config, feed_),
      context_{{[this](const LeagueContext::Task& task) { task(registry_, archive_); },
                [this] { return now_; }, [] { return false; }},
               config.digest,
               {},
               &leagues_} {
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      kept_.push_back(window_cache_of(spacecraft.name, equipment));
}

void SimulatedService::describe(const std::vector<storage::ParameterDescriptor>& descriptors) {
  archive_.describe(descriptors);
  feed_.described(descriptors, archive_);
}

void SimulatedService::receive(storage::TelemetryFrame&& frame) {
  now_ = std::max(now_, frame.reception_time);
  if (batch_.empty()) batch_began_ = now_;
  batch_.push_back(std::move(frame));
  if (batch_.size() >= config_.batch_frames || now_ - batch_began_ >= batch_time) commit();
}

void SimulatedService::finish() {
  if (!batch_.empty()) commit();
  now_ += config_.settle;
  try_due_windows();
}

void SimulatedService::commit() {
  feed_.stored(batch_, archive_.append(batch_));
  batch_.clear();
  try_due_windows();
  leagues_.look(archive_, registry_, context_);
  try_due_windows();
}

void SimulatedService::try_due_windows() {
  while (const auto job = feed_.next_due()) {
    auto recorded =
        attempt_window(*job, archive_, registry_, kept_[job->window.equipment], context_);
    feed_.finished(*job, recorded.has_value());
    if (!recorded) continue;
    feed_.forget_settled(*job->spacecraft, archive_);
    storage::NewAttempt& attempt = recorded->result.attempt;
    attempts_.push_back({std::move(attempt.equipment), attempt.window, attempt.time,
                         std::move(attempt.trigger), std::move(attempt.outcome),
                         std::move(attempt.reason), recorded->version});
  }
}

}  // namespace reident::trust
