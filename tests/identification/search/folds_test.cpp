#include "identification/search/folds.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::folds_test {
namespace {

TEST(HeldOut, TheFoldsHoldOutTwoFifthsOfEachEndInTwoParts) {
  const std::vector<Fold> folds = folds_of(100, 0.4);
  ASSERT_EQ(folds.size(), 4u);
  const auto expect = [](const Fold& fold, RowRange fit, RowRange tune) {
    EXPECT_EQ(fold.fit, fit);
    EXPECT_EQ(fold.tune, tune);
  };
  expect(folds[0], {0, 80}, {80, 100});
  expect(folds[1], {20, 100}, {0, 20});
  expect(folds[2], {0, 60}, {60, 80});
  expect(folds[3], {40, 100}, {20, 40});
}

TEST(HeldOut, AFoldIsCutWhereItsPartsMeet) {
  const Fold forwards{{0, 60}, {60, 80}}, backwards{{40, 100}, {20, 40}};
  EXPECT_EQ(forwards.with_fit_of(10).fit, (RowRange{50, 60}));
  EXPECT_EQ(forwards.with_tune_of(5).tune, (RowRange{60, 65}));
  EXPECT_EQ(backwards.with_fit_of(10).fit, (RowRange{40, 50}));
  EXPECT_EQ(backwards.with_tune_of(5).tune, (RowRange{35, 40}));
  EXPECT_EQ(forwards.with_fit_of(1000).fit, forwards.fit);
}

TEST(HeldOut, TheErrorOfTheTruthIsTheNoise) {
  test::Noise noise(1);
  const StateSpaceModel truth = test::random_system(noise, 2, 1, 1, 0.8);
  Record record = test::excited(truth, noise, 6000, 0);
  record.y += 0.1 * noise.normal(6000, 1);
  for (const Fold& fold : folds_of(6000, 0.4)) {
    const HeldOutErrors errors = held_out_errors({truth, Vector::Zero(2), 0}, record, fold);
    EXPECT_NEAR(errors.whole.rms, 0.1, 0.01);
    EXPECT_NEAR(quick_held_out_errors(truth, record, fold).whole.rms, 0.1, 0.01);
  }
}

TEST(HeldOut, TheRecentOperatingPointFollowsAZeroThatMoved) {
  test::Noise noise(2);
  const StateSpaceModel truth = test::random_system(noise, 2, 1, 1, 0.8);
  Record record = test::excited(truth, noise, 1000, 0);
  record.y.bottomRows(700).array() += 2;
  const Fold fold{{0, 800}, {800, 1000}};
  const HeldOutErrors errors = held_out_errors({truth, Vector::Zero(2), 0}, record, fold);
  EXPECT_NEAR(errors.whole.rms, 2, 0.05);
  EXPECT_LT(errors.recent.rms, 0.05);
}

TEST(HeldOut, AModelThatLeavesTheNumbersHasAnInfiniteError) {
  test::Noise noise(3);
  StateSpaceModel model = test::random_system(noise, 1, 1, 1);
  const Record record = test::excited(model, noise, 2000, 0);
  model.A(0, 0) = 4;
  EXPECT_TRUE(
      std::isinf(quick_held_out_errors(model, record, {{0, 1000}, {1000, 2000}}).whole.rms));
}

}  // namespace
}  // namespace reident::identification::folds_test
