#include "service/model/expression.hpp"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <limits>
#include <locale>

#include <gmock/gmock.h>

namespace reident::test::expression_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Expression parsed(const std::string& text) {
  auto result = Expression::parse(text);
  if (const auto* mistake = std::get_if<ExpressionMistake>(&result))
    throw std::runtime_error(text + ": " + mistake->message);
  return std::get<Expression>(std::move(result));
}

std::string mistake_in(const std::string& text) {
  const auto result = Expression::parse(text);
  const auto* mistake = std::get_if<ExpressionMistake>(&result);
  return mistake == nullptr ? "none" : mistake->message;
}

struct Value {
  const char* text;
  double expected;  // for a = 3, b = 2, c = 0 as far as they are used, in this order
};
void PrintTo(const Value& value, std::ostream* out) {
  *out << value.text;
}

class ExpressionValue : public testing::TestWithParam<Value> {};

TEST_P(ExpressionValue, FollowsTheRulesOfArithmetic) {
  Expression expression = parsed(GetParam().text);
  std::vector<double> values;
  for (const std::string& name : expression.variables())
    values.push_back(name == "a" ? 3 : name == "b" ? 2 : 0);
  const double value = expression.evaluate(values);
  if (std::isnan(GetParam().expected))
    EXPECT_TRUE(std::isnan(value)) << value;
  else
    EXPECT_EQ(value, GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    table, ExpressionValue,
    testing::Values(Value{"a + b * 2", 7}, Value{"(a + b) * 2", 10}, Value{"a - b - 1", 0},
                    Value{"a / b", 1.5}, Value{"a / b / 2", 0.75}, Value{"a ^ b ^ 2", 81},
                    Value{"-a^2", -9}, Value{"2^-a^2", 1. / 512}, Value{"a--b", 5},
                    Value{"a*-b", -6}, Value{"+a", 3}, Value{"abs(b - a)", 1},
                    Value{"min(a, b)", 2}, Value{"max (a , b)", 3}, Value{"min(max(a, 4), 5)", 4},
                    Value{"a < b", 0}, Value{"a <= 3", 1}, Value{"a > b", 1}, Value{"a >= 4", 0},
                    Value{"a == 3", 1}, Value{"a != 3", 0}, Value{"a<-b", 0}, Value{"a!=-b", 1},
                    Value{"a > b ? a : b", 3}, Value{"a < b ? 1 : a < 4 ? 2 : 3", 2},
                    Value{"(a > b) * 10 + 1e1", 20}, Value{"a > b ? (b > a ? 1 : 2) : 3", 2},
                    Value{"a / c", nan}, Value{"0 * (a / c)", nan}, Value{"c / c", nan},
                    Value{"c ^ -1", nan}, Value{"(b - a) ^ 0.5", nan}, Value{"min(c / c, 1)", nan},
                    Value{"max(1, c / c)", nan}, Value{"c > 0 ? a / c : 0", 0}, Value{"a^1e3", nan},
                    Value{"\t a\t", 3}));

TEST(Expression, NamesItsParametersOnceInTheOrderOfTheirUse) {
  EXPECT_THAT(parsed("V_BUS * I_1 + min(eps.u, V_BUS) - _x9").variables(),
              ElementsAre("V_BUS", "I_1", "eps.u", "_x9"));
  EXPECT_THAT(parsed("2 ^ 3").variables(), ElementsAre());
  EXPECT_THAT(parsed("absolute + maximum + min_x + e + pi").variables(),
              ElementsAre("absolute", "maximum", "min_x", "e", "pi"));
}

TEST(Expression, SaysOfWhatAChangeIsAMultiple) {
  for (const auto& [text, affine] : {std::pair("a", true),
                                     {"2 - a", true},
                                     {"-a * (b - 20) / c", true},
                                     {"a * b + a / 3", true},
                                     {"b ^ 2 * a", true},
                                     {"a ^ 1", false},
                                     {"a * a", false},
                                     {"a * (a + b)", false},
                                     {"b / a", false},
                                     {"max(a, 0)", false},
                                     {"a > 0 ? b : 1", false},
                                     {"max(b, 0) - a", true},
                                     {"a * max(b, a)", false}}) {
    const Expression expression = parsed(text);
    const auto place = std::ranges::find(expression.variables(), "a");
    EXPECT_EQ(expression.is_affine_in(std::size_t(place - expression.variables().begin())), affine)
        << text;
  }
}

TEST(Expression, HasNoValueWhereAParameterHasNoneEvenWhereItIsNotAskedFor) {
  Expression expression = parsed("a > 0 ? a : b");
  for (const double value : {nan, infinity, -infinity})
    EXPECT_TRUE(std::isnan(expression.evaluate(std::vector{1., value})));
  EXPECT_EQ(expression.evaluate(std::vector{1., 2.}), 1);
}

TEST(Expression, ReadsNumbersAlikeInEveryLocale) {
  const std::locale before;
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  std::locale::global(std::locale(before, new Comma));
  EXPECT_EQ(parsed("a + 1.5").evaluate(std::vector{1.}), 2.5);
  std::locale::global(before);
}

TEST(Expression, StaysWholeWhenItMoves) {
  Expression one = parsed("a - b");
  Expression other = parsed("c");
  other = std::move(one);
  EXPECT_EQ(other.evaluate(std::vector{5., 3.}), 2);
}

struct Mistake {
  std::string text;
  const char* says;
};
void PrintTo(const Mistake& mistake, std::ostream* out) {
  *out << mistake.text;
}

class ExpressionMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(ExpressionMistakes, AreToldWithTheirPlace) {
  EXPECT_THAT(mistake_in(GetParam().text), HasSubstr(GetParam().says));
}

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

INSTANTIATE_TEST_SUITE_P(
    table, ExpressionMistakes,
    testing::Values(
        Mistake{"",
                "at byte 1: a number, a parameter, (, abs, min or max is expected, not the end"},
        Mistake{"a +", "at byte 4: a number"}, Mistake{"a + * b", "at byte 5: a number"},
        Mistake{"a b", "at byte 3: an operator is expected, not \"b\"; allowed are + - * / ^ ( )"},
        Mistake{"(a", "at byte 3: ) is expected, not the end"},
        Mistake{"a)", "at byte 2: an operator is expected, not \")\""},
        Mistake{"a, b", "at byte 2: an operator"}, Mistake{"(a, b)", "at byte 3: ) is expected"},
        Mistake{"a = 1", "not \"=\""}, Mistake{"a && b", "not \"&\""}, Mistake{"!a", "not \"!\""},
        Mistake{"a % b", "not \"%\""}, Mistake{"\"a\"", "not \"\"\""}, Mistake{"a; b", "not \";\""},
        Mistake{"a < b < c", "at byte 7: an operator is expected, not \"<\""},
        Mistake{"a ? b", "at byte 6: : is expected, not the end"},
        Mistake{"a : b", "at byte 3: an operator is expected, not \":\""},
        Mistake{"--a", "at byte 2: a number"}, Mistake{"sin(a)", "at byte 1: sin is no function"},
        Mistake{"min(a)", "at byte 6: , is expected, not \")\""},
        Mistake{"max(a, b, c)", "at byte 9: ) is expected, not \",\""},
        Mistake{"abs()", "at byte 5: a number"},
        Mistake{"a * max", "at byte 5: max is a function and needs its values in ( )"},
        Mistake{"2a", "at byte 1: a number ends in a letter; write 2*a"},
        Mistake{"2.uin", "at byte 1: a number ends in a letter"},
        Mistake{"1e", "at byte 1: a number"}, Mistake{"0x10", "at byte 1: a number ends"},
        Mistake{".5", "at byte 1: a number, a param"},
        Mistake{"1e999", "at byte 1: 1e999 is too large or too small"},
        Mistake{"T_µ", "at byte 3: an operator is expected, not \"µ\""},
        Mistake{"a\nb", "at byte 2"}, Mistake{std::string("a\0b", 3), "not a zero byte"},
        Mistake{repeated("(", 33) + "a", "at byte 34: brackets, powers and conditions nest deeper"},
        Mistake{"a" + repeated("^a", 33), "nest deeper than 32"},
        Mistake{repeated("a?a:", 33) + "a", "nest deeper than 32"},
        Mistake{std::string(101, 'n'), "the name has 101 bytes; at most 100"},
        Mistake{repeated("a+", 500) + "a", "has 1001 bytes; at most 1000"}));

TEST(Expression, MayBeAsLongAndDeepAsIsSaid) {
  EXPECT_EQ(mistake_in(repeated("(", 32) + "a" + repeated(")", 32)), "none");
  EXPECT_EQ(mistake_in("a" + repeated("^a", 32)), "none");
  EXPECT_EQ(mistake_in(repeated("a?a:", 32) + "a"), "none");
  EXPECT_EQ(mistake_in(std::string(100, 'n')), "none");
  EXPECT_EQ(mistake_in(repeated("a+", 499) + "a "), "none");
}

}  // namespace
}  // namespace reident::test::expression_test
