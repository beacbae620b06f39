// An expression means what its tree means, to the last bit, however it is written.
#include <algorithm>
#include <bit>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "service/model/expression.hpp"
#include "tests/properties/any_record.hpp"

namespace reident::expression_property_test {
namespace {

using test::any_of;

const std::vector<std::string> names = {"a", "I_BUS", "eps.v2"};

/// A text and what it is worth; `rank` says how tightly its outermost operator binds.
struct Term {
  std::string text;
  double value = 0;
  enum Rank { conditional, comparison, sum, product, sign, power, whole } rank = whole;
};

std::string blank() {
  return std::string(any_of<std::size_t>(0, 2), ' ');
}

/// The term's text where at least `rank` is wanted: in brackets where they are needed, or by
/// chance.
std::string at_least(Term::Rank rank, const Term& term) {
  if (term.rank >= rank && any_of(0, 4) != 0) return term.text;
  return "(" + blank() + term.text + blank() + ")";
}

Term binary(const Term& a, const std::string& sign, const Term& b, double value, Term::Rank rank) {
  // Operators of one rank are taken from left to right, but comparisons do not follow each other.
  const auto left = rank == Term::comparison ? Term::sum : rank;
  const auto right = rank == Term::power ? Term::power : static_cast<Term::Rank>(rank + 1);
  return {at_least(rank == Term::power ? Term::whole : left, a) + blank() + sign + blank() +
              at_least(right, b),
          value, rank};
}

Term any_leaf(const std::vector<double>& values) {
  const std::size_t at = any_of<std::size_t>(0, names.size() + 1);
  if (at < names.size()) return {names[at], values[at], Term::whole};
  const std::string digits = std::to_string(any_of(0, 4000) / 16.0);
  const std::string text = *rc::gen::element(digits, digits + "e-1", digits + "E+1");
  return {text, std::stod(text), Term::whole};
}

Term any_call(const Term& a, const Term& b) {
  const auto call = [&](const std::string& function, double value) {
    return Term{function + "(" + a.text + "," + blank() + b.text + ")", value, Term::whole};
  };
  const bool unknown = std::isnan(a.value) || std::isnan(b.value);
  const double nan = std::nan("");
  switch (any_of(0, 3)) {
    case 0:
      return {"abs(" + a.text + ")", std::fabs(a.value), Term::whole};
    case 1:
      return call("min", unknown ? nan : std::min(a.value, b.value));
    default:
      return call("max", unknown ? nan : std::max(a.value, b.value));
  }
}

Term any_operation(const Term& a, const Term& b, const Term& c) {
  switch (any_of(0, 9)) {
    case 0:
      return binary(a, "+", b, a.value + b.value, Term::sum);
    case 1:
      return binary(a, "-", b, a.value - b.value, Term::sum);
    case 2:
      return binary(a, "*", b, a.value * b.value, Term::product);
    case 3:
      return binary(a, "/", b, a.value / b.value, Term::product);
    case 4:
      return binary(a, "^", b, std::pow(a.value, b.value), Term::power);
    case 5:
      return binary(a, "<", b, a.value < b.value, Term::comparison);
    case 6:
      return binary(a, ">=", b, a.value >= b.value, Term::comparison);
    case 7:
      return {"-" + at_least(Term::power, a), -a.value, Term::sign};
    default:
      return {at_least(Term::comparison, a) + "?" + blank() + b.text + blank() + ":" + c.text,
              a.value != 0 ? b.value : c.value, Term::conditional};
  }
}

Term any_term(const std::vector<double>& values, int depth) {
  if (depth == 0) return any_leaf(values);
  const Term a = any_term(values, any_of(0, depth)), b = any_term(values, any_of(0, depth));
  return any_of(0, 4) == 0 ? any_call(a, b) : any_operation(a, b, any_leaf(values));
}

RC_GTEST_PROP(Expression, HasTheBitsOfItsTree, ()) {
  std::vector<double> values;
  for (std::size_t i = 0; i < names.size(); ++i) values.push_back(any_of(-4000, 4000) / 64.0);
  const Term term = any_term(values, 5);
  auto result = Expression::parse(term.text);
  if (const auto* mistake = std::get_if<ExpressionMistake>(&result)) {
    RC_PRE(mistake->message.find("nest deeper") == std::string::npos &&
           mistake->message.find("at most 1000 are") == std::string::npos);
    RC_FAIL(term.text + ": " + mistake->message);
  }
  const auto& expression = std::get<Expression>(result);
  RC_ASSERT(postfix_is_sound(expression.program().data(), expression.program().size()) != 0);
  std::vector<double> used;
  for (const std::string& name : expression.variables())
    used.push_back(values[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) -
                                                   names.begin())]);
  for (int times = 0; times < 2; ++times) {
    const double value = expression.evaluate(used);
    const bool same =
        std::bit_cast<std::uint64_t>(value) == std::bit_cast<std::uint64_t>(term.value);
    if (!same && (std::isfinite(term.value) || !std::isnan(value)))
      RC_FAIL(term.text + " is " + std::to_string(value) + ", not " + std::to_string(term.value));
  }
}

}  // namespace
}  // namespace reident::expression_property_test
