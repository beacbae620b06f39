#include "service/client/state_match.hpp"

#include <algorithm>
#include <cmath>

#include "identification/simulation/initial_state.hpp"

namespace reident {
namespace {

using identification::Index;

constexpr double ridge = 1e-8;
constexpr double least_error = 1e-10;  // of an output's size, as in weights_of()

}  // namespace

StateMatch::StateMatch(const identification::StateSpaceModel& model, const StepKernel& kernel,
                       Index capacity)
    : model_(model),
      kernel_(kernel),
      least_rows_of_errors_(identification::initial_rows(model)),
      system_(capacity * model.outputs(), model.order() + 1),
      weighted_(system_.rows() + model.order(), model.order() + 1),
      inputs_(model.inputs(), capacity),
      visible_(model.order(), model.outputs()),
      next_(model.order()),
      forced_(model.order()),
      x_(model.order()),
      size_(model.outputs()),
      last_output_(model.outputs()),
      out_(kernel.out_room()) {
  clear();
}

void StateMatch::clear() {
  rows_ = 0;
  visible_ = model_.C.transpose();
  forced_.setZero();
  size_.setZero();
}

void StateMatch::add(const Vector& du, const Eigen::Ref<const Vector>& dy) {
  const Index n = model_.order(), p = model_.outputs();
  kernel_.run(forced_.data(), du.data(), out_.data());
  forced_ = Eigen::Map<const Vector>(out_.data(), n);
  for (Index q = 0; q < p; ++q) {
    const Index row = rows_ * p + q;
    system_.row(row).head(n) = visible_.col(q).transpose();
    system_(row, n) = dy(q) - out_[static_cast<std::size_t>(n + q)];
    size_(q) = std::max(size_(q), std::abs(dy(q) + model_.y0(q)));
    next_.noalias() = model_.A.transpose() * visible_.col(q);
    visible_.col(q) = next_;
  }
  inputs_.col(rows_) = du;
  ++rows_;
}

const StateMatch::Vector& StateMatch::solve() {
  x_.setZero();
  estimate();
  if (model_.outputs() > 1 && rows_ >= least_rows_of_errors_) estimate();
  if (!x_.allFinite()) x_.setZero();
  run_on();
  return x_;
}

void StateMatch::estimate() {
  const Index n = model_.order(), p = model_.outputs(), rows = rows_ * p;
  for (Index q = 0; q < p; ++q) {
    double squares = 0;
    for (Index row = q; row < rows; row += p) {
      const double left = system_(row, n) - system_.row(row).head(n).transpose().dot(x_);
      squares += left * left;
    }
    const double error =
        std::max(std::sqrt(squares / static_cast<double>(rows_)), least_error * size_(q));
    const double weight = p == 1 ? 1 : error > 0 ? 1 / error : 0;
    for (Index row = q; row < rows; row += p) weighted_.row(row) = weight * system_.row(row);
  }
  for (Index i = 0; i < n; ++i) {
    const double size = weighted_.col(i).head(rows).norm();
    weighted_.row(rows + i).setZero();
    weighted_(rows + i, i) = ridge * (size > 0 ? size : 1);
  }
  triangularise(rows + n);
  back_substitute();
}

/// Reflects each column onto its diagonal; the last one goes along.
void StateMatch::triangularise(Index rows) {
  const Index n = model_.order();
  for (Index j = 0; j < n; ++j) {
    auto v = weighted_.col(j).segment(j, rows - j);
    const double size = v.norm();
    if (!(size > 0)) continue;
    const double diagonal = v(0) > 0 ? -size : size;
    v(0) -= diagonal;
    const double scale = 2 / v.squaredNorm();
    for (Index c = j + 1; c <= n; ++c) {
      auto column = weighted_.col(c).segment(j, rows - j);
      column -= (scale * v.dot(column)) * v;
    }
    v(0) = diagonal;  // what lies below it is not looked at again
  }
}

void StateMatch::back_substitute() {
  for (Index i = model_.order(); i-- > 0;) {
    double rest = weighted_(i, model_.order());
    for (Index j = i + 1; j < model_.order(); ++j) rest -= weighted_(i, j) * x_(j);
    x_(i) = rest / weighted_(i, i);
  }
}

void StateMatch::run_on() {
  const Index n = model_.order();
  last_output_.setZero();
  for (Index k = 0; k < rows_; ++k) {
    kernel_.run(x_.data(), inputs_.col(k).data(), out_.data());
    x_ = Eigen::Map<const Vector>(out_.data(), n);
    last_output_ = Eigen::Map<const Vector>(out_.data() + n, model_.outputs());
  }
}

}  // namespace reident
