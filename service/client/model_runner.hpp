// Runs a model step by step, and exchanges it while it runs.
#pragma once

#include <string>
#include <vector>

#include "identification/record.hpp"
#include "service/model/model_version.hpp"

namespace reident {

/// Free run of a model: the outputs follow from the inputs alone. step() allocates nothing.
class ModelRunner {
 public:
  using Vector = identification::Vector;
  using Matrix = identification::Matrix;
  using Index = identification::Index;

  static constexpr int transition_steps = 60;

  /// Starts at the operating point (x = 0). `history_rows` are kept for a swap. The model's sizes
  /// must agree.
  explicit ModelRunner(EquipmentModel model, Index history_rows = 256);

  /// Starts from the state that agrees best with measured rows, N x m inputs and N x p outputs at
  /// ticks that follow each other; the next step is the tick after the last of them.
  void start(const Matrix& u, const Matrix& y);

  /// Output at this tick for the inputs `u` (m) at this tick; the state moves on to the next one.
  /// The reference is good until the next call.
  const Vector& step(const Vector& u);
  const Vector& output() const { return y_; }
  /// The measured output (p) at the tick of the last step, where it is known: a swap then estimates
  /// the state from it rather than from the model's own. Ignored where it is not finite.
  void observe(const Vector& y);

  /// Whether input `i` of the last step was outside the range that the model was identified in. The
  /// input is used as it is.
  bool is_outside(Index i) const { return outside_[static_cast<std::size_t>(i)] != 0; }
  bool is_any_outside() const;

  /// Whether the inputs, outputs and period of `next` are those of the model that runs.
  bool fits(const EquipmentModel& next) const;

  struct Swap {
    Index rows = 0;  // of the history that the new state was estimated from
    Vector change;   // new model's output at the last tick less what was put out there
  };
  /// Goes on with `next`, which fits, from the state that agrees best with the recent inputs and
  /// outputs. The output continues where it was: `change` comes in linearly over the next
  /// `transition_steps` steps.
  Swap swap(EquipmentModel next);

  const EquipmentModel& model() const { return model_; }

 private:
  void allocate();
  void remember(const Vector& u);
  /// States (n x (N + 1)) at each of the record's N rows and after them, from the initial state
  /// that agrees best with its outputs.
  Matrix states(const identification::Record& record) const;
  identification::Record recent() const;

  EquipmentModel model_;
  Vector x_, next_x_, du_, y_;
  Vector offset_;  // what is left of the old model's output in the new one's, while it fades
  int fading_ = 0;
  std::vector<std::uint8_t> outside_;
  Matrix past_u_, past_y_;  // rings: row `at_` is written next
  Index at_ = 0;
  Index remembered_ = 0;
};

}  // namespace reident
