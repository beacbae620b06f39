// A version made ready to run: all that would allocate or take long is done beforehand.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "identification/simulation/integral_feedback.hpp"
#include "service/client/input_binding.hpp"
#include "service/client/state_match.hpp"
#include "service/client/step_kernel.hpp"
#include "service/model/model_version.hpp"

namespace reident {

/// What a simulator declares: the inputs that it supplies and the outputs that it wants, in the
/// order of its arrays.
struct Declaration {
  std::vector<DeclaredSignal> inputs;
  std::vector<DeclaredSignal> outputs;
};

/// Every input, derived ones as they are, and every output of a model, in its order.
Declaration declaration_of(const EquipmentModel& model);

/// How a version takes part in a run; ModelRunner alone looks into it while it runs. Neither copied
/// nor moved: its parts point to each other.
class PreparedModel {
 public:
  using Vector = identification::Vector;

  /// Rows of the recent past that a new state is estimated from.
  static constexpr identification::Index matched_rows = 128;

  /// Prepares a version that has no damage() (version_check.hpp). A sentence where the declaration
  /// does not cover its inputs, has another unit, or has other outputs than the version's.
  static std::variant<std::unique_ptr<PreparedModel>, std::string> make(
      ModelVersion version, const Declaration& declaration);
  PreparedModel(const PreparedModel&) = delete;
  PreparedModel& operator=(const PreparedModel&) = delete;
  ~PreparedModel();

  const ModelVersion& version() const { return version_; }
  const identification::StateSpaceModel& dynamics() const { return version_.model.dynamics; }

  /// Makes it ready to follow: by its integral feedback, else by its Kalman gain. This takes longer
  /// than all the rest; the run may begin before, on another thread, and runs freely until it is
  /// ready. A Kalman gain is taken where A - K C is stable. A second call has no effect.
  void prepare_following();

 private:
  friend class ModelRunner;
  PreparedModel(ModelVersion version, InputBinding binding, std::vector<std::size_t> outputs);

  ModelVersion version_;
  InputBinding binding_;
  std::vector<std::size_t> outputs_;  // of the model, in the declared ones
  StepKernel kernel_;
  StateMatch match_;
  std::atomic<identification::Tracker*> tracker_ = nullptr;  // owned
  // [x; y - y0], x of the next step and y of the last one, and room for what comes after it: the
  // two change places at each step.
  std::vector<double> both_;  // now_ and next_
  double *now_, *next_;
  Vector du_;           // m: u - u0, of the last step
  Vector u_;            // m: for the integral feedback
  Vector measured_;     // p
  Vector offset_;       // p: what is left of the model before, at the step of the swap
  Vector error_limit_;  // p: of the Kalman filter's innovations
  std::atomic<bool> has_kalman_gain_ = false;
};

/// Whether a run may change from one to the other unasked: the same inputs, outputs (names, units,
/// expressions; in any order) and period.
bool same_signals(const EquipmentModel& a, const EquipmentModel& b);

}  // namespace reident
