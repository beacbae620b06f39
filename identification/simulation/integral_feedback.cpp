#include "identification/simulation/integral_feedback.hpp"

#include <cassert>

#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/kernels.hpp"
#include "identification/simulation/initial_state.hpp"

namespace reident::identification {
namespace {

constexpr int response_ticks = 2000;
constexpr double settled = 1e-9;
constexpr double let_go = 1e-14;

void clamp(Vector& values, const Vector& limit) {
  values = values.cwiseMax(-limit).cwiseMin(limit);
}

bool sizes_agree(const StateSpaceModel& model, const TrackingGain& gain) {
  return gain.state.rows() == model.inputs() && gain.state.cols() == model.order() &&
         gain.integral.rows() == model.inputs() && gain.integral.cols() == 2 * model.outputs() &&
         gain.error_limit.size() == model.outputs();
}

}  // namespace

Matrix closed_loop(const StateSpaceModel& model, const TrackingGain& gain) {
  assert(sizes_agree(model, gain));
  const Index n = model.order(), p = model.outputs(), size = n + 2 * p;
  Matrix loop = Matrix::Zero(size, size);
  loop.topLeftCorner(n, n) = model.A;
  loop.block(n, 0, p, n) = -model.C;
  loop.bottomRightCorner(2 * p, 2 * p).setIdentity();
  loop.block(n + p, n, p, p).setIdentity();
  Matrix drive = Matrix::Zero(size, model.inputs()), feedback(model.inputs(), size);
  drive.topRows(n) = model.B;
  drive.middleRows(n, p) = -model.D;
  feedback << gain.state, gain.integral;
  return loop - drive * feedback;
}

bool is_stabilising(const StateSpaceModel& model, const TrackingGain& gain) {
  return sizes_agree(model, gain) && gain.error_limit.allFinite() &&
         (gain.error_limit.array() > 0).all() && is_stable(model.A) &&
         is_stable(closed_loop(model, gain));
}

Tracker::Tracker(const StateSpaceModel& model, const TrackingGain& gain, const Vector& x0)
    : model_(model), gain_(gain), x_f_(x0), d_(Vector::Zero(model.order())) {
  assert(is_well_formed(model) && is_stabilising(model, gain) && x0.size() == model.order());
  const Index m = model.inputs(), p = model.outputs();
  fading_ = spectral_radius(closed_loop(model, gain));
  integrators_of_v_ = -pseudo_inverse(gain.integral.rightCols(p));
  xi1_ = xi2_ = y_hat_ = e_ = Vector::Zero(p);
  v_ = v_next_ = bridge_ = du_ = Vector::Zero(m);
  next_ = d_peak_ = Vector::Zero(model.order());
  set_limits();
}

void Tracker::restart(const Eigen::Ref<const Vector>& x0) {
  x_f_ = x0;
  following_ = false;
  for (Vector* zero : {&d_, &d_peak_, &xi1_, &xi2_, &v_, &v_next_, &bridge_}) zero->setZero();
}

bool Tracker::has_let_go() const {
  return !following_ && (v_next_.array().abs() <= let_go * v_limit_.array()).all() &&
         (d_.array().abs() <= let_go * d_peak_.array()).all();
}

/// Sums |response| to an impulse of error_limit in each difference between telemetry and free run.
/// What is left of it at the end is counted as its envelope, which decays by the slowest pole.
void Tracker::set_limits() {
  const Index n = model_.order(), m = model_.inputs(), p = model_.outputs(), size = n + 2 * p;
  Matrix loop(size + m, size);  // the next state, and v
  loop.topRows(size) = closed_loop(model_, gain_);
  loop.bottomRows(m) << gain_.state, gain_.integral;
  Matrix response = Matrix::Zero(size, p), next(size + m, p);
  response.middleRows(n, p) = gain_.error_limit.asDiagonal();
  Vector sums = Vector::Zero(size + m), envelope = sums;
  sums.head(size) = response.cwiseAbs().rowwise().sum();
  for (int tick = 0; tick < response_ticks; ++tick) {
    next.noalias() = loop * response;
    response = next.topRows(size);
    const Vector now = next.cwiseAbs().rowwise().sum();
    sums += now;
    envelope = now.cwiseMax(fading_ * envelope);
    if ((envelope.array() <= settled * sums.array()).all()) break;
  }
  sums += envelope * (fading_ / (1 - fading_));
  v_limit_ = sums.tail(m);
  xi1_limit_ = sums.segment(n, p);
  xi2_limit_ = sums.segment(n + p, p);
}

void Tracker::predict(const Eigen::Ref<const Vector>& u) {
  v_.swap(v_next_);
  du_ = u - model_.u0;
  next_ = x_f_ + d_;
  y_hat_ = model_.y0;
  y_hat_.noalias() += model_.C * next_;
  y_hat_.noalias() += model_.D * du_;
  y_hat_.noalias() += model_.D * v_;
}

const Vector& Tracker::step(const Eigen::Ref<const Vector>& u) {
  predict(u);
  following_ = false;
  advance();
  v_next_ = fading_ * v_;
  return y_hat_;
}

const Vector& Tracker::step(const Eigen::Ref<const Vector>& u, const Eigen::Ref<const Vector>& y) {
  if (!y.allFinite()) return step(u);
  predict(u);
  e_ = y - y_hat_;
  clamp(e_, gain_.error_limit);
  if (!following_) match_integrators();
  following_ = true;
  xi2_ += xi1_;
  xi1_ += e_;
  clamp(xi1_, xi1_limit_);
  clamp(xi2_, xi2_limit_);
  advance();
  bridge_ *= fading_;
  v_next_ = bridge_;
  v_next_.noalias() -= gain_.state * d_;
  v_next_.noalias() -= gain_.integral.leftCols(xi1_.size()) * xi1_;
  v_next_.noalias() -= gain_.integral.rightCols(xi2_.size()) * xi2_;
  clamp(v_next_, v_limit_);
  return y_hat_;
}

void Tracker::match_integrators() {
  bridge_ = v_;
  bridge_.noalias() += gain_.state * d_;
  xi1_.setZero();
  xi2_.noalias() = integrators_of_v_ * bridge_;
  clamp(xi2_, xi2_limit_);
  bridge_.noalias() += gain_.integral.rightCols(xi2_.size()) * xi2_;
}

void Tracker::advance() {
  next_.noalias() = model_.A * d_;
  next_.noalias() += model_.B * v_;
  d_.swap(next_);
  d_peak_ = d_peak_.cwiseMax(d_.cwiseAbs());
  next_.noalias() = model_.A * x_f_;
  next_.noalias() += model_.B * du_;
  x_f_.swap(next_);
}

Matrix tracked_errors(const StateSpaceModel& model, const TrackingGain& gain,
                      const Eigen::Ref<const Matrix>& free_errors) {
  const Index n = model.order(), p = model.outputs(), size = n + 2 * p;
  Matrix M = Matrix::Zero(size + p, size + p);
  M.topLeftCorner(size, size) = closed_loop(model, gain);
  // An error is what its integrator gets.
  M.bottomLeftCorner(p, size) = M.block(n, 0, p, size);
  M.block(size, n, p, p) -= Matrix::Identity(p, p);
  M.block(n, size, p, p).setIdentity();
  M.bottomRightCorner(p, p).setIdentity();
  const Matrix driving = free_errors.transpose();
  Vector state = Vector::Zero(size), work(size + p);
  Matrix errors(p, free_errors.rows());
  run_state_space(M.data(), size, p, p, driving.data(), driving.cols(), state.data(), work.data(),
                  errors.data());
  return errors.transpose();
}

Matrix tracked_run(const StateSpaceModel& model, const TrackingGain& gain, const Record& record,
                   RowRange rows, const std::optional<Vector>& x0) {
  Matrix y_hat(rows.size(), model.outputs());
  Index out = 0;
  Vector u, y;
  for (const Segment& segment : segments_within(record, rows)) {
    const bool given = x0 && out == 0;
    Tracker tracker(model, gain,
                    given ? *x0 : estimate_initial_state(model, record, {segment}, state_rows));
    for (Index k = segment.begin; k < segment.end; ++k) {
      u = record.u.row(k).transpose();
      y = record.y.row(k).transpose();
      y_hat.row(out++) = tracker.step(u, y).transpose();
    }
  }
  return y_hat;
}

}  // namespace reident::identification
