#include "identification/adaptation.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "identification/simulate.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification {
namespace {

double output_error(const StateSpaceModel& model, const Record& record) {
  return (record.y - free_run(model, record, record.all())).norm() /
         std::sqrt(double(record.rows()));
}

TEST(Adaptation, FindsGainsAndOffsetThatMovedAndKeepsThePoles) {
  testing::Noise noise(1);
  const StateSpaceModel known = testing::random_system(noise, 4, 2, 2);
  StateSpaceModel truth = known;
  truth.B *= 1.4;
  truth.D.col(1) *= 0.5;
  truth.y0 << 3, -1;
  const Record record = testing::with_gap(testing::excited(truth, noise, 900, 0), 300, 320);
  const StateSpaceModel found = adapted(known, record, record.all());
  EXPECT_EQ(found.A, known.A);
  EXPECT_EQ(found.C, known.C);
  EXPECT_LT((found.B - truth.B).norm(), 1e-6);
  EXPECT_LT((found.D - truth.D).norm(), 1e-6);
  EXPECT_LT((found.y0 - truth.y0).norm(), 1e-6);
}

TEST(Adaptation, OfAModelThatFitsChangesNothing) {
  testing::Noise noise(2);
  const StateSpaceModel known = testing::random_system(noise, 3, 2, 1);
  const Record record = testing::excited(known, noise, 600, 0);
  const StateSpaceModel found = adapted(known, record, record.all());
  EXPECT_LT((found.B - known.B).norm() + (found.D - known.D).norm(), 1e-8);
  EXPECT_LT((found.y0 - known.y0).norm(), 1e-8);
}

TEST(Adaptation, LeavesTheGainOfAnInputThatDoesNotMove) {
  testing::Noise noise(3);
  StateSpaceModel known = testing::random_system(noise, 3, 2, 1);
  known.u0 << 0.5, -2;
  StateSpaceModel truth = known;
  truth.B.col(0) *= 1.5;
  truth.y0 << 0.3;
  Record record = testing::excited(known, noise, 600, 0);
  record.u.col(1).setConstant(0.1);
  record.y = testing::simulated(truth, record.u, Vector::Zero(3));
  const StateSpaceModel found = adapted(known, record, record.all());
  EXPECT_EQ(found.B.col(1), known.B.col(1));
  EXPECT_EQ(found.D.col(1), known.D.col(1));
  EXPECT_LT((found.B.col(0) - truth.B.col(0)).norm(), 1e-6);
  EXPECT_LT((found.y0 - truth.y0).norm(), 1e-6);
  EXPECT_LT(output_error(found, record), 1e-6);
}

TEST(Adaptation, OfInputsThatDoNotMoveFindsTheOffset) {
  testing::Noise noise(5);
  const StateSpaceModel known = testing::random_system(noise, 3, 2, 1);
  Record record = testing::excited(known, noise, 600, 0);
  record.u.setConstant(0.1);
  record.y = testing::simulated(known, record.u, Vector::Ones(3)).array() + 2;
  const StateSpaceModel found = adapted(known, record, record.all());
  EXPECT_EQ(found.B, known.B);
  EXPECT_NEAR(found.y0(0), known.y0(0) + 2, 1e-6);
}

TEST(Adaptation, LooksAtTheRowsThatItIsGivenAlone) {
  testing::Noise noise(4);
  const StateSpaceModel known = testing::random_system(noise, 3, 2, 1);
  StateSpaceModel truth = known;
  truth.B *= 0.7;
  const Record record = testing::excited(truth, noise, 800, 0);
  Record spoilt = record;
  spoilt.y.bottomRows(300).array() += 5;
  const RowRange rows{0, 500};
  EXPECT_EQ(adapted(known, record, rows).B, adapted(known, spoilt, rows).B);
  EXPECT_LT((adapted(known, record, rows).B - truth.B).norm(), 1e-6);
}

}  // namespace
}  // namespace reident::identification
