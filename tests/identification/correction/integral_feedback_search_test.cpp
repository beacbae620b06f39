#include "identification/correction/integral_feedback_search.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "identification/correction/pole_placement_search.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::integral_feedback_search_test {
namespace {

using ::testing::HasSubstr;

/// A system whose outputs drift as no input explains.
Record drifting(const StateSpaceModel& truth, std::uint64_t seed, Index rows) {
  test::Noise noise(seed);
  Record record = test::excited(truth, noise, rows, 0.01);
  Matrix drift = 0.05 * noise.normal(rows, truth.outputs());
  for (Index k = 1; k < rows; ++k) drift.row(k) += 0.995 * drift.row(k - 1);
  record.y += drift;
  record.y.array() += 10;
  return record;
}

TEST(TrackingPlacement, PutsThePolesOfTheLoopWhereTheyAreWanted) {
  test::Noise noise(1);
  for (Index p = 1; p <= 3; ++p)
    for (int trial = 0; trial < 10; ++trial) {
      const StateSpaceModel model = test::random_system(noise, 5, 3, p);
      Poles wanted = scaled_poles(poles_of(model.A), 1.5);
      for (Index i = 0; i < 2 * p; ++i) wanted.push_back(0.3 + 0.1 * double(i));
      const Vector units = Vector::Constant(p, trial % 2 == 0 ? 1e-6 : 1e6);
      const auto placed = place_tracking_poles(model, wanted, units);
      ASSERT_TRUE(std::holds_alternative<TrackingPlacement>(placed));
      const auto& placement = std::get<TrackingPlacement>(placed);
      EXPECT_TRUE(placement.uncontrollable.empty());
      for (const auto& pole : poles_of(closed_loop(model, placement.gain))) {
        double nearest = 1;
        for (const auto& other : wanted) nearest = std::min(nearest, std::abs(pole - other));
        EXPECT_LT(nearest, 1e-4);
      }
    }
}

TEST(TrackingSearch, FollowsADriftThatNoInputTells) {
  test::Noise noise(2);
  for (Index p = 1; p <= 2; ++p) {
    const StateSpaceModel truth = test::random_system(noise, 3, 2, p, 0.9);
    StateSpaceModel model = truth;
    model.y0.setConstant(10);
    const Record record = drifting(truth, 5, 3000);
    const auto found = search_tracking(model, record, {0, 1500}, {1500, 3000});
    ASSERT_TRUE(std::holds_alternative<TrackingSearch>(found));
    const auto& search = std::get<TrackingSearch>(found);
    EXPECT_LT(search.tracking.mrse(), 0.5 * search.free_run.mrse());
    const Score again =
        score(record.y.bottomRows(1500), tracked_run(model, search.gain, record, {1500, 3000}));
    EXPECT_EQ(search.tracking.mrse(), again.mrse());
    const auto seen = record.y.topRows(1500).colwise();
    EXPECT_EQ(search.gain.error_limit, (seen.maxCoeff() - seen.minCoeff()).transpose());
    EXPECT_TRUE(is_stabilising(model, search.gain));
  }
}

TEST(TrackingSearch, IsNotMisledByRowsAtRest) {
  test::Noise noise(8);
  StateSpaceModel model = test::random_system(noise, 3, 2, 1, 0.9);
  model.y0.setConstant(10);
  Record record = drifting(model, 5, 6000);
  const auto lively =
      std::get<TrackingSearch>(search_tracking(model, record, {0, 2000}, {3000, 6000}));
  record.u.middleRows(2000, 1000).setZero();
  record.y.middleRows(2000, 1000).setConstant(10);
  const auto rested =
      std::get<TrackingSearch>(search_tracking(model, record, {0, 2000}, {2000, 6000}));
  const auto error = [&](const TrackingGain& gain) {
    return score(record.y.bottomRows(3000), tracked_run(model, gain, record, {3000, 6000})).mrse();
  };
  EXPECT_LT(error(rested.gain), 1.05 * error(lively.gain));
}

std::string refusal(const StateSpaceModel& model, const Record& record) {
  const auto found = search_tracking(model, record, {0, 500}, {500, 1000});
  const auto* verdict = std::get_if<Verdict>(&found);
  if (!verdict) return "found";
  EXPECT_EQ(verdict->code, VerdictCode::no_gain);
  return verdict->reason;
}

TEST(NoTracking, WithFewerInputsThanOutputs) {
  test::Noise noise(3);
  const StateSpaceModel model = test::random_system(noise, 3, 1, 2);
  EXPECT_THAT(refusal(model, drifting(model, 1, 1000)), HasSubstr("2 outputs and 1 inputs"));
}

TEST(NoTracking, WhereConstantInputsLeaveTheOutput) {
  test::Noise noise(4);
  StateSpaceModel model = test::random_system(noise, 3, 1, 1);
  model.D.setZero();
  model.D = -*static_gain(model);
  EXPECT_THAT(refusal(model, drifting(model, 1, 1000)),
              HasSubstr("output 1 where it is (a zero at z = 1)"));
}

TEST(NoTracking, WhereConstantInputsMoveTheOutputsTogether) {
  test::Noise noise(5);
  StateSpaceModel model = test::random_system(noise, 3, 2, 2);
  model.C.row(1) = 2 * model.C.row(0);
  model.D.row(1) = 2 * model.D.row(0);
  EXPECT_THAT(refusal(model, drifting(model, 1, 1000)), HasSubstr("together"));
}

TEST(NoTracking, OfAnOutputThatDoesNotMove) {
  test::Noise noise(6);
  const StateSpaceModel model = test::random_system(noise, 3, 1, 1);
  Record record = drifting(model, 1, 1000);
  record.y.setConstant(28);
  EXPECT_THAT(refusal(model, record), HasSubstr("did not move"));
}

TEST(NoTracking, WhereTheFreeRunIsRightAlready) {
  test::Noise noise(7);
  const StateSpaceModel model = test::random_system(noise, 3, 1, 1);
  const Record record = test::excited(model, noise, 1000, 0.3);
  EXPECT_THAT(refusal(model, record), HasSubstr("closer than the free run"));
}

}  // namespace
}  // namespace reident::identification::integral_feedback_search_test
