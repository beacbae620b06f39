// Integral feedback of the real output: a model that follows live telemetry (the paper's figure 7;
// METHOD.md, section 14).
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
// y[k] acts from tick k + 1 on: yhat[k] is given before y[k] is known. v and the integrators are
// clamped to what differences within error_limit can ask of the loop. So whatever finite telemetry
// says, yhat stays within a bound of the free run. Where telemetry stops, v fades by rho, the
// modulus of the loop's slowest pole; where it returns, v goes on without a jump.
//
// Nothing here throws. n, m and p are those of the model.
#pragma once

#include <optional>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Gains of the correction input.
struct TrackingGain {
  Matrix state;        // m x n; of the state less that of the free run
  Matrix integral;     // m x 2p; of the two integrators of each output, chained
  Vector error_limit;  // p, output units; errors beyond it count as it
};

/// Returns the matrix of the loop [d; xi1; xi2] (n + 2p states) that the gain closes. Requires
/// sizes that agree.
Matrix closed_loop(const StateSpaceModel& model, const TrackingGain& gain);

/// Whether sizes agree, every number is finite, the limits are positive, and the model and the loop
/// that the gain closes are stable. Requires a well-formed model; any gain may be asked.
bool is_stabilising(const StateSpaceModel& model, const TrackingGain& gain);

/// Follows telemetry sample by sample. No step allocates memory.
class Tracker {
 public:
  /// Begins at the state x0 (n). Requires a well-formed model and a gain that is_stabilising().
  Tracker(const StateSpaceModel& model, const TrackingGain& gain, const Vector& x0);

  /// Returns yhat[k] (p) for the inputs u[k] (m, finite), where telemetry is missing. The reference
  /// is valid until the next step.
  const Vector& step(const Eigen::Ref<const Vector>& u);

  /// Returns yhat[k], then takes y[k] (p) in; as if missing where any of it is not finite.
  const Vector& step(const Eigen::Ref<const Vector>& u, const Eigen::Ref<const Vector>& y);

  /// Begins another run: the free state x0 (n) at the next step, no correction.
  void restart(const Eigen::Ref<const Vector>& x0);
  /// Returns the state of the free run at the next step (n).
  const Vector& free_state() const { return x_f_; }
  /// Whether what is left of the correction is rounding: from here on the run is the free run.
  bool has_let_go() const;

  /// Return v[k] of the last step, and the most that it can be (m, input units).
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

/// Returns y[k] - yhat[k] (rows x p) of a run whose free run errs by `free_errors` (rows x p), from
/// v = 0. As tracked_run() where no error reaches error_limit, at a fraction of its time. Requires
/// sizes that agree.
Matrix tracked_errors(const StateSpaceModel& model, const TrackingGain& gain,
                      const Eigen::Ref<const Matrix>& free_errors);

/// Returns the outputs (rows.size() x p) of the model that follows the record's outputs. Each
/// segment starts from the estimated state, the first one from `x0` (n) where it is given, with
/// v = 0: nothing is carried over a gap. Requires what the Tracker does.
Matrix tracked_run(const StateSpaceModel& model, const TrackingGain& gain, const Record& record,
                   RowRange rows, const std::optional<Vector>& x0 = std::nullopt);

}  // namespace reident::identification
