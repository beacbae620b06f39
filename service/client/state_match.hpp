// The state of a model that agrees best with recent inputs and outputs, found without allocating.
#pragma once

#include <vector>

#include "identification/simulation/state_space.hpp"
#include "service/client/step_kernel.hpp"

namespace reident {

/// Least squares of y[k] - (response from the zero state) = C A^k x0 over the rows that were added,
/// by Householder reflections (Golub and Van Loan, Matrix Computations, 5.2.2) of
/// [C A^k | y - response; ridge | 0]. Each output is weighed as in estimate_initial_state(). The
/// ridge is 1e-8 of each column, so that a state that the rows do not show stays small. After it
/// was made nothing allocates. One thread at a time.
class StateMatch {
 public:
  using Vector = identification::Vector;
  using Index = identification::Index;

  /// For at most `capacity` rows of a well-formed model. Model and kernel must outlive it.
  StateMatch(const identification::StateSpaceModel& model, const StepKernel& kernel,
             Index capacity);

  /// Forgets all rows.
  void clear();
  /// The tick after the last one that was added: deviations of the inputs (m) from u0 and of the
  /// outputs (p) from y0, all finite. Requires rows() below the capacity.
  void add(const Vector& du, const Eigen::Ref<const Vector>& dy);
  Index rows() const { return rows_; }

  /// The state at the tick after the last row, and what the model's outputs (less y0) are at the
  /// last one. The zero state where the rows give none.
  const Vector& solve();
  const Vector& last_output() const { return last_output_; }

 private:
  /// Takes for x_ the state that fits best where outputs are weighed by what the one before leaves.
  void estimate();
  /// Brings the first `rows` rows of the weighted system to triangular form.
  void triangularise(Index rows);
  /// Solves the triangular system for x_.
  void back_substitute();
  /// From x_ before the first row to behind the last one.
  void run_on();

  const identification::StateSpaceModel& model_;
  const StepKernel& kernel_;
  Index least_rows_of_errors_;       // fewer leave a state's errors, and not an output's
  identification::Matrix system_;    // capacity p rows, n + 1 columns
  identification::Matrix weighted_;  // n further rows, of the ridge
  identification::Matrix inputs_;    // m x capacity
  identification::Matrix visible_;   // n x p: (C A^k)'
  Vector next_;                      // n
  Vector forced_;                    // n: the state from zero
  Vector x_;                         // n
  Vector size_;                      // p: of the outputs
  Vector last_output_;               // p
  std::vector<double> out_;
  Index rows_ = 0;
};

}  // namespace reident
