#include "identification/simulation/integral_feedback.hpp"

#include <cmath>
#include <limits>
#include <tuple>

#include <gtest/gtest.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "identification/correction/integral_feedback_search.hpp"
#include "identification/simulation/continuous.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::integral_feedback_test {
namespace {

/// A model of two inputs, an output and a loop around it with the given further poles.
struct Loop {
  StateSpaceModel model;
  TrackingGain gain;
};

Loop loop(std::uint64_t seed, Index n, Index m, Index p, double limit = 1) {
  test::Noise noise(seed);
  StateSpaceModel model = test::random_system(noise, n, m, p);
  model.u0.setConstant(2);
  model.y0.setConstant(28);
  Poles wanted = poles_of(model.A);
  for (Index i = 0; i < 2 * p; ++i) wanted.push_back(0.5 + 0.05 * double(i));
  const auto placed = place_tracking_poles(model, wanted, Vector::Constant(p, limit));
  if (const auto* verdict = std::get_if<Verdict>(&placed)) ADD_FAILURE() << verdict->reason;
  return {model, std::get<TrackingPlacement>(placed).gain};
}

/// sum |C A^k B| + |D|: how far a correction of at most 1 in each input moves the outputs.
Matrix peak_gain(const StateSpaceModel& model) {
  Matrix sum = model.D.cwiseAbs(), B = model.B;
  for (int k = 0; k < 5000; ++k, B = (model.A * B).eval()) sum += (model.C * B).cwiseAbs();
  return sum;
}

/// Runs the tracker and the free run; telemetry is the free run plus `difference`, missing where
/// that is not a number.
struct Runs {
  Matrix free, tracked, v;
};

Runs run(const Loop& l, const Matrix& difference) {
  test::Noise noise(99);
  const Index rows = difference.rows();
  Matrix u = noise.normal(rows, l.model.inputs()).array() + 2;
  const Vector x0 = noise.normal(l.model.order(), 1);
  Runs runs{test::simulated(l.model, u, x0), Matrix(rows, l.model.outputs()),
            Matrix(rows, l.model.inputs())};
  Tracker tracker(l.model, l.gain, x0);
  for (Index k = 0; k < rows; ++k) {
    const Vector u_k = u.row(k).transpose(),
                 y_k = (runs.free.row(k) + difference.row(k)).transpose();
    runs.tracked.row(k) = tracker.step(u_k, y_k).transpose();
    runs.v.row(k) = tracker.correction().transpose();
    EXPECT_TRUE((tracker.correction().array().abs() <= tracker.correction_limit().array()).all());
  }
  return runs;
}

TEST(Tracking, FollowsTheClosedLoopsEquations) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Loop l = loop(seed, 4, 3, 2, 1e3);
    test::Noise noise(seed);
    const Matrix difference = noise.normal(200, 2);
    const Runs runs = run(l, difference);
    const Matrix A = closed_loop(l.model, l.gain);
    Matrix feedback(3, 8);
    feedback << l.gain.state, l.gain.integral;
    Vector z = Vector::Zero(8);
    for (Index k = 0; k < 200; ++k) {
      const Vector v = -feedback * z;
      const Vector y = l.model.C * z.head(4) + l.model.D * v;
      EXPECT_LT((runs.v.row(k).transpose() - v).norm(), 1e-8 * (1 + v.norm()));
      EXPECT_LT((runs.tracked.row(k) - runs.free.row(k) - y.transpose()).norm(),
                1e-8 * (1 + y.norm()));
      z = A * z;
      z.segment(4, 2) += difference.row(k).transpose();
    }
  }
}

TEST(Tracking, ErrsAsTheLoopSaysWhereNoErrorReachesItsLimit) {
  for (const auto& [n, m, p] : {std::tuple<Index, Index, Index>{4, 3, 2}, {2, 1, 1}, {11, 2, 1}})
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Loop l = loop(seed, n, m, p, 1e6);
      const Matrix difference = test::Noise(seed).normal(300, p);
      const Runs runs = run(l, difference);
      const Matrix expected = runs.free + difference - runs.tracked;
      EXPECT_LT((tracked_errors(l.model, l.gain, difference) - expected).norm(),
                1e-8 * expected.norm());
    }
}

TEST(Tracking, LeavesNoErrorOfASteadyDifferenceOrASteadilyGrowingOne) {
  const Loop l = loop(1, 4, 2, 1, 50);
  Matrix difference(600, 1);
  for (Index k = 0; k < 600; ++k) difference(k) = k < 300 ? 3 : 3 + 0.02 * double(k - 300);
  const Runs runs = run(l, difference);
  const Matrix error = runs.free + difference - runs.tracked;
  EXPECT_LT(std::abs(error(299)), 1e-9);
  EXPECT_LT(std::abs(error(599)), 1e-9);
  EXPECT_GT(std::abs(runs.tracked(599) - runs.free(599)), 8);
}

