#include "identification/screening/sample_hold.hpp"

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::sample_hold_test {
namespace {

Record held(Index rows_per_value, Index first) {
  test::Noise noise(1);
  const Matrix values = noise.normal(200, 2);
  Matrix channels(180 * rows_per_value, 2);
  for (Index row = 0; row < channels.rows(); ++row)
    channels.row(row) = values.row((row + first) / rows_per_value);
  return contiguous_record(1, channels.leftCols(1), channels.rightCols(1));
}

TEST(SampleHold, IsTheNumberOfRowsThatEachValueStandsFor) {
  for (const Index rows : {2, 3, 4, 10})
    for (const Index first : {0, 1}) EXPECT_EQ(rows_per_sample(held(rows, first)), rows);
}

TEST(SampleHold, IsThatOfChannelsThatChangeBehindEachOther) {
  Record later = held(3, 0);
  later.u = held(3, 1).u;
  EXPECT_EQ(rows_per_sample(later), 3);
  later.y.setConstant(1);
  EXPECT_EQ(rows_per_sample(later), 3);
}

TEST(SampleHold, IsOneOfSamplesThatChangeByThemselves) {
  EXPECT_EQ(rows_per_sample(held(1, 0)), 1);
  Record mixed = held(4, 0);
  const Record other = held(3, 0);
  mixed.u = other.u.topRows(540);
  mixed.y = mixed.y.topRows(540).eval();
  mixed.segments = {{0, 540, 0}};
  EXPECT_EQ(rows_per_sample(mixed), 1);
}

TEST(SampleHold, IsOneOfLevelsThatAreHeldForLong) {
  Matrix u(1000, 1), y(1000, 1);
  for (Index row = 0; row < 1000; ++row) u(row) = y(row) = double(row / 250 % 2);
  EXPECT_EQ(rows_per_sample(contiguous_record(1, u, y)), 1);
}

}  // namespace
}  // namespace reident::identification::sample_hold_test
