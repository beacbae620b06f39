#include "service/client/model_runner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "service/client/include/reident/client.h"

namespace reident {
namespace {

using identification::Index;
using identification::StateSpaceModel;
using identification::Tracker;
using identification::Vector;

constexpr std::size_t changes_averaged = 64;

}  // namespace

// What every step does: inlined, since the calls would take a good part of its time.

inline void ModelRunner::run_free() {
  PreparedModel& model = *model_;
  model.kernel_.run(model.now_, model.du_.data(), model.next_);
  std::swap(model.now_, model.next_);
}

inline bool ModelRunner::put_out() {
  const PreparedModel& model = *model_;
  const Vector& y0 = model.dynamics().y0;
  const double* const dy = model.now_ + model.dynamics().order();
  bool is_finite = true;
  for (std::size_t q = 0; q < outputs_; ++q) {
    const double put = dy[q] + y0(static_cast<Index>(q));
    is_finite = is_finite && std::isfinite(put);
    output_[model.outputs_[q]] = put;
  }
  return is_finite;
}

inline void ModelRunner::remember(const double* u) {
  double* row = past_.data() + at_;
  for (std::size_t i = 0; i < inputs_; ++i) row[i] = u[i];
  for (std::size_t q = 0; q < outputs_; ++q)
    row[inputs_ + q] = row[inputs_ + outputs_ + q] = output_[q];
  at_ += row_size();
  if (at_ == past_.size()) at_ = 0;
  ++steps_;
}

ModelRunner::ModelRunner(const Declaration& declaration)
    : inputs_(declaration.inputs.size()),
      outputs_(declaration.outputs.size()),
      output_(outputs_, std::numeric_limits<double>::quiet_NaN()),
      past_(static_cast<std::size_t>(PreparedModel::matched_rows) * row_size()) {}

void ModelRunner::start(const identification::Matrix& u, const identification::Matrix& y) {
  period_began_ = steps_;
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

int ModelRunner::step(const double* u, double* y) {
  if (model_ == nullptr || tracker_runs_ || transition_left_ > 0) [[unlikely]]
    return advance(u, nullptr, y);
  int flags = model_->binding_.bind(u, model_->du_.data());
  is_following_ = false;
  run_free();
  if (!put_out()) [[unlikely]]
    flags |= start_over();
  remember(u);
  for (std::size_t q = 0; q < outputs_; ++q) y[q] = output_[q];
  return flags;
}

// What few steps do: apart, so that the others need not make room for it.

int ModelRunner::advance(const double* u, const double* measured, double* y) {
  if (model_ == nullptr) {
    std::copy(output_.begin(), output_.end(), y);
    return REIDENT_NO_MODEL;
  }
  PreparedModel& model = *model_;
  int flags = model.binding_.bind(u, model.du_.data());
  if (measured != nullptr || tracker_runs_) {
    run_corrected(measured);
  } else {
    is_following_ = false;
    run_free();
  }
  if (transition_left_ > 0) flags |= blend();
  if (!put_out()) flags |= start_over();
  remember(u);
  if (measured != nullptr) {
    observe(measured);
    if (!is_following_) flags |= REIDENT_NOT_FOLLOWING;
  }
  for (std::size_t q = 0; q < outputs_; ++q) y[q] = output_[q];
  return flags;
}

[[gnu::noinline]] void ModelRunner::run_corrected(const double* measured) {
  PreparedModel& model = *model_;
  model.measured_.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (measured != nullptr)
    for (std::size_t q = 0; q < outputs_; ++q)
      model.measured_(static_cast<Index>(q)) = measured[model.outputs_[q]];
  if (Tracker* tracker = model.tracker_.load(std::memory_order_acquire)) {
    run_tracker(*tracker);
  } else {
    run_free();
    is_following_ = model.has_kalman_gain_.load(std::memory_order_acquire) && correct_state();
  }
}

void ModelRunner::run_tracker(Tracker& tracker) {
  PreparedModel& model = *model_;
  const StateSpaceModel& dynamics = model.dynamics();
  Eigen::Map<Vector> x(model.now_, dynamics.order());
  if (!tracker_runs_) tracker.restart(x);
  tracker_runs_ = true;
  is_following_ = model.measured_.allFinite();
  model.u_ = model.du_ + dynamics.u0;
  Eigen::Map<Vector>(model.now_ + dynamics.order(), dynamics.outputs()) =
      tracker.step(model.u_, model.measured_) - dynamics.y0;
  if (is_following_ || !tracker.has_let_go()) return;
  x = tracker.free_state();
  tracker_runs_ = false;
}

bool ModelRunner::correct_state() {
  PreparedModel& model = *model_;
  const StateSpaceModel& dynamics = model.dynamics();
  Eigen::Map<Vector> x(model.now_, dynamics.order());
  const double* const dy = model.now_ + dynamics.order();
  bool corrects = false;
  for (Index q = 0; q < dynamics.outputs(); ++q) {
    const double error = model.measured_(q) - (dy[q] + dynamics.y0(q));
    if (!std::isfinite(error)) continue;
    corrects = true;
    const double limit = model.error_limit_(q);
    x += std::clamp(error, -limit, limit) * dynamics.K.col(q);
  }
  return corrects;
}

[[gnu::noinline]] int ModelRunner::blend() {
  PreparedModel& model = *model_;
  const double left = static_cast<double>(--transition_left_) / transition_;
  double* const dy = model.now_ + model.dynamics().order();
  for (std::size_t q = 0; q < outputs_; ++q) dy[q] += left * model.offset_(static_cast<Index>(q));
  return transition_left_ > 0 ? REIDENT_IN_TRANSITION : 0;
}

[[gnu::noinline]] int ModelRunner::start_over() {
  std::fill(model_->both_.begin(), model_->both_.end(), 0.0);
  put_out();
  tracker_runs_ = false;
  is_following_ = false;
  transition_left_ = 0;
  return REIDENT_DIVERGED;
}

void ModelRunner::observe(const double* measured) {
  if (steps_ == 0) return;
  double* const row = past_.data() + (at_ == 0 ? past_.size() : at_) - row_size() + inputs_;
  for (std::size_t q = 0; q < outputs_; ++q)
    if (std::isfinite(measured[q])) row[q] = measured[q];
}

std::size_t ModelRunner::matched_rows() const {
  return static_cast<std::size_t>(
      std::min<std::uint64_t>(steps_ - period_began_, PreparedModel::matched_rows));
}

const double* ModelRunner::row_before(std::size_t back) const {
  return past_.data() + (at_ + past_.size() - back * row_size()) % past_.size();
}

void ModelRunner::match() {
  PreparedModel& model = *model_;
  model.match_.clear();
  for (std::size_t back = matched_rows(); back > 0; --back) {
    const double* row = row_before(back);
    model.binding_.bind(row, model.du_.data());
    for (std::size_t q = 0; q < outputs_; ++q) {
      const auto at = static_cast<Index>(q);
      model.measured_(at) = row[inputs_ + model.outputs_[q]] - model.dynamics().y0(at);
    }
    model.match_.add(model.du_, model.measured_);
  }
  const Vector& x = model.match_.solve();
  std::copy_n(x.data(), x.size(), model.now_);
  const Vector& dy = model.match_.last_output();
  std::copy_n(dy.data(), dy.size(), model.now_ + x.size());
}

double ModelRunner::typical_change(std::size_t declared) const {
  const auto changes = std::min<std::uint64_t>(steps_ - 1, changes_averaged);
  if (changes == 0) return 0;
  double sum = 0;
  for (std::uint64_t back = changes; back > 0; --back) {
    const std::size_t at = inputs_ + outputs_ + declared;
    sum += std::abs(row_before(back)[at] - row_before(back + 1)[at]);
  }
  return sum / static_cast<double>(changes);
}

ModelRunner::Swap ModelRunner::swap(std::unique_ptr<PreparedModel>& next) {
  model_.swap(next);
  tracker_runs_ = false;
  transition_left_ = 0;
  if (next != nullptr && next->dynamics().period_s != model_->dynamics().period_s)
    period_began_ = steps_;
  if (steps_ == 0) {
    put_out();
    return {};
  }
  match();
  return begin_transition();
}

ModelRunner::Swap ModelRunner::begin_transition() {
  Swap swap{static_cast<Index>(matched_rows()), 0, least_transition};
  const Vector& y0 = model_->dynamics().y0;
  const double* const dy = model_->now_ + model_->dynamics().order();
  for (std::size_t q = 0; q < outputs_; ++q) {
    const std::size_t declared = model_->outputs_[q];
    const auto at = static_cast<Index>(q);
    const double offset = output_[declared] - (dy[q] + y0(at));
    model_->offset_(at) = offset;
    swap.largest = std::max(swap.largest, std::abs(offset));
    if (offset == 0) continue;
    const double steps = std::abs(offset) / typical_change(declared);
    swap.transition =
        std::max(swap.transition,
                 steps < most_transition ? static_cast<int>(std::ceil(steps)) : most_transition);
  }
  transition_ = transition_left_ = swap.transition;
  return swap;
}

}  // namespace reident
