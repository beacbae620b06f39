// Integral feedback of the real output: a model that follows live telemetry (the paper's figure 7).
//
// A correction input v is added to the inputs. With x_f the state of the free run, the deviation
// d = x - x_f from it and two chained integrators for each output,
//
//   yhat[k]  = C x[k] + D (u[k] - u0 + v[k]) + y0
//   e[k]     = y[k] - yhat[k], clamped to +-error_limit
//   d[k+1]   = A d[k] + B v[k]
//   xi1[k+1] = xi1[k] + e[k],   xi2[k+1] = xi2[k] + xi1[k]
//   v[k]     = -(state d[k] + integral [xi1[k]; xi2[k]])
//
// y[k] acts from tick k + 1 on: yhat[k] was said before y[k] was seen. A steady difference, and one
// that grows steadily, leave no lasting error.
//
// Bounds. v is clamped to what no difference within error_limit between telemetry and free run
// could ask of the loop: the sum of |impulse response| times error_limit, for each input; the
// integrators likewise. As A is stable, d is a stable filter of v, and whatever finite telemetry
// says, |yhat - y_free| is at most the sum of |C A^k B| and |D| times that clamp.
//
// Telemetry that stops. Without y[k] the correction fades, v[k+1] = rho v[k] with rho the modulus
// of the loop's slowest pole, and the run becomes the free run. When y returns, xi1 = 0 and the xi2
// of least squares stand for the v in force, and what they miss of it is added to v and fades by
// rho: there is no jump.
#pragma once

#include <optional>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Gains of the correction input. n, m and p are those of the model.
struct TrackingGain {
  Matrix state;        // m x n; of the state less that of the free run
  Matrix integral;     // m x 2p; of the two integrators of each output, chained
  Vector error_limit;  // p, output units; errors beyond it count as it
};

/// The loop [d; xi1; xi2] of n + 2p states that the gain closes; sizes agree.
Matrix closed_loop(const StateSpaceModel& model, const TrackingGain& gain);

/// Sizes agree, every number is finite, the limits are positive, and the model and the loop that
/// the gain closes are stable.
bool is_stabilising(const StateSpaceModel& model, const TrackingGain& gain);

/// Runs sample by sample. No step allocates memory.
class Tracker {
 public:
  /// Of a well-formed model and a gain that is_stabilising(), from the state x0 (n).
  Tracker(const StateSpaceModel& model, const TrackingGain& gain, const Vector& x0);

  /// yhat[k] with the inputs u[k] (m, finite), telemetry missing. Valid until the next step.
  const Vector& step(const Eigen::Ref<const Vector>& u);

  /// The same, followed by y[k] (p); as if missing where any of it is not finite.
  const Vector& step(const Eigen::Ref<const Vector>& u, const Eigen::Ref<const Vector>& y);

  /// Begins a run anew: the free state x0 (n) at the next step, no correction.
  void restart(const Eigen::Ref<const Vector>& x0);
  /// State of the free run at the next step (n).
  const Vector& free_state() const { return x_f_; }
  /// What is left of the correction is no more than rounding: from here on the run is the free run.
  bool has_let_go() const;

  /// v[k] of the last step, and the most that it can be (m, input units).
  const Vector& correction() const { return v_; }
  const Vector& correction_limit() const { return v_limit_; }

 private:
  void set_limits();
  void predict(const Eigen::Ref<const Vector>& u);
  void match_integrators();
  void advance();

  StateSpaceModel model_;
  TrackingGain gain_;
  Matrix integrators_of_v_;  // xi2 = integrators_of_v (v + state d), by least squares
  double fading_ = 0;
  bool following_ = false;
  Vector v_limit_, xi1_limit_, xi2_limit_;
  Vector x_f_, d_, xi1_, xi2_;
  Vector d_peak_;  // largest |d| since the run began
  Vector v_;       // of this tick
  Vector v_next_;  // of the next
  Vector bridge_;  // what the integrators miss of v since telemetry returned
  Vector du_, y_hat_, e_, next_;
};

/// Outputs (rows.size() x p) of the model that follows the record's outputs. Each segment starts as
/// free_run() starts it, with v = 0: nothing is carried over a gap.
Matrix tracked_run(const StateSpaceModel& model, const TrackingGain& gain, const Record& record,
                   RowRange rows, const std::optional<Vector>& x0 = std::nullopt);

}  // namespace reident::identification