TEST(Tracking, SaysTheOutputBeforeItSeesIt) {
  const Loop l = loop(2, 3, 2, 1);
  Matrix difference = Matrix::Zero(50, 1), other = difference;
  other(30) = 0.7;
  const Runs a = run(l, difference), b = run(l, other);
  EXPECT_EQ(a.tracked.topRows(31), b.tracked.topRows(31));
  EXPECT_NE(a.tracked(31), b.tracked(31));
}

TEST(Tracking, IsBoundedWhateverTelemetrySays) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Loop l = loop(seed, 4, 3, 2);
    test::Noise noise(seed);
    Matrix difference(3000, 2);
    for (Index k = 0; k < 3000; ++k)
      for (Index q = 0; q < 2; ++q) {
        difference(k, q) = noise.normal() * std::pow(10, 12 * noise.uniform() - 6);
        if (k % 500 > 300) difference(k, q) = 1e6;                   // a step
        if (k % 97 == 0) difference(k, q) = noise.normal() * 1e300;  // a spike
        if (k % 700 < 90) difference(k, q) = std::nan("");           // a stop
      }
    const Runs runs = run(l, difference);
    const Vector x0 = Vector::Zero(4);
    const Vector bound = peak_gain(l.model) * Tracker(l.model, l.gain, x0).correction_limit();
    for (Index q = 0; q < 2; ++q)
      EXPECT_LE((runs.tracked - runs.free).col(q).cwiseAbs().maxCoeff(), bound(q)) << seed;
  }
}

TEST(Tracking, NeverReachesItsLimitsWhileErrorsAreWithinTheirs) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Loop l = loop(seed, 4, 2, 1, 1e9);
    Loop limited = l;
    test::Noise noise(seed);
    Matrix difference(2000, 1);
    for (Index k = 0; k < 2000; ++k) difference(k) = noise.uniform() < 0.5 ? -1 : 1;
    const Runs wide = run(l, difference);
    limited.gain.error_limit(0) =
        (wide.free + difference - wide.tracked).cwiseAbs().maxCoeff() + 1e-9;
    EXPECT_LT((run(limited, difference).tracked - wide.tracked).norm(), 1e-9);
  }
}

TEST(Tracking, ForgetsASpike) {
  const Loop l = loop(3, 4, 2, 1);
  Matrix difference = Matrix::Constant(800, 1, 0.2);
  difference(300) = 1e6;
  const Runs runs = run(l, difference);
  EXPECT_NEAR(runs.tracked(799), runs.free(799) + 0.2, 1e-9);
}

TEST(Tracking, BecomesTheFreeRunWhenTelemetryStops) {
  const Loop l = loop(4, 4, 2, 1);
  Matrix difference = Matrix::Constant(900, 1, 0.5);
  difference.bottomRows(600).setConstant(std::nan(""));
  const Runs runs = run(l, difference);
  EXPECT_NEAR(runs.tracked(299), runs.free(299) + 0.5, 1e-9);
  EXPECT_NEAR(runs.tracked(899), runs.free(899), 1e-9);
  for (Index k = 301; k < 320; ++k) {  // in one proportion, towards zero
    EXPECT_LT(runs.v.row(k).norm(), runs.v.row(k - 1).norm());
    EXPECT_NEAR(runs.v(k, 0) * runs.v(k - 1, 1), runs.v(k, 1) * runs.v(k - 1, 0), 1e-12);
  }
}

TEST(Tracking, ResumesWithoutAJumpWhenTelemetryReturns) {
  for (const Index stop : {1, 2, 5, 20}) {
    const Loop l = loop(5, 4, 2, 1);
    Matrix difference = Matrix::Constant(1200, 1, 0.5);
    difference.middleRows(600, stop).setConstant(std::nan(""));
    const Runs runs = run(l, difference);
    const auto step = [&runs](Index k) { return (runs.v.row(k + 1) - runs.v.row(k)).norm(); };
    double largest_at_start = 0;  // when 0.5 arrives in one step
    for (Index k = 0; k < 100; ++k) largest_at_start = std::max(largest_at_start, step(k));
    for (Index k = 600 + stop; k < 700 + stop; ++k)
      EXPECT_LT(step(k), 1.01 * largest_at_start) << stop << ' ' << k;
    EXPECT_NEAR(runs.tracked(1199), runs.free(1199) + 0.5, 1e-9);
  }
}

TEST(Tracking, RestartsAsANewOneAndSaysWhenItHasLetGo) {
  const Loop l = loop(3, 4, 2, 1);
  test::Noise noise(5);
  const Vector x0 = noise.normal(4, 1), u = noise.normal(2, 1), y = Vector::Constant(1, 30);
  Tracker used(l.model, l.gain, Vector::Zero(4)), fresh(l.model, l.gain, x0);
  for (int k = 0; k < 50; ++k) used.step(u, y);
  EXPECT_FALSE(used.has_let_go());
  used.restart(x0);
  EXPECT_TRUE(used.has_let_go());
  for (int k = 0; k < 50; ++k) EXPECT_EQ(used.step(u, y), fresh.step(u, y));
  int ticks = 0;
  while (!used.has_let_go() && ticks < 5000) ++ticks, used.step(u);
  EXPECT_GT(ticks, 10);
  EXPECT_LT(ticks, 5000);
  Tracker free(l.model, l.gain, used.free_state());
  EXPECT_NEAR(used.step(u)(0), free.step(u)(0), 1e-12);
}

