// What a step is measured against: the products of an order-6, 4-in, 1-out model and nothing else,
// unrolled.
#pragma once

#include "identification/simulation/state_space.hpp"

namespace reident::bench {

class Handwritten {
 public:
  explicit Handwritten(const identification::StateSpaceModel& model) {
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) a_[i][j] = model.A(i, j);
      for (int j = 0; j < 4; ++j) b_[i][j] = model.B(i, j);
      c_[i] = model.C(0, i);
    }
    for (int j = 0; j < 4; ++j) d_[j] = model.D(0, j), u0_[j] = model.u0(j);
    y0_ = model.y0(0);
  }
  double step(const double* u) {
    const double x0 = x_[0], x1 = x_[1], x2 = x_[2], x3 = x_[3], x4 = x_[4], x5 = x_[5];
    const double u0 = u[0] - u0_[0], u1 = u[1] - u0_[1], u2 = u[2] - u0_[2], u3 = u[3] - u0_[3];
    const auto row = [&](const double* a, const double* b) {
      return a[0] * x0 + a[1] * x1 + a[2] * x2 + a[3] * x3 + a[4] * x4 + a[5] * x5 + b[0] * u0 +
             b[1] * u1 + b[2] * u2 + b[3] * u3;
    };
    x_[0] = row(a_[0], b_[0]);
    x_[1] = row(a_[1], b_[1]);
    x_[2] = row(a_[2], b_[2]);
    x_[3] = row(a_[3], b_[3]);
    x_[4] = row(a_[4], b_[4]);
    x_[5] = row(a_[5], b_[5]);
    return row(c_, d_) + y0_;
  }

 private:
  double a_[6][6], b_[6][4], c_[6], d_[4], u0_[4], y0_, x_[6] = {};
};

}  // namespace reident::bench
