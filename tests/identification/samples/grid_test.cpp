#include "identification/samples/grid.hpp"

#include <limits>

#include <gmock/gmock.h>

namespace reident::identification::grid_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Samples of one channel with times in tenths of a second.
struct Channel {
  std::vector<std::int64_t> time_ns;
  std::vector<double> value;
  std::vector<std::uint8_t> usable;

  Channel(std::vector<std::int64_t> tenths, std::vector<double> values,
          std::vector<std::uint8_t> flags = {})
      : time_ns(std::move(tenths)), value(std::move(values)), usable(std::move(flags)) {
    for (std::int64_t& t : time_ns) t *= 100'000'000;
    if (usable.empty()) usable.assign(value.size(), 1);
  }
  operator ChannelSamples() const { return {time_ns, value, usable}; }
};

constexpr std::int64_t second = 1'000'000'000;

Record grid_of(const std::vector<ChannelSamples>& outputs, std::int64_t begin_s, std::int64_t end_s,
               std::int64_t hold_s = 1) {
  return make_record({}, outputs, begin_s * second, end_s * second, {second, hold_s * second});
}

std::vector<double> column(const Matrix& values, Index c = 0) {
  return {values.col(c).begin(), values.col(c).end()};
}

TEST(Grid, TakesTheLatestSampleAtOrBeforeATick) {
  const Channel y({0, 7, 10, 19, 28}, {1, 2, 3, 4, 5});
  const Record record = grid_of({y}, 0, 4);
  EXPECT_THAT(column(record.y), ElementsAre(1, 3, 4, 5));
  EXPECT_THAT(record.segments, ElementsAre(Segment{0, 4, 0}));
  EXPECT_DOUBLE_EQ(record.period_s, 1);
}

TEST(Grid, SplitsWhereTheHoldHasRunOut) {
  const Channel y({0, 10, 40, 50}, {1, 2, 3, 4});
  EXPECT_THAT(grid_of({y}, 0, 6).segments, ElementsAre(Segment{0, 2, 0}, Segment{2, 4, 4}));
  EXPECT_THAT(grid_of({y}, 0, 6, 3).segments, ElementsAre(Segment{0, 6, 0}));
}

TEST(Grid, HoldsForLessThanTheHoldTime) {
  const Channel y({0}, {1});
  EXPECT_EQ(grid_of({y}, 0, 9, 2).rows(), 2) << "serves [time, time + hold)";
}

TEST(Grid, AnUnusableSampleEndsTheHoldOfTheOneBefore) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Channel flagged({0, 5, 20}, {1, 2, 3}, {1, 0, 1}), non_finite({0, 5, 20}, {1, nan, 3});
  for (const Channel& y : {flagged, non_finite})
    EXPECT_THAT(grid_of({y}, 0, 4, 5).segments, ElementsAre(Segment{0, 1, 0}, Segment{1, 3, 2}));
}

TEST(Grid, OfTwoSamplesAtOneTimeTheLaterCounts) {
  EXPECT_THAT(column(grid_of({Channel({0, 0}, {1, 2})}, 0, 1).y), ElementsAre(2));
}

TEST(Grid, NeedsEveryChannel) {
  const Channel a({0, 10, 20, 30}, {1, 2, 3, 4}), b({10, 20}, {5, 6});
  const Record record = make_record(std::vector<ChannelSamples>{a}, std::vector<ChannelSamples>{b},
                                    0, 4 * second, {second, second});
  EXPECT_THAT(record.segments, ElementsAre(Segment{0, 2, 1}));
  EXPECT_THAT(column(record.u), ElementsAre(2, 3));
  EXPECT_THAT(column(record.y), ElementsAre(5, 6));
}

TEST(Grid, SamplesBeforeTheBeginServeTheFirstTicks) {
  EXPECT_THAT(column(grid_of({Channel({-4}, {7})}, 0, 3, 2).y), ElementsAre(7, 7));
}

TEST(Grid, TicksStandAtMultiplesOfThePeriodBeforeTheEpochToo) {
  const Channel y({-35, -25, -15, -5, 5}, {1, 2, 3, 4, 5});
  const Record record =
      make_record({}, std::vector<ChannelSamples>{y}, -3'400'000'000, second, {second, second});
  EXPECT_THAT(record.segments, ElementsAre(Segment{0, 4, -3}));
  EXPECT_THAT(column(record.y), ElementsAre(1, 2, 3, 4));
}

TEST(Grid, WindowsThatOverlapShareTheirRows) {
  const Channel y({1, 11, 21, 31, 41, 51}, {1, 2, 3, 4, 5, 6});
  const Record early = grid_of({y}, 0, 4), late = grid_of({y}, 2, 6);
  EXPECT_EQ(early.y(first_row_at(early, 3)), late.y(first_row_at(late, 3)));
}

TEST(Grid, AnEmptyWindowOrSilentChannelGivesNoRows) {
  const Channel y({0, 10}, {1, 2});
  EXPECT_EQ(grid_of({y}, 3, 3).rows(), 0);
  EXPECT_EQ(grid_of({y}, 3, 1).rows(), 0);
  EXPECT_EQ(grid_of({y, Channel({}, {})}, 0, 2).rows(), 0);
  EXPECT_THAT(grid_of({Channel({0, 10}, {1, 2}, {0, 0})}, 0, 9).segments, IsEmpty());
}

TEST(Grid, CostsNothingForAGapOfCenturies) {
  constexpr std::int64_t end = std::numeric_limits<std::int64_t>::max();
  const Channel sparse({0, 10}, {1, 2});
  Channel far({0}, {1});
  far.time_ns[0] = end - 10;
  const Record record = make_record({}, std::vector<ChannelSamples>{far},
                                    std::numeric_limits<std::int64_t>::min() / 2, end, {1, 3});
  EXPECT_THAT(record.segments, ElementsAre(Segment{0, 3, end - 10}));
}

}  // namespace
}  // namespace reident::identification::grid_test
