#include "service/client/live_equipment.hpp"

#include "identification/simulate.hpp"

namespace reident {
namespace {

// Without a measured output for so many times the rows of a seed, the run starts without one.
constexpr identification::Index seed_patience = 10;

}  // namespace

LiveEquipment::LiveEquipment(const ModelVersion& version)
    : version_(version.number),
      tracker_(version.model),
      runner_(version.model),
      score_(version.model.dynamics.outputs()),
      hold_ns_(version.model.hold_ns) {
  forget_state();
}

void LiveEquipment::add(const storage::TelemetryFrame& frame) {
  tracker_.add(frame, [this](const Tick& tick) { run(tick); });
}

void LiveEquipment::forget_state() {
  const identification::StateSpaceModel& dynamics = runner_.model().dynamics;
  const identification::Index rows = identification::initial_rows(dynamics);
  running_ = false;
  seeded_ = 0;
  seed_ticks_ = 0;
  seed_u_.resize(rows, dynamics.inputs());
  seed_y_.resize(rows, dynamics.outputs());
}

void LiveEquipment::run(const Tick& tick) {
  if (last_tick_ && tick.number != *last_tick_ + 1) {
    ++gaps_;
    forget_state();
  }
  last_tick_ = tick.number;
  if (!running_) {
    seed(tick);
    return;
  }
  score_.add(tick.y, runner_.step(tick.u));
  runner_.observe(tick.y);
  if (runner_.is_any_outside()) ++ticks_outside_;
}

void LiveEquipment::seed(const Tick& tick) {
  ++seed_ticks_;
  if (tick.y.allFinite()) {
    seed_u_.row(seeded_) = tick.u.transpose();
    seed_y_.row(seeded_) = tick.y.transpose();
    ++seeded_;
  } else {
    seeded_ = 0;
  }
  if (seeded_ == seed_u_.rows()) {
    runner_.start(seed_u_, seed_y_);
    running_ = true;
  } else if (seed_ticks_ >= seed_patience * seed_u_.rows()) {
    runner_ = ModelRunner(runner_.model());
    running_ = true;
  }
}

std::optional<ModelRunner::Swap> LiveEquipment::adopt(const ModelVersion& version) {
  const bool continues = runner_.fits(version.model) && version.model.hold_ns == hold_ns_;
  if (!continues) {
    *this = LiveEquipment(version);
    return std::nullopt;
  }
  version_ = version.number;
  score_ = RunningScore(version.model.dynamics.outputs());
  ticks_outside_ = 0;
  const ModelRunner::Swap swap = runner_.swap(version.model);
  if (!running_) forget_state();
  return swap;
}

}  // namespace reident
