#include "service/client/model_runner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "service/client/include/reident/client.h"

namespace reident {
namespace {

using identification::Index;
using identification::Tracker;
using identification::Vector;

constexpr double changes_averaged = 64;  // steps

}  // namespace

ModelRunner::ModelRunner(const Declaration& declaration)
    : inputs_(declaration.inputs.size()),
      outputs_(declaration.outputs.size()),
      output_(outputs_, std::numeric_limits<double>::quiet_NaN()),
      before_(outputs_),
      change_(outputs_),
      typical_change_(outputs_),
      past_(static_cast<std::size_t>(PreparedModel::matched_rows) * (inputs_ + outputs_)) {}

void ModelRunner::start(const identification::Matrix& u, const identification::Matrix& y) {
  at_ = 0;
  remembered_ = 0;
  steps_ = 0;
  tracker_runs_ = false;
  std::vector<double> row(inputs_);
  for (Index k = 0; k < u.rows(); ++k) {
    Eigen::Map<Vector>(row.data(), u.cols()) = u.row(k).transpose();
    Eigen::Map<Vector>(output_.data(), y.cols()) = y.row(k).transpose();
    remember(row.data());
  }
  match();
  transition_left_ = 0;
}

int ModelRunner::advance(const double* u, const double* measured, double* y) {
  if (model_ == nullptr) {
    std::copy(output_.begin(), output_.end(), y);
    return REIDENT_NO_MODEL;
  }
  PreparedModel& model = *model_;
  int flags = model.binding_.bind(u, model.u_);
  model.du_ = model.u_ - model.dynamics().u0;
  Tracker* tracker = measured != nullptr || tracker_runs_
                         ? model.tracker_.load(std::memory_order_acquire)
                         : nullptr;
  is_following_ = false;
  if (tracker != nullptr) {
    run_tracker(*tracker, measured);
  } else {
    run_plain(measured);
  }
  if (!model.y_.allFinite()) {
    start_over();
    flags |= REIDENT_DIVERGED;
  }
  before_.swap(output_);
  put_out();
  remember(u);
  if (measured != nullptr) {
    observe(measured);
    if (!is_following_) flags |= REIDENT_NOT_FOLLOWING;
  }
  if (transition_left_ > 0) flags |= REIDENT_IN_TRANSITION;
  std::copy(output_.begin(), output_.end(), y);
  return flags;
}

void ModelRunner::run_tracker(Tracker& tracker, const double* measured) {
  PreparedModel& model = *model_;
  const Index n = model.dynamics().order();
  Eigen::Map<Vector> x(model.z_.data(), n);
  if (!tracker_runs_) tracker.restart(x);
  tracker_runs_ = true;
  model.measured_.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (measured != nullptr)
    for (std::size_t q = 0; q < outputs_; ++q)
      model.measured_(static_cast<Index>(q)) = measured[model.outputs_[q]];
  is_following_ = model.measured_.allFinite();
  model.y_ = tracker.step(model.u_, model.measured_);
  if (is_following_ || !tracker.has_let_go()) return;
  x = tracker.free_state();
  tracker_runs_ = false;
}

void ModelRunner::run_plain(const double* measured) {
  PreparedModel& model = *model_;
  const identification::StateSpaceModel& dynamics = model.dynamics();
  const Index n = dynamics.order(), m = dynamics.inputs(), p = dynamics.outputs();
  std::copy_n(model.du_.data(), m, model.z_.data() + n);
  model.kernel_.run(model.z_.data(), model.out_.data());
  std::copy_n(model.out_.data(), n, model.z_.data());
  for (Index q = 0; q < p; ++q)
    model.y_(q) = model.out_[static_cast<std::size_t>(n + q)] + dynamics.y0(q);
  if (measured == nullptr || !model.has_kalman_gain_) return;
  Eigen::Map<Vector> x(model.z_.data(), n);
  for (Index q = 0; q < p; ++q) {
    const double error = measured[model.outputs_[static_cast<std::size_t>(q)]] - model.y_(q);
    if (!std::isfinite(error)) continue;
    is_following_ = true;
    const double limit = model.error_limit_(q);
    x += std::clamp(error, -limit, limit) * dynamics.K.col(q);
  }
}

void ModelRunner::start_over() {
  std::fill(model_->z_.begin(), model_->z_.end(), 0.0);
  model_->y_ = model_->dynamics().y0;
  tracker_runs_ = false;
  is_following_ = false;
  transition_left_ = 0;
}

void ModelRunner::put_out() {
  const double left =
      transition_left_ > 0 ? static_cast<double>(--transition_left_) / transition_ : 0;
  for (std::size_t q = 0; q < outputs_; ++q) {
    const auto at = static_cast<Index>(q);
    output_[model_->outputs_[q]] = model_->y_(at) + left * model_->offset_(at);
  }
}

void ModelRunner::remember(const double* u) {
  double* row = past_.data() + at_ * (inputs_ + outputs_);
  std::copy_n(u, inputs_, row);
  std::copy_n(output_.data(), outputs_, row + inputs_);
  constexpr auto rows = static_cast<std::size_t>(PreparedModel::matched_rows);
  at_ = at_ + 1 == rows ? 0 : at_ + 1;
  remembered_ = std::min(remembered_ + 1, rows);
  if (steps_ > 0) {
    const double weight = 1 / std::min(static_cast<double>(steps_), changes_averaged);
    for (std::size_t q = 0; q < outputs_; ++q)
      typical_change_[q] += weight * (std::abs(output_[q] - before_[q]) - typical_change_[q]);
  }
  ++steps_;
}

void ModelRunner::observe(const double* measured) {
  if (remembered_ == 0) return;
  constexpr auto rows = static_cast<std::size_t>(PreparedModel::matched_rows);
  double* row = past_.data() + (at_ == 0 ? rows - 1 : at_ - 1) * (inputs_ + outputs_) + inputs_;
  for (std::size_t q = 0; q < outputs_; ++q)
    if (std::isfinite(measured[q])) row[q] = measured[q];
}

void ModelRunner::match() {
  PreparedModel& model = *model_;
  constexpr auto rows = static_cast<std::size_t>(PreparedModel::matched_rows);
  model.match_.clear();
  for (std::size_t back = remembered_; back > 0; --back) {
    const double* row = past_.data() + (at_ + rows - back) % rows * (inputs_ + outputs_);
    model.binding_.bind(row, model.u_);
    model.du_ = model.u_ - model.dynamics().u0;
    for (std::size_t q = 0; q < outputs_; ++q) {
      const auto at = static_cast<Index>(q);
      model.measured_(at) = row[inputs_ + model.outputs_[q]] - model.dynamics().y0(at);
    }
    model.match_.add(model.du_, model.measured_);
  }
  const Vector& x = model.match_.solve();
  std::copy_n(x.data(), x.size(), model.z_.data());
  model.y_ = model.dynamics().y0 + model.match_.last_output();
}

ModelRunner::Swap ModelRunner::swap(std::unique_ptr<PreparedModel>& next) {
  model_.swap(next);
  tracker_runs_ = false;
  std::fill(change_.begin(), change_.end(), 0.0);
  transition_left_ = 0;
  if (next != nullptr && next->dynamics().period_s != model_->dynamics().period_s) remembered_ = 0;
  if (steps_ == 0) {
    put_out();
    return {};
  }
  match();
  return begin_transition();
}

ModelRunner::Swap ModelRunner::begin_transition() {
  Swap swap{static_cast<Index>(remembered_), 0, least_transition};
  for (std::size_t q = 0; q < outputs_; ++q) {
    const std::size_t declared = model_->outputs_[q];
    const auto at = static_cast<Index>(q);
    const double offset = output_[declared] - model_->y_(at);
    model_->offset_(at) = offset;
    change_[declared] = -offset;
    swap.largest = std::max(swap.largest, std::abs(offset));
    if (offset == 0) continue;
    const double steps = std::abs(offset) / typical_change_[declared];
    swap.transition =
        std::max(swap.transition,
                 steps < most_transition ? static_cast<int>(std::ceil(steps)) : most_transition);
  }
  transition_ = transition_left_ = swap.transition;
  return swap;
}

}  // namespace reident