TEST(Tracking, OfARecordStartsEachSegmentAnew) {
  const Loop l = loop(6, 3, 2, 1, 10);
  test::Noise noise(6);
  Record record = test::excited(l.model, noise, 400, 0.3);
  const Record gapped = test::with_gap(record, 150, 200);
  const Matrix y_hat = tracked_run(l.model, l.gain, gapped, gapped.all());
  const Matrix second = tracked_run(l.model, l.gain, gapped, {150, 350});
  EXPECT_EQ(y_hat.bottomRows(200), second);
  EXPECT_EQ(y_hat.rows(), 350);
}

TEST(TrackingGain, IsRefusedWhereItDoesNotFitOrDoesNotStabilise) {
  Loop l = loop(7, 3, 2, 1);
  EXPECT_TRUE(is_stabilising(l.model, l.gain));
  TrackingGain wrong = l.gain;
  wrong.integral *= -1;
  EXPECT_FALSE(is_stabilising(l.model, wrong));
  wrong = l.gain;
  wrong.state.resize(2, 2);
  EXPECT_FALSE(is_stabilising(l.model, wrong));
  wrong = l.gain;
  wrong.error_limit(0) = 0;
  EXPECT_FALSE(is_stabilising(l.model, wrong));
  wrong = l.gain;
  wrong.state(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_stabilising(l.model, wrong));
}

/// dx/dt = A x + B v, d xi1/dt = r - C x, d xi2/dt = xi1, v = -(K_x x + K_1 xi1 + K_2 xi2)
struct ContinuousLoop {
  ContinuousModel model;
  Matrix open, drive, gain;
};

ContinuousLoop continuous_loop(const Poles& poles) {
  ContinuousModel model{Matrix(2, 2),       Matrix(2, 1),    Matrix(1, 2),
                        Matrix::Zero(1, 1), Vector::Zero(1), Vector::Zero(1)};
  model.A << 0, 1, -2, -0.8;
  model.B << 0, 1;
  model.C << 1.5, 0.3;
  Matrix open = Matrix::Zero(4, 4), drive = Matrix::Zero(4, 1);
  open.topLeftCorner(2, 2) = model.A;
  open.block(2, 0, 1, 2) = -model.C;
  open(3, 2) = 1;
  drive.topRows(2) = model.B;
  return {model, open, drive, std::get<PolePlacement>(place_poles(open, drive, poles)).gain};
}

TEST(ContinuousTracking, IsTheLimitOfShortPeriods) {
  const Poles poles{{-1, 0.5}, {-1, -0.5}, -2, -2.5};
  const ContinuousLoop continuous = continuous_loop(poles);
  const double time = 2;
  // z' = (open - drive gain) z + [0 0 1 0]' for r = 1, from rest
  Matrix block = Matrix::Zero(5, 5);
  block.topLeftCorner(4, 4) = continuous.open - continuous.drive * continuous.gain;
  block(2, 4) = 1;
  const double y = (continuous.model.C * Matrix((block * time).exp()).topRightCorner(2, 1))(0);
  double before = 0;
  for (const int steps : {50, 100, 200, 400, 800}) {
    const double T = time / steps;
    const StateSpaceModel model = to_discrete(continuous.model, T);
    Poles sampled;
    for (const auto& pole : poles) sampled.push_back(std::exp(pole * T));
    const auto placed = place_tracking_poles(model, sampled, Vector::Constant(1, 1e3));
    ASSERT_TRUE(std::holds_alternative<TrackingPlacement>(placed));
    const TrackingGain& gain = std::get<TrackingPlacement>(placed).gain;
    Tracker tracker(model, gain, Vector::Zero(2));
    const Vector u = Vector::Zero(1), reference = Vector::Ones(1);
    double y_hat = 0;
    for (int k = 0; k <= steps; ++k) y_hat = tracker.step(u, reference)(0);
    const double error = std::abs(y_hat - y);
    if (before > 0) {
      EXPECT_NEAR(before / error, 2, 0.2) << steps;  // of first order in T
    }
    before = error;
    if (steps < 800) continue;
    // The integrators add up e where the continuous ones add up e T.
    EXPECT_LT((gain.state - continuous.gain.leftCols(2)).norm(), 0.02 * continuous.gain.norm());
    EXPECT_NEAR(gain.integral(0) / T, continuous.gain(2), 0.02 * continuous.gain.norm());
    EXPECT_NEAR(gain.integral(1) / T / T, continuous.gain(3), 0.02 * continuous.gain.norm());
  }
  EXPECT_LT(before, 2e-3 * std::abs(y));
}

}  // namespace
}  // namespace reident::identification::integral_feedback_test
