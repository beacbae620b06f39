#include "identification/simulation/prediction.hpp"

#include <gtest/gtest.h>

#include "identification/simulation/free_run.hpp"
#include "identification/simulation/initial_state.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::prediction_test {
namespace {

struct Setting {
  StateSpaceModel model;
  Record record;
};

/// A model of two inputs and two outputs with a K that keeps A - K C stable, and noisy rows.
Setting setting(std::uint64_t seed) {
  test::Noise noise(seed);
  StateSpaceModel model = test::random_system(noise, 3, 2, 2, 0.8);
  model.K = 0.05 * noise.normal(3, 2);
  model.u0 << 4, -7;
  model.y0 << 28, 3;
  Record record = test::excited(model, noise, 80, 0.3);
  return {std::move(model), std::move(record)};
}

/// By the definition: the observer runs to row t - steps, the model alone from there.
Matrix foretold(const Setting& s, const Segment& segment, Vector x, Index steps) {
  const StateSpaceModel& m = s.model;
  const auto du = [&](Index k) -> Vector { return s.record.u.row(k).transpose() - m.u0; };
  Matrix y_hat(segment.size(), 2);
  std::vector<Vector> states = {x};  // xh[k | k - 1]
  for (Index k = segment.begin; k < segment.end; ++k) {
    x = states.back();
    const Vector e = s.record.y.row(k).transpose() - m.C * x - m.D * du(k) - m.y0;
    states.push_back(m.A * x + m.B * du(k) + m.K * e);
  }
  for (Index k = segment.begin; k < segment.end; ++k) {
    const Index from = std::max(segment.begin, k - steps + 1);
    x = states[static_cast<std::size_t>(from - segment.begin)];
    for (Index j = from; j < k; ++j) x = m.A * x + m.B * du(j);
    y_hat.row(k - segment.begin) = (m.C * x + m.D * du(k) + m.y0).transpose();
  }
  return y_hat;
}

TEST(Predictor, ForetellsWhatTheObserverAndTheModelDo) {
  const Setting s = setting(1);
  const Vector x0 = Vector::Constant(3, 0.5);
  const Predictor predictor(s.model, s.record, s.record.all(),
                            free_run(s.model, s.record, s.record.all(), x0));
  for (const Index steps : {1, 2, 5, 79, 80, 200})
    EXPECT_LT((predictor.outputs(steps) - foretold(s, {0, 80, 0}, x0, steps)).cwiseAbs().maxCoeff(),
              1e-11)
        << steps;
}

TEST(Predictor, StartsAgainAfterAGap) {
  Setting s = setting(2);
  s.record = test::with_gap(s.record, 30, 40);
  const RowRange run{10, 60};
  const Matrix y_hat = free_run(s.model, s.record, run);
  const Predictor predictor(s.model, s.record, run, y_hat);
  const Segment after{30, 60, 40};
  Record as_run = s.record;
  as_run.y.middleRows(run.begin, run.size()) = y_hat;
  const Vector x = estimate_initial_state(s.model, as_run, {after}, initial_rows(s.model));
  for (const Index steps : {1, 4, 25})
    EXPECT_LT((predictor.outputs(steps).bottomRows(30) - foretold(s, after, x, steps))
                  .cwiseAbs()
                  .maxCoeff(),
              1e-11)
        << steps;
}

TEST(Predictor, IsTheFreeRunWhereTheGainIsZero) {
  Setting s = setting(3);
  s.model.K.setZero();
  const Matrix y_free = free_run(s.model, s.record, s.record.all());
  EXPECT_EQ(Predictor(s.model, s.record, s.record.all(), y_free).outputs(1), y_free);
}

}  // namespace
}  // namespace reident::identification::prediction_test
