#include "service/model/derived_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include <gmock/gmock.h>

namespace reident::test::derived_inputs_test {
namespace {

using identification::Matrix;
using identification::Record;
using identification::Vector;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

const std::vector<DerivedInput> power = {{"P", "u * i", "W"}};

TEST(InputExpressions, NeedEachParameterOnceInTheOrderOfItsUse) {
  const InputExpressions expressions({"i", "P", "v"}, {{"P", "u * i / v", "A"}});
  EXPECT_THAT(expressions.parameters(), ElementsAre("i", "u", "v"));
}

TEST(InputExpressions, WithoutDerivedInputsAreTheInputsThemselves) {
  InputExpressions expressions({"b", "a"}, {});
  EXPECT_THAT(expressions.parameters(), ElementsAre("b", "a"));
  Vector inputs(2);
  expressions.evaluate(Vector{{1, nan}}, inputs);
  EXPECT_EQ(inputs(0), 1);
  EXPECT_TRUE(std::isnan(inputs(1)));
}

TEST(InputExpressions, PutEachValueInThePlaceOfItsInput) {
  InputExpressions expressions({"i", "P", "Q"}, {{"Q", "u / i", ""}, {"P", "u * i", "W"}});
  Vector inputs(3);
  expressions.evaluate(Vector{{2, 10}}, inputs);
  EXPECT_EQ(inputs, (Vector{{2, 20, 5}}));
}

TEST(InputExpressions, RefuseWhatIsNoExpression) {
  try {
    InputExpressions({"P"}, {{"P", "u *", "W"}});
    FAIL() << "it was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("input P: at byte 4"));
  }
}

TEST(InputExpressions, SplitARecordWhereAnInputHasNoFiniteValue) {
  Record record;
  record.u = Matrix{{1, 1}, {2, 1}, {3, 0}, {4, 2}, {5, 2}, {6, 0}};
  record.y = Matrix{{10}, {20}, {30}, {40}, {50}, {60}};
  record.segments = {{0, 4, 7}, {4, 6, 20}};
  const Record result = InputExpressions({"q"}, {{"q", "u / v", ""}}).evaluate(record);
  EXPECT_EQ(result.u, (Matrix{{1}, {2}, {2}, {2.5}}));
  EXPECT_EQ(result.y, (Matrix{{10}, {20}, {40}, {50}}));
  EXPECT_EQ(result.segments,
            (std::vector<identification::Segment>{{0, 2, 7}, {2, 3, 10}, {3, 4, 20}}));
}

TEST(InputExpressions, LeaveARecordWithoutDerivedInputsAsItIs) {
  const Record record = identification::contiguous_record(2, Matrix{{1}, {2}}, Matrix{{3}, {4}});
  const Record result = InputExpressions({"u"}, {}).evaluate(record);
  EXPECT_EQ(result.u, record.u);
  EXPECT_EQ(result.segments, record.segments);
  EXPECT_EQ(result.period_s, 2);
}

TEST(InputExpressions, MayLeaveNoRow) {
  const Record record = identification::contiguous_record(1, Matrix{{0}, {0}}, Matrix{{3}, {4}});
  const Record result = InputExpressions({"q"}, {{"q", "1 / u", ""}}).evaluate(record);
  EXPECT_EQ(result.rows(), 0);
  EXPECT_EQ(result.u.cols(), 1);
  EXPECT_THAT(result.segments, IsEmpty());
}

struct Case {
  const char* name;
  std::vector<DerivedInput> derived;
  const char* key;
  const char* says;
};
void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

class DerivedInputMistakes : public testing::TestWithParam<Case> {};

TEST_P(DerivedInputMistakes, AreToldWithTheirRemedy) {
  const auto mistakes = mistakes_in(GetParam().derived, {"P", "v"}, {"y"});
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(mistakes[0].index, GetParam().derived.size() - 1);
  EXPECT_EQ(mistakes[0].key, GetParam().key);
  EXPECT_THAT(mistakes[0].message, HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    table, DerivedInputMistakes,
    testing::Values(
        Case{"syntax", {{"P", "u *", "W"}}, "expression", "at byte 4"},
        Case{"constant", {{"P", "2 ^ 3", "W"}}, "expression", "uses no parameter"},
        Case{"unused", {{"Q", "u", "W"}}, "name", "Q is not used; add it to the inputs"},
        Case{"output's name", {{"y", "u", "W"}}, "name", "y is the name of an output"},
        Case{"twice", {{"P", "u", "W"}, {"P", "i", "W"}}, "name", "derived input above"},
        Case{"output in it", {{"P", "u * y", "W"}}, "expression", "uses the output y; a model"},
        Case{"itself in it", {{"P", "P * 2", "W"}}, "expression", "uses its own name P"},
        Case{"derived in it",
             {{"P", "u", "W"}, {"v", "P * 2", ""}},
             "expression",
             "uses P, which is derived itself; write its expression in its place"}));

TEST(DerivedInputs, WithoutAMistakeHaveNone) {
  EXPECT_THAT(mistakes_in(power, {"P"}, {"y"}), IsEmpty());
  EXPECT_THAT(mistakes_in(power, {"P", "u", "i"}, {"y"}), IsEmpty());
}

TEST(DerivedInputs, ASensorInWhichAnInputIsNotAffineHasBiasesOfSeveralSizes) {
  const std::vector<SensorBias> biases =
      biases_of({"w", "q", "r", "u"}, {{"q", "u * v", ""}, {"r", "2 * u ^ 0.5", ""}});
  std::map<std::string, std::vector<int>> directions;
  for (const SensorBias& bias : biases) directions[bias.sensor].push_back(bias.direction);
  EXPECT_EQ(directions["v"], std::vector<int>{0});
  EXPECT_EQ(directions["w"], std::vector<int>{0});
  EXPECT_EQ(std::ranges::count(directions["u"], -1), bias_sizes);
  EXPECT_EQ(std::ranges::count(directions["u"], 1), bias_sizes);
  EXPECT_EQ(biases.front().sensor, "u");
  EXPECT_EQ(biases.back().sensor, "w");
}

TEST(DerivedInputs, ABiasKeepsItsSizeAsLongAsTheDeviationSuitsIt) {
  for (const double deviation : {0.9, 1.1, 1.9, 2.1, 1e-7, 3e5}) {
    std::set<double> sizes;
    for (int size = 0; size < bias_sizes; ++size)
      sizes.insert(-size_of({"u", -1, size}, deviation));
    EXPECT_EQ(sizes.size(), std::size_t{bias_sizes});
    EXPECT_LE(*sizes.rbegin(), deviation / 2);
    EXPECT_GT(*sizes.begin(), deviation / 65);
  }
  std::set<double> kept;
  for (int size = 0; size < bias_sizes; ++size)
    if (const double one = size_of({"u", 1, size}, 1.9); one == size_of({"u", 1, size}, 2.1))
      kept.insert(one);
  EXPECT_EQ(kept.size(), std::size_t{bias_sizes - 1});
  EXPECT_EQ(size_of({"u"}, 1.9), 1.9);
  EXPECT_EQ(size_of({"u"}, 0), 1);
}

}  // namespace
}  // namespace reident::test::derived_inputs_test
