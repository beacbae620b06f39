#include "service/client/equipment_runner.hpp"

#include "service/client/include/reident/client.h"
#include "service/support/utc_clock.hpp"

namespace reident {
namespace {

using identification::Vector;

Eigen::Map<const Vector> outputs(const double* values, std::size_t count) {
  return {values, static_cast<identification::Index>(count)};
}

}  // namespace

EquipmentRunner::EquipmentRunner(std::string spacecraft, std::string equipment,
                                 Declaration declaration)
    : spacecraft_(std::move(spacecraft)),
      equipment_(std::move(equipment)),
      declaration_(std::move(declaration)),
      runner_(declaration_),
      score_(static_cast<identification::Index>(declaration_.outputs.size())) {
  state_.mrse_percent = sent_state_.mrse_percent = score_.mrse();
}

EquipmentRunner::~EquipmentRunner() {
  delete posted_.load(std::memory_order_acquire);
  collect([](const Swapped&) {});
}

inline int EquipmentRunner::count(int flags) {
  ++state_.steps;
  if (flags == 0) return flags;
  if ((flags & REIDENT_INPUT_OUTSIDE) != 0) ++state_.steps_outside;
  if ((flags & REIDENT_INPUT_MISSING) != 0) ++state_.steps_missing;
  return flags;
}

int EquipmentRunner::step(const double* u, double* y) {
  if (posted_.load(std::memory_order_relaxed) == nullptr &&
      !state_is_wanted_.load(std::memory_order_relaxed)) [[likely]]
    return count(runner_.step(u, y));
  return advance(u, nullptr, y);
}

[[gnu::noinline]] int EquipmentRunner::advance(const double* u, const double* measured, double* y) {
  Parcel* const parcel = posted_.exchange(nullptr, std::memory_order_acq_rel);
  if (parcel != nullptr) begin(*parcel);
  int flags = count(measured == nullptr ? runner_.step(u, y) : runner_.follow(u, measured, y));
  if (measured != nullptr) {
    const std::size_t p = declaration_.outputs.size();
    score_.add(outputs(measured, p), outputs(y, p));
  }
  if (parcel != nullptr) {
    flags |= REIDENT_SWAPPED;
    state_.swapped = utc_now();
    parcel->swapped.state = state();
    send_back(parcel);
  }
  if (state_is_wanted_.load(std::memory_order_acquire)) {
    sent_state_ = state();
    state_is_wanted_.store(false, std::memory_order_release);
  }
  return flags;
}

void EquipmentRunner::begin(Parcel& parcel) {
  const ModelRunner::Swap swap = runner_.swap(parcel.model);
  const ModelVersion& version = runner_.model()->version();
  state_ = {};
  state_.version = version.number;
  state_.decided = version.decided;
  state_.period_s = version.model.dynamics.period_s;
  state_.remaining_step = swap.largest;
  state_.transition_steps = swap.transition;
  parcel.swapped.rows = swap.rows;
  score_.clear();
}

void EquipmentRunner::send_back(Parcel* parcel) {
  parcel->next = returned_.load(std::memory_order_relaxed);
  while (!returned_.compare_exchange_weak(parcel->next, parcel, std::memory_order_release,
                                          std::memory_order_relaxed)) {
  }
}

void EquipmentRunner::observe(const double* measured) {
  if (runner_.model() == nullptr) return;
  runner_.observe(measured);
  const std::size_t p = declaration_.outputs.size();
  score_.add(outputs(measured, p), outputs(runner_.output().data(), p));
}

RunState EquipmentRunner::state() const {
  RunState state = state_;
  state.is_following = runner_.is_following();
  state.transition_left = runner_.transition_left();
  state.mrse_percent = score_.mrse();
  return state;
}

void EquipmentRunner::post(std::unique_ptr<PreparedModel> model, const Arrival& arrival) {
  auto parcel = std::make_unique<Parcel>();
  parcel->model = std::move(model);
  parcel->swapped.arrival = arrival;
  PreparedModel* const prepared = parcel->model.get();
  const std::unique_ptr<Parcel> replaced(
      posted_.exchange(parcel.release(), std::memory_order_acq_rel));
  if (replaced == nullptr) ++under_way_;
  // The run may have begun: only this thread destroys what it has left, by collect().
  prepared->prepare_following();
}

void EquipmentRunner::collect(const std::function<void(const Swapped&)>& use) {
  Parcel* first = nullptr;
  for (Parcel* parcel = returned_.exchange(nullptr, std::memory_order_acquire);
       parcel != nullptr;) {
    Parcel* const next = parcel->next;
    parcel->next = first;
    first = parcel;
    parcel = next;
  }
  while (first != nullptr) {
    const std::unique_ptr<Parcel> parcel(first);
    first = parcel->next;
    --under_way_;
    use(parcel->swapped);
  }
}

const RunState& EquipmentRunner::last_state() {
  if (!state_is_wanted_.load(std::memory_order_acquire)) last_state_ = sent_state_;
  return last_state_;
}

}  // namespace reident
