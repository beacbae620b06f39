#include <gtest/gtest.h>

#include "identification/fit/adaptation.hpp"
#include "identification/search/identify.hpp"
#include "identification/simulation/scores.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::regimes_test {
namespace {

constexpr Index rows = 900;

/// What the plant does within the regime: its offset, and its gain besides that of elsewhere.
struct Within {
  double offset = 0, gain = 0;
};

/// A plant of first order with the inputs u, 1 within the regime, and u within it. The regime comes
/// every 150 rows for 60.
Record telemetry(std::uint64_t seed, const Within& within) {
  test::Noise noise(seed);
  StateSpaceModel plant = test::random_system(noise, 1, 3, 1);
  plant.A(0, 0) = 0.9;
  plant.B << 0.1, 0.1 * within.offset, 0.1 * within.gain;
  plant.C(0, 0) = 1;
  plant.D.setZero();
  Matrix u(rows, 3);
  for (Index k = 0; k < rows; ++k) {
    u(k, 0) = k % 17 == 0 || k == 0 ? noise.normal(1, 1)(0, 0) : u(k - 1, 0);
    u(k, 1) = k % 150 < 60 ? 1 : 0;
    u(k, 2) = u(k, 0) * u(k, 1);
  }
  Matrix y = test::simulated(plant, u, Vector::Zero(1));
  y += 0.01 * noise.normal(rows, 1);
  return contiguous_record(1, u, y);
}

Identified identified(const Record& record, RowRange from) {
  IdentifyOptions options;
  options.regime_inputs = 2;
  options.max_order = 4;
  return std::get<Identified>(identify(record, from, options));
}

TEST(Regimes, HaveAnEffectWhereTheEquipmentSwitches) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Record record = telemetry(seed, {1.5, -0.6});
    const Identified found = identified(record, {0, 600});
    ASSERT_TRUE(found.regimes);
    EXPECT_TRUE(found.regimes->are_used);
    EXPECT_LT(*found.regimes->error_with, *found.regimes->error_without);
    const Matrix gain = static_gain(found.model).value();
    EXPECT_NEAR(gain(0, 1), 1.5, 0.05);
    EXPECT_NEAR(gain(0, 2), -0.6, 0.05);
    const Score score = score_free_run(found.model, record, {0, rows}, {600, rows}, found.x0);
    EXPECT_GT(score.fit(), 95);
  }
}

TEST(Regimes, HaveNoneInEquipmentThatDoesNotSwitch) {
  int unused = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Record record = telemetry(seed, {});
    const Identified found = identified(record, {0, 600});
    if (found.regimes->are_used) continue;
    ++unused;
    EXPECT_EQ(found.model.inputs(), 3);
    EXPECT_TRUE(found.model.B.rightCols(2).isZero());
    EXPECT_TRUE(found.model.D.rightCols(2).isZero());
    // Nor does an adaptation to the same rows give them one.
    const StateSpaceModel again = adapted(found.model, record, {0, 600}, KnownFrom::these_rows);
    EXPECT_TRUE(again.B.rightCols(2).isZero());
    EXPECT_TRUE(again.D.rightCols(2).isZero());
  }
  EXPECT_GE(unused, 9);
}

TEST(Regimes, ThatTheRowsDoNotMeetHaveNone) {
  const Record record = telemetry(1, {1.5, -0.6});
  const Identified found = identified(record, {60, 150});
  EXPECT_FALSE(found.regimes->are_used);
  EXPECT_FALSE(found.regimes->error_with);
  EXPECT_TRUE(found.model.B.rightCols(2).isZero());
}

TEST(Regimes, InWhichAnInputStandsStillKeepTheirOffset) {
  Record record = telemetry(3, {1.5, 0});
  record.u.col(2).setZero();  // u is 0 within the regime, as a solar array's current in eclipse
  for (Index k = 0; k < rows; ++k)
    if (record.u(k, 1) > 0) record.u(k, 0) = 0;
  const Record other = telemetry(3, {1.5, 0});
  StateSpaceModel plant = identified(other, {0, 600}).model;
  record.y = test::simulated(plant, record.u, Vector::Zero(plant.order()));
  const Identified found = identified(record, {0, 600});
  EXPECT_TRUE(found.regimes->are_used);
  EXPECT_NEAR(static_gain(found.model).value()(0, 1), static_gain(plant).value()(0, 1), 0.05);
}

}  // namespace
}  // namespace reident::identification::regimes_test
