#include "identification/samples/record.hpp"

#include <gmock/gmock.h>

#include "tests/support/systems.hpp"

namespace reident::identification::record_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Record two_segments() {
  return test::with_gap(contiguous_record(1, Matrix::Random(10, 1), Matrix::Random(10, 1)), 4, 7);
}

TEST(Record, WithoutRowsHasNoSegment) {
  EXPECT_THAT(contiguous_record(1, Matrix(0, 1), Matrix(0, 1)).segments, IsEmpty());
}

TEST(Record, PartsOfSegmentsKeepTheirTicks) {
  EXPECT_THAT(segments_within(two_segments(), {2, 6}),
              ElementsAre(Segment{2, 4, 2}, Segment{4, 6, 7}));
  EXPECT_THAT(segments_within(two_segments(), {5, 6}), ElementsAre(Segment{5, 6, 8}));
  EXPECT_THAT(segments_within(two_segments(), {4, 4}), IsEmpty());
}

TEST(Record, RangesOfPartsCountFromTheFirstOfTheirRows) {
  EXPECT_THAT(ranges_from(two_segments(), {2, 6}), ElementsAre(RowRange{0, 2}, RowRange{2, 4}));
  EXPECT_THAT(ranges_from(two_segments(), {4, 4}), IsEmpty());
}

TEST(Record, KnowsTheTickOfEachRowAndOfTheOneBehindTheLast) {
  const std::int64_t ticks[] = {0, 1, 2, 3, 7, 8, 9, 10};
  for (Index row = 0; row <= 7; ++row) EXPECT_EQ(tick_of_row(two_segments(), row), ticks[row]);
}

TEST(Record, ResolutionIsTheLeastDifferenceOfTwoValues) {
  EXPECT_EQ(resolution(Vector{{3, 1, 1.25, 3, 2}}), 0.25);
  EXPECT_EQ(resolution(Vector{{3, 3}}), 0);
}

TEST(Record, FindsTheFirstRowAtATick) {
  struct {
    std::int64_t tick;
    Index row;
  } const cases[] = {{-5, 0}, {0, 0}, {3, 3}, {4, 4}, {6, 4}, {7, 4}, {8, 5}, {9, 6}, {10, 7}};
  for (const auto& c : cases) EXPECT_EQ(first_row_at(two_segments(), c.tick), c.row) << c.tick;
}

}  // namespace
}  // namespace reident::identification::record_test
