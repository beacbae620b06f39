// One equipment of a simulator: a run on the simulator's thread, and versions that come from the
// client's, handed over without a lock.
//
// Models travel in parcels. The client's thread posts one; the run takes it at its next step and
// sends it back with the model that it has left, which the client's thread frees. So no step
// allocates, frees or waits.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "service/client/model_runner.hpp"
#include "service/client/model_subscriber.hpp"
#include "service/client/running_score.hpp"

namespace reident {

/// What a run says of itself.
struct RunState {
  std::int64_t version = 0;  // 0: none runs yet
  storage::Time decided = 0;
  storage::Time swapped = 0;  // its first step, by this machine's clock
  double period_s = 0;
  bool is_following = false;
  double mrse_percent = 0;  // since the swap; NaN before the first measured output
  std::uint64_t steps = 0;  // since the swap
  std::uint64_t steps_outside = 0;
  std::uint64_t steps_missing = 0;
  double remaining_step = 0;  // of the last swap, in the output's unit
  int transition_steps = 0;
  int transition_left = 0;
};

/// Two threads may use it at the same time, each its own calls; each of the two may be another
/// thread later, if it is ordered after the one before.
class EquipmentRunner {
 public:
  /// Has no version: outputs are NaN until one was posted. Names in the declaration are distinct.
  EquipmentRunner(std::string spacecraft, std::string equipment, Declaration declaration);
  /// Neither thread uses it any more.
  ~EquipmentRunner();
  EquipmentRunner(const EquipmentRunner&) = delete;
  EquipmentRunner& operator=(const EquipmentRunner&) = delete;

  const std::string& spacecraft() const { return spacecraft_; }
  const std::string& equipment() const { return equipment_; }
  const Declaration& declaration() const { return declaration_; }

  // The simulator's thread's. Arrays are those of the declaration. None allocates, takes a lock or
  // makes a system call (the clock that is read at a swap is in the kernel's shared page).

  /// One tick, as ModelRunner's; REIDENT_SWAPPED too at the first step on another version.
  int step(const double* u, double* y);
  /// One tick that `measured` corrects; NaN where an output is missing. It counts for the error.
  int follow(const double* u, const double* measured, double* y) { return advance(u, measured, y); }
  /// What was measured at the last step, which was free: it counts for the error and for the state
  /// of a next version. Call it once for a step at most.
  void observe(const double* measured);
  /// The state after the last step.
  RunState state() const;
  /// Flags of one declared input at the last step.
  int input_flags(std::size_t declared) const { return runner_.input_flags(declared); }

  // The client's thread's.

  /// Has the run go on with `model`, prepared for declaration(), at its next step. Takes the place
  /// of one that was posted before and that no step has taken yet.
  void post(std::unique_ptr<PreparedModel> model, const Arrival& arrival);
  /// Whether one is posted whose first step collect() has not reported yet.
  bool is_waiting() const { return under_way_ > 0; }
  /// A first step on a version that was posted.
  struct Swapped {
    RunState state;                  // after the step
    identification::Index rows = 0;  // that the new state was estimated from
    Arrival arrival;
  };
  /// Frees the models that the run has left; `use` is called for each swap since the last call, in
  /// their order, before this returns. It must not throw.
  void collect(const std::function<void(const Swapped&)>& use);
  /// Asks the run for its state; last_state() has it after the run's next step.
  void ask_state() { state_is_wanted_.store(true, std::memory_order_release); }
  /// The state at the last step that was asked for it; the initial one before there was any. Valid
  /// until the next call.
  const RunState& last_state();

 private:
  /// A model on its way to the run, and the one before on its way back.
  struct Parcel {
    std::unique_ptr<PreparedModel> model;
    Swapped swapped;
    Parcel* next = nullptr;
  };
  /// A step at which anything but a free run may happen.
  int advance(const double* u, const double* measured, double* y);
  /// Counts a step with its flags, and returns them.
  int count(int flags);
  /// Has the run go on with the parcel's model; afterwards the parcel has the one before.
  void begin(Parcel& parcel);
  void send_back(Parcel* parcel);

  const std::string spacecraft_, equipment_;
  const Declaration declaration_;

  ModelRunner runner_;
  RunningScore score_;
  RunState state_;

  int under_way_ = 0;  // parcels; the client's thread's
  std::atomic<Parcel*> posted_ = nullptr;
  std::atomic<Parcel*> returned_ = nullptr;  // the last one first
  // Whoever may not set it owns sent_state_: the run while it is true, the client otherwise.
  std::atomic<bool> state_is_wanted_ = false;
  RunState sent_state_, last_state_;
};

}  // namespace reident
