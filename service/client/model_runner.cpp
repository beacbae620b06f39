#include "service/client/model_runner.hpp"

#include <algorithm>

#include "identification/simulate.hpp"

namespace reident {
namespace {

bool same_signals(const std::vector<Signal>& a, const std::vector<Signal>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Signal& x, const Signal& y) {
    return x.name == y.name && x.unit == y.unit && x.expression == y.expression;
  });
}

}  // namespace

ModelRunner::ModelRunner(EquipmentModel model, Index history_rows)
    : model_(std::move(model)),
      past_u_(history_rows, model_.dynamics.inputs()),
      past_y_(history_rows, model_.dynamics.outputs()) {
  allocate();
}

void ModelRunner::allocate() {
  const identification::StateSpaceModel& dynamics = model_.dynamics;
  x_ = Vector::Zero(dynamics.order());
  next_x_ = x_;
  du_ = Vector::Zero(dynamics.inputs());
  y_ = dynamics.y0;
  offset_ = Vector::Zero(dynamics.outputs());
  fading_ = 0;
  outside_.assign(model_.inputs.size(), 0);
}

void ModelRunner::start(const Matrix& u, const Matrix& y) {
  at_ = 0;
  remembered_ = 0;
  fading_ = 0;
  const auto record = identification::contiguous_record(model_.dynamics.period_s, u, y);
  x_ = states(record).rightCols(1);
  for (Index row = 0; row < u.rows(); ++row) {
    y_ = y.row(row).transpose();
    remember(u.row(row).transpose());
  }
}

const ModelRunner::Vector& ModelRunner::step(const Vector& u) {
  const identification::StateSpaceModel& dynamics = model_.dynamics;
  du_ = u - dynamics.u0;
  y_ = dynamics.y0;
  y_.noalias() += dynamics.C * x_;
  y_.noalias() += dynamics.D * du_;
  if (fading_ > 0) {
    --fading_;
    y_ += offset_ * (static_cast<double>(fading_) / transition_steps);
  }
  next_x_.noalias() = dynamics.A * x_;
  next_x_.noalias() += dynamics.B * du_;
  x_.swap(next_x_);
  for (std::size_t i = 0; i < outside_.size(); ++i) {
    const double value = u(static_cast<Index>(i));
    outside_[i] = !(value >= model_.inputs[i].low && value <= model_.inputs[i].high);
  }
  remember(u);
  return y_;
}

bool ModelRunner::is_any_outside() const {
  return std::find(outside_.begin(), outside_.end(), 1) != outside_.end();
}

void ModelRunner::observe(const Vector& y) {
  if (remembered_ == 0 || !y.allFinite()) return;
  past_y_.row((at_ + past_y_.rows() - 1) % past_y_.rows()) = y.transpose();
}

void ModelRunner::remember(const Vector& u) {
  if (past_u_.rows() == 0) return;
  past_u_.row(at_) = u.transpose();
  past_y_.row(at_) = y_.transpose();
  at_ = (at_ + 1) % past_u_.rows();
  remembered_ = std::min(remembered_ + 1, past_u_.rows());
}

identification::Record ModelRunner::recent() const {
  Matrix u(remembered_, past_u_.cols());
  Matrix y(remembered_, past_y_.cols());
  const Index capacity = past_u_.rows();
  for (Index row = 0; row < remembered_; ++row) {
    const Index from = (at_ - remembered_ + row + capacity) % capacity;
    u.row(row) = past_u_.row(from);
    y.row(row) = past_y_.row(from);
  }
  return identification::contiguous_record(model_.dynamics.period_s, std::move(u), std::move(y));
}

ModelRunner::Matrix ModelRunner::states(const identification::Record& record) const {
  const identification::StateSpaceModel& dynamics = model_.dynamics;
  Matrix x(dynamics.order(), record.rows() + 1);
  x.col(0) = identification::estimate_initial_state(dynamics, record, record.segments.front(),
                                                    record.rows());
  for (Index k = 0; k < record.rows(); ++k) {
    x.col(k + 1) = dynamics.A * x.col(k) + dynamics.B * (record.u.row(k).transpose() - dynamics.u0);
  }
  return x;
}

bool ModelRunner::fits(const EquipmentModel& next) const {
  return same_signals(model_.inputs, next.inputs) && same_signals(model_.outputs, next.outputs) &&
         model_.dynamics.period_s == next.dynamics.period_s;
}

ModelRunner::Swap ModelRunner::swap(EquipmentModel next) {
  const identification::Record record = recent();
  model_ = std::move(next);
  const Vector put_out = y_;
  allocate();
  y_ = put_out;
  if (record.rows() == 0) return {0, Vector::Zero(put_out.size())};

  const identification::StateSpaceModel& dynamics = model_.dynamics;
  const Matrix x = states(record);
  const Index last = record.rows() - 1;
  const Vector du = record.u.row(last).transpose() - dynamics.u0;
  x_ = x.col(last + 1);
  offset_ = put_out - (dynamics.C * x.col(last) + dynamics.D * du + dynamics.y0);
  fading_ = transition_steps;
  return {record.rows(), -offset_};
}

}  // namespace reident
