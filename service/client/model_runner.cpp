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

constexpr std::uint64_t changes_averaged = 64;  // steps

}  // namespace

// What every step does: inlined, since the calls would take a good part of its time.

inline void ModelRunner::run_plain(const double* measured) {
  PreparedModel& model = *model_;
  const identification::StateSpaceModel& dynamics = model.dynamics();
  const Index n = dynamics.order(), m = dynamics.inputs(), p = dynamics.outputs();
  double* const du = model.now_ + n;
  for (Index i = 0; i < m; ++i) du[i] = model.u_[static_cast<std::size_t>(i)] - dynamics.u0(i);
  model.kernel_.run(model.now_, model.next_);
  std::swap(model.now_, model.next_);
  const double* const dy = model.now_ + n;
  for (Index q = 0; q < p; ++q) model.y_(q) = dy[q] + dynamics.y0(q);
  if (measured == nullptr || !model.has_kalman_gain_.load(std::memory_order_acquire)) return;
  Eigen::Map<Vector> x(model.now_, n);
  for (Index q = 0; q < p; ++q) {
    const double error = measured[model.outputs_[static_cast<std::size_t>(q)]] - model.y_(q);
    if (!std::isfinite(error)) continue;
    is_following_ = true;
    const double limit = model.error_limit_(q);
    x += std::clamp(error, -limit, limit) * dynamics.K.col(q);
  }
}

inline bool ModelRunner::put_out() {
  const PreparedModel& model = *model_;
  const double left =
      transition_left_ > 0 ? static_cast<double>(--transition_left_) / transition_ : 0;
  const double weight = steps_ < changes_averaged ? 1 / static_cast<double>(steps_ + 1)
                                                  : 1.0 / static_cast<double>(changes_averaged);
  bool is_finite = true;
  for (std::size_t q = 0; q < outputs_; ++q) {
    const auto at = static_cast<Index>(q);
    const std::size_t declared = model.outputs_[q];
    double put = model.y_(at);
    if (left > 0) put += left * model.offset_(at);
    is_finite = is_finite && std::isfinite(put);
    double& typical = typical_change_[declared];
    if (steps_ > 0) typical += weight * (std::abs(put - output_[declared]) - typical);
    output_[declared] = put;
  }
  return is_finite;
}

inline void ModelRunner::remember(const double* u) {
  double* row = past_.data() + at_ * (inputs_ + outputs_);
  for (std::size_t i = 0; i < inputs_; ++i) row[i] = u[i];
  for (std::size_t q = 0; q < outputs_; ++q) row[inputs_ + q] = output_[q];
  constexpr auto rows = static_cast<std::size_t>(PreparedModel::matched_rows);
  at_ = at_ + 1 == rows ? 0 : at_ + 1;
  remembered_ = std::min(remembered_ + 1, rows);
  ++steps_;
}

ModelRunner::ModelRunner(const Declaration& declaration)
    : inputs_(declaration.inputs.size()),
      outputs_(declaration.outputs.size()),
      output_(outputs_, std::numeric_limits<double>::quiet_NaN()),
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
  int flags = model.binding_.bind(u, model.u_.data());
  Tracker* tracker = measured != nullptr || tracker_runs_
                         ? model.tracker_.load(std::memory_order_acquire)
                         : nullptr;
  is_following_ = false;
  if (tracker != nullptr) {
    run_tracker(*tracker, measured);
  } else {
    run_plain(measured);
  }
  if (!put_out()) {
    start_over();
    put_out();
    flags |= REIDENT_DIVERGED;
  }
  remember(u);
  if (measured != nullptr) {
    observe(measured);
    if (!is_following_) flags |= REIDENT_NOT_FOLLOWING;
  }
  if (transition_left_ > 0) flags |= REIDENT_IN_TRANSITION;
  for (std::size_t q = 0; q < outputs_; ++q) y[q] = output_[q];
  return flags;
}

void ModelRunner::run_tracker(Tracker& tracker, const double* measured) {
  PreparedModel& model = *model_;
  const Index n = model.dynamics().order();
  Eigen::Map<Vector> x(model.now_, n);
  if (!tracker_runs_) tracker.restart(x);
  tracker_runs_ = true;
  model.measured_.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (measured != nullptr)
    for (std::size_t q = 0; q < outputs_; ++q)
      model.measured_(static_cast<Index>(q)) = measured[model.outputs_[q]];
  is_following_ = model.measured_.allFinite();
  model.y_ = tracker.step(Eigen::Map<const Vector>(model.u_.data(), model.dynamics().inputs()),
                          model.measured_);
  if (is_following_ || !tracker.has_let_go()) return;
  x = tracker.free_state();
  tracker_runs_ = false;
}

void ModelRunner::start_over() {
  std::fill(model_->both_.begin(), model_->both_.end(), 0.0);
  model_->y_ = model_->dynamics().y0;
  for (std::size_t q = 0; q < outputs_; ++q)
    output_[model_->outputs_[q]] = model_->y_(static_cast<Index>(q));
  std::fill(typical_change_.begin(), typical_change_.end(), 0.0);
  tracker_runs_ = false;
  is_following_ = false;
  transition_left_ = 0;
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
    model.binding_.bind(row, model.u_.data());
    model.du_ = Eigen::Map<const Vector>(model.u_.data(), model.du_.size()) - model.dynamics().u0;
    for (std::size_t q = 0; q < outputs_; ++q) {
      const auto at = static_cast<Index>(q);
      model.measured_(at) = row[inputs_ + model.outputs_[q]] - model.dynamics().y0(at);
    }
    model.match_.add(model.du_, model.measured_);
  }
  const Vector& x = model.match_.solve();
  std::copy_n(x.data(), x.size(), model.now_);
  model.y_ = model.dynamics().y0 + model.match_.last_output();
}

ModelRunner::Swap ModelRunner::swap(std::unique_ptr<PreparedModel>& next) {
  model_.swap(next);
  tracker_runs_ = false;
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
