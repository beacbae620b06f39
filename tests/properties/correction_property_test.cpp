// What holds for every pole placement and for a model that follows any telemetry.
#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "identification/correction/integral_feedback_search.hpp"
#include "identification/correction/pole_placement.hpp"
#include "tests/properties/any_record.hpp"

namespace reident::identification::correction_property_test {
namespace {

using reident::test::any_of;

/// Few different whole numbers: equal poles, chains, empty columns and modes out of reach abound.
Matrix any_whole(Index rows, Index columns, int largest) {
  Matrix result(rows, columns);
  for (Index r = 0; r < rows; ++r)
    for (Index c = 0; c < columns; ++c) result(r, c) = any_of(-largest, largest + 1);
  return result;
}

/// Distinct poles, pairs among them.
Poles any_wanted(Index count) {
  Poles poles;
  const auto rows = static_cast<std::size_t>(count);
  while (poles.size() < rows) {
    const double real = 0.13 * double(poles.size()) - 0.4;
    if (poles.size() + 2 <= rows && any_of(0, 2) == 1) {
      poles.emplace_back(real, 0.3);
      poles.emplace_back(real, -0.3);
    } else {
      poles.emplace_back(real, 0);
    }
  }
  return poles;
}

Index reached_modes(const Matrix& A, const Matrix& B) {
  Matrix reached(A.rows(), B.cols() * A.rows()), step = B;
  for (Index k = 0; k < A.rows(); ++k, step = (A * step).eval())
    reached.middleCols(k * B.cols(), B.cols()) = step;
  if (reached.size() == 0) return 0;
  Eigen::FullPivLU<Matrix> lu(reached);
  lu.setThreshold(1e-10);
  return lu.rank();
}

double distance(const Poles& poles, std::complex<double> pole) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& other : poles) nearest = std::min(nearest, std::abs(other - pole));
  return nearest;
}

RC_GTEST_PROP(AnyPlacement, MovesEveryModeThatIsReachedAndReportsTheOthers, ()) {
  const Index n = any_of<Index>(0, 7), m = any_of<Index>(0, 4);
  const Matrix A = any_whole(n, n, 2), B = any_whole(n, m, 1);
  const Poles wanted = any_wanted(n);
  const auto result = place_poles(A, B, wanted);
  const Index reached = reached_modes(A, B);
  if (std::holds_alternative<Verdict>(result)) {  // a pair was wanted of a single mode
    RC_ASSERT(reached < n);
    return;
  }
  const auto& placement = std::get<PolePlacement>(result);
  RC_ASSERT(static_cast<Index>(placement.uncontrollable.size()) == n - reached);
  RC_ASSERT(placement.gain.allFinite());
  // A pole that is k times there is known to the k-th root of the rounding.
  const Poles closed = poles_of(A - B * placement.gain), open = poles_of(A);
  Index moved = 0;
  for (const auto& pole : closed) moved += distance(wanted, pole) < 1e-3 ? 1 : 0;
  // A gain of 10^4 carries the rounding of A by itself further than that.
  RC_ASSERT(moved >= reached || (B * placement.gain).norm() > 1e4);
  for (const auto& pole : placement.uncontrollable) RC_ASSERT(distance(open, pole) < 1e-2);
}

RC_GTEST_PROP(AnyTelemetry, LeavesATrackerBounded, ()) {
  auto [model, noise] = test::any_setting({.order = 6, .inputs = 3, .outputs = 2});
  RC_PRE(model.inputs() >= model.outputs());
  Poles wanted = poles_of(model.A);
  for (Index i = 0; i < 2 * model.outputs(); ++i) wanted.push_back(0.4 + 0.1 * double(i));
  const auto placed = place_tracking_poles(model, wanted, Vector::Ones(model.outputs()));
  RC_PRE(std::holds_alternative<TrackingPlacement>(placed));
  const Vector x0 = Vector::Zero(model.order()), u = model.u0;
  Tracker tracker(model, std::get<TrackingPlacement>(placed).gain, x0);
  Matrix peak = model.D.cwiseAbs(), step = model.B;
  for (int k = 0; k < 1000; ++k, step = (model.A * step).eval())
    peak += (model.C * step).cwiseAbs();
  const Vector bound = (1 + 1e-9) * (peak * tracker.correction_limit());
  Vector y(model.outputs());
  for (int k = 0; k < 500; ++k) {
    for (double& value : y) value = noise.normal() * std::pow(10, any_of(-3, 300));
    if (any_of(0, 10) == 0) y(0) = std::numeric_limits<double>::quiet_NaN();
    const Vector y_hat = any_of(0, 5) == 0 ? tracker.step(u) : tracker.step(u, y);
    RC_ASSERT(((y_hat - model.y0).cwiseAbs().array() <= bound.array()).all());
  }
  Vector y_hat = model.y0;
  for (int k = 0; k < 2000; ++k) y_hat = tracker.step(u);
  RC_ASSERT((y_hat - model.y0).norm() <= 1e-6 * (1 + bound.norm()));
}

}  // namespace
}  // namespace reident::identification::correction_property_test
