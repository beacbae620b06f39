#include "identification/statistics/operating_regimes.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace reident::test::operating_regimes_test {
namespace {

using identification::InputRanges;
using identification::OperatingRegimes;

constexpr std::size_t cycle = 4;

TEST(OperatingRegimes, AreTheRangesOfWholeCycles) {
  OperatingRegimes regimes(cycle);
  for (int block = 0; block < 24; ++block) {
    const double far = block >= 8 && block < 16 ? 5 : 1;
    const bool grown = regimes.add({{-far}, {far}});
    EXPECT_EQ(grown, block == 0 || block == 8) << "what is near depends on the whole range";
  }
  // Three blocks behind it are of a cycle with the far range.
  std::vector<int> expected(24, 0);
  std::fill(expected.begin() + 8, expected.begin() + 19, 1);
  EXPECT_EQ(regimes.numbers(), expected);
}

TEST(OperatingRegimes, AFragmentAtTheBeginningIsNone) {
  // A pass in one block of four: the record begins behind it.
  OperatingRegimes regimes(cycle);
  for (int block = 1; block < 13; ++block) regimes.add({{0}, {block % 4 == 0 ? 1. : 0.1}});
  EXPECT_EQ(regimes.numbers(), std::vector(12, 0));
}

TEST(OperatingRegimes, ABlockThatDoesNotCountIsOfNone) {
  OperatingRegimes regimes(cycle);
  regimes.add({{0}, {1}});
  EXPECT_FALSE(regimes.add({}));
  regimes.add({{0}, {1}});
  EXPECT_EQ(regimes.numbers(), (std::vector{0, -1, 0}));
}

TEST(InputRanges, OfSomeInputsAreTheirs) {
  const InputRanges ranges{{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(ranges.of({2, 0}).low, (std::vector<double>{3, 1}));
  EXPECT_EQ(ranges.of({2, 0}).high, (std::vector<double>{6, 4}));
  EXPECT_TRUE(ranges.of({}).low.empty());
  EXPECT_TRUE(InputRanges().of({1}).low.empty()) << "of a block that does not count";
}

TEST(OperatingRegimes, ChangeTheirNumbersWhereTheWholeRangeGrows) {
  // 0 to 1 and 0 to 2 differ, until the input has gone to 100.
  OperatingRegimes regimes(1);
  regimes.add({{0}, {1}});
  regimes.add({{0}, {2}});
  EXPECT_EQ(regimes.numbers(), (std::vector{0, 1}));
  EXPECT_TRUE(regimes.add({{0}, {100}}));
  EXPECT_EQ(regimes.numbers(), (std::vector{0, 0, 1}));
}

}  // namespace
}  // namespace reident::test::operating_regimes_test
