#include "identification/samples/tick_ranges.hpp"

#include <gtest/gtest.h>

namespace reident::identification::tick_ranges_test {
namespace {

TEST(TickRanges, UniteToAscendingOnesThatAreApart) {
  EXPECT_EQ(united({{7, 9}, {1, 3}, {3, 4}, {2, 3}, {5, 5}}), (TickSet{{1, 4}, {7, 9}}));
  EXPECT_EQ(united({}), TickSet{});
}

TEST(TickRanges, AreCutAtTheEndsOfARange) {
  const TickSet set{{0, 10}, {20, 30}};
  EXPECT_EQ(inside(set, {5, 25}), (TickSet{{5, 10}, {20, 25}}));
  EXPECT_EQ(outside(set, {5, 25}), (TickSet{{0, 5}, {25, 30}}));
  EXPECT_EQ(size(set), 20);
}

TEST(TickRanges, DifferWhereATickIsInOneOfTwoSetsAlone) {
  EXPECT_EQ(differing({{0, 10}}, {{4, 6}}), (TickSet{{0, 4}, {6, 10}}));
  EXPECT_EQ(differing({{0, 10}}, {{0, 10}}), TickSet{});
  EXPECT_EQ(differing({{0, 10}}, {{10, 12}}), (TickSet{{0, 12}}));
  EXPECT_EQ(differing({}, {{1, 2}, {4, 5}}), (TickSet{{1, 2}, {4, 5}}));
}

TEST(TickRanges, LeaveOutRowsAsMissingSamplesDo) {
  Record record = contiguous_record(1, Vector::LinSpaced(10, 0, 9), Vector::LinSpaced(10, 0, 9));
  record.segments = {{0, 6, 100}, {6, 10, 200}};
  const Record rest = without(record, {{98, 101}, {103, 104}, {150, 201}, {203, 400}});
  EXPECT_EQ(rest.u.col(0), (Vector(6) << 1, 2, 4, 5, 7, 8).finished());
  EXPECT_EQ(rest.u, rest.y);
  EXPECT_EQ(rest.segments, (std::vector<Segment>{{0, 2, 101}, {2, 4, 104}, {4, 6, 201}}));
  EXPECT_EQ(without(record, {}).segments, record.segments);
  EXPECT_EQ(without(record, {{0, 1000}}).rows(), 0);
}

}  // namespace
}  // namespace reident::identification::tick_ranges_test
