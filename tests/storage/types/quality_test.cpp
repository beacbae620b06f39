// The table of qualities. That codecs, SQL, import and the others go by it is tested with each of
// them, in a loop over the table.
#include "storage/types/quality.hpp"

#include <algorithm>

#include <gmock/gmock.h>

namespace reident::storage::test::quality_test {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

// Archives and gateways hold these numbers for as long as a mission flies.
TEST(Qualities, KeepTheirNumbersForEver) {
  EXPECT_EQ(wire_value(Quality::good), 0);
  EXPECT_EQ(wire_value(Quality::out_of_limits), 1);
  EXPECT_EQ(wire_value(Quality::suspect), 2);
  EXPECT_EQ(wire_value(Quality::invalid), 3);
  EXPECT_EQ(wire_value(Quality::disputed), 4);
}

TEST(Qualities, AreFoundByTheirNumberAndTheirName) {
  for (const QualityFacts& row : quality_table) {
    EXPECT_EQ(quality_of_wire(row.wire), row.quality);
    EXPECT_EQ(wire_value(row.quality), row.wire);
    EXPECT_EQ(quality_named(row.name), row.quality);
    EXPECT_EQ(name(row.quality), row.name);
  }
}

TEST(Qualities, ThatNobodyKnowsAreNotFoundAndCountAsInvalid) {
  const auto end = static_cast<std::int64_t>(quality_table.size());
  for (const std::int64_t number : {std::int64_t{-1}, end, std::int64_t{255}, std::int64_t{256}})
    EXPECT_EQ(quality_of_wire(number), std::nullopt) << number;
  for (const char* text : {"", "fine", "Good", "out_of_limits", "good "})
    EXPECT_EQ(quality_named(text), std::nullopt) << text;
  EXPECT_EQ(facts(static_cast<Quality>(end)).quality, Quality::invalid);
  EXPECT_FALSE(is_usable(static_cast<Quality>(255)));
}

TEST(Qualities, GoodIsTheBestAndOneIsBetterThanAnother) {
  for (const Quality one : qualities) {
    EXPECT_EQ(is_better(Quality::good, one), one != Quality::good);
    for (const Quality other : qualities)
      EXPECT_EQ(is_better(one, other) + is_better(other, one), one != other);
  }
}

TEST(Qualities, AreListedInMessages) {
  const std::string names = quality_names("'"), last(quality_table.back().name);
  EXPECT_THAT(names, StartsWith("'good', 'out of limits', 'suspect', 'invalid'"));
  EXPECT_THAT(names, EndsWith(" or '" + last + "'"));
  EXPECT_EQ(std::count(names.begin(), names.end(), '\''), 2 * std::ssize(quality_table));
  EXPECT_THAT(quality_names(), StartsWith("good, out of limits, suspect, invalid"));
}

}  // namespace
}  // namespace reident::storage::test::quality_test
