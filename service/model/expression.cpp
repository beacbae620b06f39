#include "service/model/expression.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <muParser.h>

#include <fmt/format.h>

#include "service/model/expression_grammar.hpp"

namespace reident {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* name_characters =
    "0123456789_.abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";

// A value that is not a number must not vanish in a comparison.
double least(double a, double b) {
  return std::isnan(a) || std::isnan(b) ? nan : std::min(a, b);
}
double largest(double a, double b) {
  return std::isnan(a) || std::isnan(b) ? nan : std::max(a, b);
}
double magnitude(double a) {
  return std::fabs(a);
}

}  // namespace

struct Expression::Evaluator {
  explicit Evaluator(const ExpressionGrammar& grammar)
      : variables(grammar.variables()), program(grammar.program()), values(variables.size()) {
    // The grammar is ours: what the library knows beyond it is taken away.
    parser.ClearFun();
    parser.ClearConst();
    parser.DefineNameChars(name_characters);
    parser.DefineFun("abs", magnitude);
    parser.DefineFun("min", least);
    parser.DefineFun("max", largest);
    parser.EnableOptimizer(false);  // each operation as it is written
    for (std::size_t i = 0; i < variables.size(); ++i) parser.DefineVar(variables[i], &values[i]);
    parser.SetExpr(grammar.canonical());
  }

  std::vector<std::string> variables;
  PostfixProgram program;
  std::vector<double> values;
  mu::Parser parser;
};

Expression::Expression(std::unique_ptr<Evaluator> evaluator) : evaluator_(std::move(evaluator)) {}
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

std::variant<Expression, ExpressionMistake> Expression::parse(std::string_view text) {
  ExpressionGrammar grammar(text);
  if (!grammar.check()) return ExpressionMistake{grammar.mistake()};
  try {
    Expression expression(std::make_unique<Evaluator>(grammar));
    expression.evaluator_->parser.Eval();
    return expression;
  } catch (const mu::ParserError& error) {
    return ExpressionMistake{fmt::format("cannot be evaluated: {}", error.GetMsg())};
  }
}

const std::vector<std::string>& Expression::variables() const {
  return evaluator_->variables;
}

const PostfixProgram& Expression::program() const {
  return evaluator_->program;
}

double Expression::evaluate(std::span<const double> values) {
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (!std::all_of(values.begin(), values.end(), is_finite)) return nan;
  std::copy(values.begin(), values.end(), evaluator_->values.begin());
  const double result = evaluator_->parser.Eval();
  return std::isfinite(result) ? result : nan;
}

}  // namespace reident
