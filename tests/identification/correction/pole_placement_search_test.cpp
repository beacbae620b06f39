#include "identification/correction/pole_placement_search.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "identification/simulation/free_run.hpp"
#include "identification/simulation/scores.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::pole_placement_search_test {
namespace {

/// Slowly moving inputs with a mean.
Matrix inputs(test::Noise& noise, Index rows, Index m) {
  Matrix u = noise.normal(rows, m);
  for (Index k = 1; k < rows; ++k) u.row(k) += 0.95 * u.row(k - 1);
  return u.array() + 3;
}

/// A lag of the given pole and static gain around an operating point.
StateSpaceModel lag(double pole, double gain) {
  const auto one = [](double value) { return Matrix::Constant(1, 1, value); };
  return {one(pole),
          one(1 - pole),
          one(gain),
          one(0),
          {},
          Vector::Constant(1, 3),
          Vector::Constant(1, 20),
          1};
}

Record record_of(const StateSpaceModel& truth, Index rows) {
  test::Noise noise(1);
  const Matrix u = inputs(noise, rows, truth.inputs());
  const Matrix y = test::simulated(truth, u, Vector::Zero(truth.order()));
  return contiguous_record(1, u, y);
}

TEST(ScaledPole, IsThePaperEigenvalueTimesTheScale) {
  EXPECT_NEAR(scaled_pole(0.9, 2).real(), 0.81, 1e-15);
  EXPECT_NEAR(scaled_pole(0.25, 0.5).real(), 0.5, 1e-15);
  const auto pair = scaled_pole(std::polar(0.81, 0.4), 0.5);
  EXPECT_NEAR(std::abs(pair), 0.9, 1e-15);
  EXPECT_NEAR(std::arg(pair), 0.2, 1e-15);
}

TEST(ScaledPole, KeepsAnAngleThatWouldPassHalfOfTheSampleRate) {
  const auto pole = scaled_pole(std::polar(0.9, 1.6), 2);
  EXPECT_NEAR(std::abs(pole), 0.81, 1e-15);
  EXPECT_NEAR(std::arg(pole), 1.6, 1e-15);
}

TEST(ScaledPole, KeepsTheSignOfNegativePolesAndLeavesPolesAtZero) {
  EXPECT_NEAR(scaled_pole(-0.25, 0.5).real(), -0.5, 1e-15);
  EXPECT_EQ(scaled_pole(0, 0.1), 0.0);
  EXPECT_EQ(scaled_pole(1e-9, 0.1), 1e-9);
}

TEST(Correction, MendsATimeConstantThatIsWrong) {
  const Record record = record_of(lag(0.9, 2), 3000);
  const CorrectionSearch search = search_correction(lag(0.81, 2), record, {0, 1500}, {1500, 3000});
  ASSERT_TRUE(search.best);
  EXPECT_TRUE(search.best->keeps_static_gain);
  EXPECT_NEAR(search.best->scale, 0.5, 0.02);
  EXPECT_NEAR(search.best->model.A(0, 0), 0.9, 0.002);
  EXPECT_NEAR((*static_gain(search.best->model))(0), 2, 1e-12);
  EXPECT_LT(search.best->error.mrse(), 0.05 * search.plain.mrse());
}

TEST(Correction, ByThePapersFigureMovesTheStaticGainWithThePole) {
  // u - F x of a lag without N: x+ = a x + (1 - a)(u - f x) with a - (1 - a) f = 0.9
  StateSpaceModel truth = lag(0.9, 2);
  truth.B *= 0.19 / 0.1;
  const Record record = record_of(truth, 3000);
  const CorrectionSearch search = search_correction(lag(0.81, 2), record, {0, 1500}, {1500, 3000});
  ASSERT_TRUE(search.best);
  EXPECT_FALSE(search.best->keeps_static_gain);
  EXPECT_NEAR(search.best->scale, 0.5, 0.02);
  EXPECT_EQ(search.best->input_gain, Matrix::Identity(1, 1));
}

TEST(Correction, LeavesAModelThatIsRight) {
  const StateSpaceModel truth = lag(0.9, 2);
  Record record = record_of(truth, 3000);
  test::Noise noise(2);
  record.y += noise.normal(3000, 1);
  const CorrectionSearch search = search_correction(truth, record, {0, 1500}, {1500, 3000});
  EXPECT_FALSE(search.best);
  EXPECT_GT(search.plain.mrse(), 0);
}

/// A system and a model of it whose poles are those of another sample period.
struct Mistaken {
  StateSpaceModel model;
  Record record;
};

Mistaken mistaken(std::uint64_t seed) {
  test::Noise noise(seed);
  StateSpaceModel truth = test::random_system(noise, 4, 2, 2, 0.97);
  StateSpaceModel model = truth;
  model.A = (truth.A * truth.A).eval();
  model.y0 << 5, -2;
  const Matrix u = inputs(noise, 2000, 2);
  return {model, contiguous_record(1, u, test::simulated(truth, u, Vector::Zero(4)))};
}

TEST(Correction, ReportsTheErrorOfTheModelThatItGives) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Mistaken m = mistaken(seed);
    const CorrectionSearch search = search_correction(m.model, m.record, {0, 1000}, {1000, 2000});
    const auto error = [&m](const StateSpaceModel& model) {
      return score_free_run(model, m.record, {0, 2000}, {1000, 2000}).mrse();
    };
    EXPECT_EQ(search.plain.mrse(), error(m.model));
    if (!search.best) continue;
    EXPECT_EQ(search.best->error.mrse(), error(search.best->model));
    EXPECT_LT(search.best->error.mrse(), 0.99 * search.plain.mrse());
    EXPECT_TRUE(is_well_formed(search.best->model));
    EXPECT_TRUE(is_stable(search.best->model.A));
    EXPECT_EQ(search.best->model.K.size(), 0);
  }
}

