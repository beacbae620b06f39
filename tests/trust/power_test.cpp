#include "tests/trust/power.hpp"

#include <gmock/gmock.h>

namespace reident::trust::power_test {
namespace {

// `tests/trust/run.sh --power --ratio 1 --sequences 10000` looks at more of them.
TEST(Power, EqualVersionsRarelyReplaceEachOtherWhateverTheirErrors) {
  for (const PowerPoint& point : power_curves(7, 12, {1.0}))
    EXPECT_LE(point.changed(), 2) << name(point.kind);
}

TEST(Power, AVersionWithAQuarterOfTheErrorIsToldWithinAFewCycles) {
  for (const PowerPoint& point : power_curves(8, 4, {0.25})) {
    EXPECT_EQ(point.changed(), 4) << name(point.kind);
    EXPECT_LT(*point.median(), 10) << name(point.kind);
  }
}

}  // namespace
}  // namespace reident::trust::power_test
