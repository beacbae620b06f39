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

bool Expression::is_affine_in(std::size_t place) const {
  enum class Share { constant, affine, other };
  std::vector<Share> stack;
  for (const PostfixStep& step : program_) {
    if (step.kind <= postfix_variable) {
      const bool is_it = step.kind == postfix_variable && step.variable == place;
      stack.push_back(is_it ? Share::affine : Share::constant);
      continue;
    }
    const auto operands = stack.end() - static_cast<std::ptrdiff_t>(postfix_operands(step.kind));
    const Share first = *operands, last = stack.back(),
                most = *std::max_element(operands, stack.end());
    stack.erase(operands, stack.end());
    const bool keeps =
        step.kind == postfix_negate || step.kind == postfix_add || step.kind == postfix_subtract ||
        (step.kind == postfix_multiply && std::min(first, last) == Share::constant) ||
        (step.kind == postfix_divide && last == Share::constant);
    stack.push_back(keeps || most == Share::constant ? most : Share::other);
  }
  return stack.back() != Share::other;
}

}  // namespace reident
