// Runs a model step by step, and exchanges it while it runs.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "service/client/prepared_model.hpp"

namespace reident {

/// A run of one equipment: free, from the inputs alone, or following the measured outputs, with
/// changes between the two and between versions that the output does not jump at. Arrays of inputs
/// and outputs are those of the declaration that its models were prepared for. step(), follow(),
/// observe() and swap() allocate nothing, lock nothing and make no system call.
///
/// Following. With a tracking gain the integral feedback of
/// identification/simulation/integral_feedback.hpp; when the run lets go, its correction fades.
/// Without one the Kalman gain: x[k+1] += K e[k], each error clamped to the output's identified
/// range.
///
/// Swap. The new model's state is the one that agrees best with the recent inputs and outputs. What
/// its output still differs by at the last step comes in linearly over so many steps that it adds
/// at most the output's own recent change per step, within [least, most]_transition.
class ModelRunner {
 public:
  using Vector = identification::Vector;
  using Index = identification::Index;

  static constexpr int least_transition = 60;
  static constexpr int most_transition = 1200;

  /// Has no model before the first swap(): its outputs are NaN.
  explicit ModelRunner(const Declaration& declaration);

  /// Has a model. Starts from the state that agrees best with measured rows, N x inputs and N x
  /// outputs, at ticks that follow each other; the next step is the tick after the last of them.
  void start(const identification::Matrix& u, const identification::Matrix& y);

  /// The outputs at this tick; the state moves on to the next one. Returns flags of client.h.
  int step(const double* u, double* y);
  /// A step corrected by what was measured at the ticks before; NaN where an output is missing.
  int follow(const double* u, const double* measured, double* y) { return advance(u, measured, y); }
  /// The measured outputs at the tick of the last step, where they are known and finite: a swap
  /// then estimates the state from them rather than from the model's own.
  void observe(const double* measured);

  struct Swap {
    Index rows = 0;      // of the past that the new state was estimated from
    double largest = 0;  // change of an output at the last step, in its unit
    int transition = 0;  // steps over which it comes in
  };
  /// Goes on with `next`, prepared for the same declaration; afterwards `next` is the model before,
  /// to be destroyed where that may take time. The first model, and one of another period, starts
  /// at its operating point (x = 0).
  Swap swap(std::unique_ptr<PreparedModel>& next);

  const PreparedModel* model() const { return model_.get(); }
  /// What was put out last; before the first step, what the model starts from.
  std::span<const double> output() const { return output_; }
  /// REIDENT_INPUT_MISSING and REIDENT_INPUT_OUTSIDE of a declared input at the last step.
  int input_flags(std::size_t declared) const {
    return model_ == nullptr ? 0 : model_->binding_.flags(declared);
  }
  bool is_following() const { return is_following_; }
  int transition_left() const { return transition_left_; }

 private:
  /// A step at which anything may happen.
  int advance(const double* u, const double* measured, double* y);
  void run_free();
  void run_corrected(const double* measured);
  void run_tracker(identification::Tracker& tracker);
  /// By the Kalman gain; whether any output was measured.
  bool correct_state();
  /// Adds what is left of a transition to the model's outputs. Returns REIDENT_IN_TRANSITION while
  /// there is more to come.
  int blend();
  /// The model's outputs become output(). Whether all of them are finite.
  bool put_out();
  /// The operating point takes the place of a run that is not finite any more. Returns
  /// REIDENT_DIVERGED.
  int start_over();
  void remember(const double* u);
  /// Sets the model's state and outputs to what agrees best with what is remembered.
  void match();
  Swap begin_transition();

  std::size_t row_size() const { return inputs_ + 2 * outputs_; }
  /// Remembered ones of the model's period.
  std::size_t matched_rows() const;
  /// The one of so many steps before the next one, at most as many as the ring has.
  const double* row_before(std::size_t back) const;
  /// The mean change of an output in a step, over the recent ones.
  double typical_change(std::size_t declared) const;

  std::unique_ptr<PreparedModel> model_;
  std::size_t inputs_, outputs_;  // declared
  std::vector<double> output_;    // at the last step
  // A ring of matched_rows rows of [inputs, outputs that are known best, outputs as put out].
  std::vector<double> past_;
  std::size_t at_ = 0;  // in past_, where the next row begins
  std::uint64_t steps_ = 0;
  std::uint64_t period_began_ = 0;  // steps before the first one of the model's period
  int transition_ = 1, transition_left_ = 0;
  bool is_following_ = false;
  bool tracker_runs_ = false;  // it follows, or its correction has not faded yet
};

}  // namespace reident
