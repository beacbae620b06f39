#include "identification/statistics/diagnostics.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "identification/simulation/free_run.hpp"
#include "identification/subspace/kalman.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::diagnostics_test {
namespace {

/// A model of one output with white inputs and the noise of its innovations form; K suits it.
struct Plant {
  StateSpaceModel model;
  Record record;
};

Plant innovations(test::Noise& noise, Index rows, Index inputs = 2) {
  Plant plant{test::random_system(noise, 3, inputs, 1, 0.9), {}};
  plant.model.K =
      *kalman_gain(plant.model.A, plant.model.C, Matrix::Identity(4, 4));  // of equal noises
  plant.model.y0 << 10;
  const Matrix u = noise.normal(rows, inputs);
  Matrix y(rows, 1);
  Vector x = Vector::Zero(3);
  for (Index k = 0; k < rows; ++k) {
    const double e = noise.normal();
    y(k, 0) = (plant.model.C * x + plant.model.D * u.row(k).transpose())(0) + 10 + e;
    x = plant.model.A * x + plant.model.B * u.row(k).transpose() + plant.model.K * e;
  }
  plant.record = contiguous_record(1, u, y);
  return plant;
}

TEST(Diagnostics, OfTheTrueModelFindNothing) {
  test::Noise noise(1);
  int not_white = 0, significant = 0, free_significant = 0, pairs = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Plant plant = innovations(noise, 1000);
    const Diagnostics found =
        diagnose(plant.model, plant.record, plant.record.all(), {200, 1000}, Vector::Zero(3));
    ASSERT_TRUE(found.predicted);
    ASSERT_EQ(found.prediction_inputs.size(), 2u);
    EXPECT_EQ(found.rows, 800);
    not_white += !found.whiteness[0].portmanteau.white();
    for (const InputCorrelation& pair : found.prediction_inputs)
      significant += pair.correlation.significant();
    for (const InputCorrelation& pair : found.free_run_inputs)
      free_significant += pair.correlation.significant();
    pairs += 2;
  }
  EXPECT_LT(not_white, 12);
  EXPECT_LT(significant, 0.1 * pairs);
  EXPECT_LT(free_significant, 0.1 * pairs);
}

TEST(Diagnostics, AnInputThatSaturatesOrActsBySquaresBends) {
  test::Noise noise(7);
  const auto bend_of = [&](const auto& acts) {
    Plant plant = innovations(noise, 1000, 1);
    plant.model = test::random_system(noise, 1, 1, 1, 0.9);
    const Matrix u = noise.normal(1000, 1);
    const Record acting = contiguous_record(1, u.unaryExpr(acts), Matrix::Zero(1000, 1));
    const Matrix y = free_run(plant.model, acting, acting.all(), Vector::Zero(1));
    const Record record = contiguous_record(1, u, y + 0.01 * noise.normal(1000, 1));
    const Matrix y_hat = free_run(plant.model, record, record.all(), Vector::Zero(1));
    return bends(record, {200, 1000}, y_hat.bottomRows(800)).at(0).correlation;
  };
  for (const auto& found : {bend_of([](double u) { return std::clamp(u, -0.7, 0.7); }),
                            bend_of([](double u) { return u + 0.2 * u * u; })}) {
    EXPECT_TRUE(found.significant());
    EXPECT_GT(std::abs(found.largest), 0.25);
  }
  EXPECT_LT(std::abs(bend_of([](double u) { return u; }).largest), 0.2);
}

