#include "service/client/live_equipment.hpp"

#include "identification/simulation/initial_state.hpp"
#include "service/client/include/reident/client.h"

namespace reident {
namespace {

// Without a measured output for so many times the rows of a seed, the run starts without one.
constexpr identification::Index seed_patience = 10;

std::unique_ptr<PreparedModel> prepared(const ModelVersion& version,
                                        const Declaration& declaration) {
  auto made = PreparedModel::make(version, declaration);
  auto model = std::get<std::unique_ptr<PreparedModel>>(std::move(made));
  model->prepare_following();
  return model;
}

}  // namespace

LiveEquipment::LiveEquipment(const ModelVersion& version, Mode mode)
    : mode_(mode),
      declaration_(declaration_of(version.model)),
      tracker_(version.model),
      runner_(declaration_),
      score_(version.model.dynamics.outputs()),
      y_(version.model.dynamics.outputs()) {
  run_anew(version);
  forget_state();
}

void LiveEquipment::add(const storage::TelemetryFrame& frame) {
  tracker_.add(frame, [this](const Tick& tick) { run(tick); });
}

void LiveEquipment::run_anew(const ModelVersion& version) {
  runner_ = ModelRunner(declaration_);
  auto model = prepared(version, declaration_);
  runner_.swap(model);
}

void LiveEquipment::forget_state() {
  const identification::StateSpaceModel& dynamics = runner_.model()->dynamics();
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
  int flags = 0;
  if (mode_ == Mode::following) {
    flags = runner_.follow(tick.u.data(), tick.y.data(), y_.data());
  } else {
    flags = runner_.step(tick.u.data(), y_.data());
    runner_.observe(tick.y.data());
  }
  score_.add(tick.y, y_);
  if ((flags & REIDENT_INPUT_OUTSIDE) != 0) ++ticks_outside_;
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
    run_anew(ModelVersion(version()));
    running_ = true;
  }
}

std::optional<ModelRunner::Swap> LiveEquipment::adopt(const ModelVersion& next) {
  const EquipmentModel& current = version().model;
  if (!same_signals(current, next.model) || current.sample_hold_ns != next.model.sample_hold_ns ||
      current.phase_ns != next.model.phase_ns) {
    *this = LiveEquipment(next, mode_);
    return std::nullopt;
  }
  score_ = RunningScore(next.model.dynamics.outputs());
  ticks_outside_ = 0;
  std::unique_ptr<PreparedModel> model = prepared(next, declaration_);
  const ModelRunner::Swap swap = runner_.swap(model);
  if (!running_) forget_state();
  return swap;
}

}  // namespace reident
