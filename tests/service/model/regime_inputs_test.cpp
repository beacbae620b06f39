#include "service/model/regime_inputs.hpp"

#include <gmock/gmock.h>

namespace reident::regime_inputs_test {
namespace {

using identification::Vector;
using ::testing::ElementsAre;

TEST(RegimeInputs, AreAnOffsetAndEachInputWithinTheRegime) {
  std::vector<std::string> inputs{"U", "P"};
  std::vector<DerivedInput> derived{{"P", "U - 2", "W"}};
  add_regime_inputs({"ECL", "I < 0.1"}, inputs, derived);
  EXPECT_THAT(inputs, ElementsAre("U", "P", "in ECL", "U in ECL", "P in ECL", "in I < 0.1",
                                  "U in I < 0.1", "P in I < 0.1"));
  EXPECT_THAT(regime_places(inputs.size(), 6), ElementsAre(2, 5));
  EXPECT_THAT(regime_places(2, 0), ElementsAre());
  EXPECT_THAT(regime_places(0, 6), ElementsAre());
  EXPECT_TRUE(mistakes_in(derived, inputs, {"Y"}).empty());
  EXPECT_EQ(derived[3].unit, "W");
  InputExpressions expressions(inputs, derived);
  ASSERT_THAT(expressions.parameters(), ElementsAre("U", "ECL", "I"));
  Vector values(3), u(8);
  values << 5, 2, 0;
  expressions.evaluate(values, u);
  EXPECT_THAT(u, ElementsAre(5, 3, 1, 5, 3, 1, 5, 3));
  values << 5, 0, 1;
  expressions.evaluate(values, u);
  EXPECT_THAT(u, ElementsAre(5, 3, 0, 0, 0, 0, 0, 0));
}

TEST(RegimeInputs, OfNoExpressionAreAMistakeOfDerivedInputs) {
  std::vector<std::string> inputs{"U"};
  std::vector<DerivedInput> derived;
  add_regime_inputs({"ECL >"}, inputs, derived);
  EXPECT_FALSE(mistakes_in(derived, inputs, {"Y"}).empty());
}

}  // namespace
}  // namespace reident::regime_inputs_test
