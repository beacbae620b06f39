#include "service/model/expression.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "service/model/expression_grammar.hpp"

namespace reident {

// A value takes a byte, and another before the next.
static_assert((Expression::max_bytes + 1) / 2 <= postfix_most_values);

Expression::Expression(std::vector<std::string> variables, std::vector<PostfixStep> program)
    : variables_(std::move(variables)), program_(std::move(program)) {}

std::variant<Expression, ExpressionMistake> Expression::parse(std::string_view text) {
  ExpressionGrammar grammar(text);
  if (!grammar.check()) return ExpressionMistake{grammar.mistake()};
  return Expression(grammar.variables(), grammar.program());
}

double Expression::evaluate(std::span<const double> values) const {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (!std::all_of(values.begin(), values.end(), is_finite)) return none;
  const double result = postfix_value(program_.data(), program_.size(), values.data());
  return std::isfinite(result) ? result : none;
}

}  // namespace reident