TEST(Diagnostics, OutputsThatAnswerAPowerShowTheProductOfItsInputs) {
  test::Noise noise(9);
  for (const double share : {0.0, 1.0}) {
    StateSpaceModel plant = test::random_system(noise, 1, 1, 1, 0.9);
    const Matrix u = noise.normal(1000, 3);
    const Matrix power = u.col(0) + share * u.col(0).cwiseProduct(u.col(2));
    const Record acting = contiguous_record(1, power, Matrix::Zero(1000, 1));
    const Matrix y = free_run(plant, acting, acting.all(), Vector::Zero(1));
    const Record record = contiguous_record(1, u, y + 0.01 * noise.normal(1000, 1));
    const Record linear = contiguous_record(1, u.leftCols(1), Matrix::Zero(1000, 1));
    const Matrix y_hat = free_run(plant, linear, linear.all(), Vector::Zero(1));
    const Bend found = bends(record, {200, 1000}, y_hat.bottomRows(800)).at(0);
    EXPECT_EQ(found.correlation.significant() && std::abs(found.correlation.largest) > 0.4,
              share > 0);
    if (share > 0) {
      EXPECT_EQ(std::pair(found.input, found.other), std::pair(Index{0}, Index{2}));
    }
  }
}

TEST(Diagnostics, AnInputOfTwoValuesCannotBend) {
  test::Noise noise(8);
  const Plant plant = innovations(noise, 1000, 1);
  Record record = plant.record;
  record.u = record.u.unaryExpr([](double u) { return u > 0 ? 1.0 : 0.0; });
  EXPECT_EQ(bends(record, {200, 1000}, Matrix::Zero(800, 1))[0].correlation.lags, 0);
}

TEST(Diagnostics, AWrongGainLeavesColouredResiduals) {
  test::Noise noise(2);
  Plant plant = innovations(noise, 2000);
  plant.model.K *= 0.2;
  const Diagnostics found = diagnose(plant.model, plant.record, plant.record.all(), {200, 2000});
  EXPECT_FALSE(found.whiteness[0].portmanteau.white());
  EXPECT_GT(found.whiteness[0].correlation.share_outside, 0.1);
}

TEST(Diagnostics, WithoutAGainLookAtTheFreeRun) {
  test::Noise noise(3);
  Plant plant = innovations(noise, 2000);
  plant.model.K.resize(0, 0);
  const Diagnostics found = diagnose(plant.model, plant.record, plant.record.all(), {200, 2000});
  EXPECT_FALSE(found.predicted);
  EXPECT_TRUE(found.predictions.empty());
  EXPECT_TRUE(found.prediction_inputs.empty());
  ASSERT_EQ(found.whiteness.size(), 1u);
  EXPECT_FALSE(found.whiteness[0].portmanteau.white());  // the noise went through the states
  EXPECT_EQ(found.free_run_inputs.size(), 2u);
}

TEST(Diagnostics, AnInputThatActsLaterThanTheModelSaysShowsAtItsDelay) {
  test::Noise noise(4);
  Plant plant = innovations(noise, 2000);
  for (Index k = 2000 - 1; k >= 9; --k) plant.record.y(k, 0) += 0.8 * plant.record.u(k - 9, 1);
  const Diagnostics found = diagnose(plant.model, plant.record, plant.record.all(), {200, 2000});
  const InputCorrelation& first = found.prediction_inputs[0];
  const InputCorrelation& second = found.prediction_inputs[1];
  EXPECT_FALSE(first.correlation.significant());
  EXPECT_EQ(second.input, 1);
  EXPECT_TRUE(second.correlation.significant());
  EXPECT_EQ(second.correlation.lag, 9);
  EXPECT_EQ(found.free_run_inputs[1].correlation.lag, 9);
}

TEST(Diagnostics, PredictionErrorsGrowToTheFreeRuns) {
  test::Noise noise(5);
  const Plant plant = innovations(noise, 5000);
  const Diagnostics found = diagnose(plant.model, plant.record, plant.record.all(), {500, 5000});
  ASSERT_EQ(found.predictions.size(), 7u);
  EXPECT_EQ(found.predictions.front().steps, 1);
  EXPECT_EQ(found.predictions.back().steps, 100);
  double before = 0;
  for (const PredictionScore& prediction : found.predictions) {
    EXPECT_GT(prediction.score.mrse(), before * 0.999) << prediction.steps;
    EXPECT_LT(prediction.score.mrse(), found.free_run.mrse() * 1.001) << prediction.steps;
    before = prediction.score.mrse();
  }
  EXPECT_NEAR(before, found.free_run.mrse(), 0.01 * before);
  EXPECT_LT(found.predictions.front().score.mrse(), 0.9 * found.free_run.mrse());
  // The innovations have the variance 1.
  const double size = plant.record.y.bottomRows(4500).norm() / std::sqrt(4500.0);
  EXPECT_NEAR(found.predictions.front().score.mrse(), 100 / size, 0.03 * 100 / size);
}