TEST(Correction, KeepsTheMeanResidualOfTheIdentifiedRows) {
  const Mistaken m = mistaken(3);
  const CorrectionSearch search = search_correction(m.model, m.record, {0, 1000}, {1000, 2000});
  ASSERT_TRUE(search.best);
  const auto residual = [&m](const StateSpaceModel& model) -> Vector {
    return (m.record.y.topRows(1000) - free_run(model, m.record, {0, 1000}))
        .colwise()
        .mean()
        .transpose();
  };
  const Vector before = residual(m.model), after = residual(search.best->model);
  EXPECT_LT((after - before).norm(), 0.02 * (1 + before.norm()));
}

TEST(Correction, IsTheModelWithItsOwnFeedback) {
  const Mistaken m = mistaken(3);
  const CorrectionSearch search = search_correction(m.model, m.record, {0, 1000}, {1000, 2000});
  ASSERT_TRUE(search.best);
  const Correction& best = *search.best;
  EXPECT_LT((best.model.A - (m.model.A - m.model.B * best.gain)).norm(), 1e-12);
  EXPECT_LT((best.model.C - (m.model.C - m.model.D * best.gain)).norm(), 1e-12);
  EXPECT_LT((best.model.B - m.model.B * best.input_gain).norm(), 1e-12);
  EXPECT_LT((best.model.D - m.model.D * best.input_gain).norm(), 1e-12);
}

TEST(Correction, ReportsAPoleThatNoInputReaches) {
  StateSpaceModel truth = lag(0.9, 2), model = lag(0.81, 2);
  const auto with_lone_mode = [](StateSpaceModel& m) {
    m.A = (Matrix(2, 2) << m.A(0, 0), 0, 0, 0.5).finished();
    m.B = (Matrix(2, 1) << m.B(0, 0), 0).finished();
    m.C = (Matrix(1, 2) << m.C(0, 0), 1).finished();
  };
  with_lone_mode(model);
  const Record record = record_of(truth, 2000);
  const CorrectionSearch search = search_correction(model, record, {0, 1000}, {1000, 2000});
  ASSERT_TRUE(search.best);
  ASSERT_EQ(search.best->uncontrollable.size(), 1U);
  EXPECT_NEAR(search.best->uncontrollable[0].real(), 0.5, 1e-12);
}

TEST(Correction, HasNothingToMoveWithoutStatesOrInputs) {
  StateSpaceModel still = lag(0.9, 2);
  still.A.resize(0, 0);
  still.B.resize(0, 1);
  still.C.resize(1, 0);
  still.D(0, 0) = 1;
  const Record record = record_of(lag(0.9, 2), 100);
  EXPECT_FALSE(search_correction(still, record, {0, 50}, {50, 100}).best);
}

}  // namespace
}  // namespace reident::identification::pole_placement_search_test