TEST(Diagnostics, GiveTheScoreOfTheFreeRunWithItsInterval) {
  test::Noise noise(6);
  const Plant plant = innovations(noise, 1500);
  const Vector x0 = Vector::Zero(3);
  const Diagnostics found = diagnose(plant.model, plant.record, {100, 1500}, {700, 1300}, x0);
  const Score score = score_free_run(plant.model, plant.record, {100, 1500}, {700, 1300}, x0);
  EXPECT_EQ(found.free_run.mrse_percent, score.mrse_percent);
  ASSERT_TRUE(found.interval);
  EXPECT_LT(found.interval->low(0), score.mrse());
  EXPECT_GT(found.interval->high(0), score.mrse());
  EXPECT_LE(found.spread.smallest(0), score.mrse());
  EXPECT_GE(found.spread.largest(0), score.mrse());
}

TEST(Diagnostics, SegmentsDoNotSpeakToEachOther) {
  test::Noise noise(7);
  Plant plant = innovations(noise, 1200, 1);
  plant.record.segments.clear();
  for (Index k = 0; k < 1200; k += 40) plant.record.segments.push_back({k, k + 40, 3 * k});
  const Diagnostics found = diagnose(plant.model, plant.record, plant.record.all(), {0, 1200});
  const Record joined = contiguous_record(1, plant.record.u, plant.record.y);
  EXPECT_EQ(found.predictions.back().steps, 20);  // the next, 50, is longer than any segment
  const Diagnostics whole = diagnose(plant.model, joined, joined.all(), {0, 1200});
  EXPECT_NE(found.whiteness[0].correlation.largest, whole.whiteness[0].correlation.largest);

  // In another order the segments say the same.
  Record turned = plant.record;
  turned.u << plant.record.u.bottomRows(600), plant.record.u.topRows(600);
  turned.y << plant.record.y.bottomRows(600), plant.record.y.topRows(600);
  const Diagnostics other = diagnose(plant.model, turned, turned.all(), {0, 1200});
  EXPECT_NEAR(other.whiteness[0].correlation.largest, found.whiteness[0].correlation.largest,
              1e-10);
  EXPECT_NEAR(other.prediction_inputs[0].correlation.largest,
              found.prediction_inputs[0].correlation.largest, 1e-10);
  for (std::size_t i = 0; i < found.predictions.size(); ++i)
    EXPECT_NEAR(other.predictions[i].score.mrse(), found.predictions[i].score.mrse(), 1e-9);
}

TEST(Diagnostics, OfOneRowAndOfNoInputsHaveNoCorrelations) {
  test::Noise noise(8);
  const Plant plant = innovations(noise, 100);
  const Diagnostics one = diagnose(plant.model, plant.record, plant.record.all(), {99, 100});
  EXPECT_EQ(one.rows, 1);
  EXPECT_EQ(one.predictions.size(), 1u);
  EXPECT_FALSE(one.interval);
  EXPECT_TRUE(one.whiteness[0].portmanteau.white());
  Plant lone = innovations(noise, 100, 0);
  EXPECT_TRUE(
      diagnose(lone.model, lone.record, lone.record.all(), {0, 100}).prediction_inputs.empty());
}

TEST(Diagnostics, OfAnInputThatStandsStillFindNothing) {
  test::Noise noise(9);
  Plant plant = innovations(noise, 500);
  plant.record.u.col(0).setConstant(0.1);
  const Diagnostics found = diagnose(plant.model, plant.record, plant.record.all(), {0, 500});
  EXPECT_EQ(found.prediction_inputs[0].correlation.largest, 0);
  EXPECT_FALSE(found.prediction_inputs[0].correlation.significant());
}

}  // namespace
}  // namespace reident::identification::diagnostics_test
