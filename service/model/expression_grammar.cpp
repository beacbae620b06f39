#include "service/model/expression_grammar.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

#include "service/model/expression.hpp"

namespace reident {
namespace {

constexpr std::size_t max_name_bytes = 100;

struct Function {
  std::string_view name;
  int values;
  PostfixKind kind;
};
constexpr std::array functions = {Function{"abs", 1, postfix_magnitude},
                                  Function{"min", 2, postfix_least},
                                  Function{"max", 2, postfix_largest}};

const Function* function_of(std::string_view name) {
  const auto found = std::find_if(functions.begin(), functions.end(),
                                  [name](const Function& one) { return one.name == name; });
  return found == functions.end() ? nullptr : &*found;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool begins_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool continues_name(char c) {
  return begins_name(c) || is_digit(c) || c == '.';
}

}  // namespace

bool ExpressionGrammar::check() {
  if (text_.size() > Expression::max_bytes) {
    refuse(0, fmt::format("has {} bytes; at most {} are allowed", text_.size(),
                          Expression::max_bytes));
    return false;
  }
  return conditional() && (at_end() || refuse_rest());
}

char ExpressionGrammar::peek() {
  while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  return at_ < text_.size() ? text_[at_] : '\0';
}

bool ExpressionGrammar::at_end() {
  peek();
  return at_ == text_.size();
}

bool ExpressionGrammar::take(std::string_view token) {
  peek();
  if (!text_.substr(at_).starts_with(token)) return false;
  at_ += token.size();
  return true;
}

std::optional<PostfixKind> ExpressionGrammar::take_any(std::initializer_list<Operator> operators) {
  const auto* const found = std::find_if(operators.begin(), operators.end(),
                                         [this](const Operator& one) { return take(one.token); });
  return found == operators.end() ? std::nullopt : std::optional(found->kind);
}

bool ExpressionGrammar::operate(PostfixKind kind) {
  program_.push_back({kind, 0, 0});
  return true;
}

bool ExpressionGrammar::refuse(std::size_t at, std::string_view what) {
  if (mistake_.empty()) mistake_ = fmt::format("at byte {}: {}", at + 1, what);
  return false;
}

std::string ExpressionGrammar::found() {
  if (at_end()) return "the end";
  if (text_[at_] == '\0') return "a zero byte";
  std::size_t end = at_ + 1;
  if (begins_name(text_[at_]))
    while (end < text_.size() && continues_name(text_[end])) ++end;
  else
    while (end < text_.size() && (text_[end] & 0xc0) == 0x80) ++end;
  return fmt::format("\"{}\"", text_.substr(at_, end - at_));
}

bool ExpressionGrammar::refuse_value() {
  const std::string what = found();
  return refuse(at_, fmt::format("a number, a parameter, (, abs, min or max is expected, not {}; "
                                 "a parameter's name here has letters, digits, _ and . alone and "
                                 "begins with a letter or _",
                                 what));
}

bool ExpressionGrammar::refuse_rest() {
  const std::string what = found();
  return refuse(at_, fmt::format("an operator is expected, not {}; allowed are + - * / ^ ( ), "
                                 "one comparison < <= > >= == != of two sums, a ? b : c, abs(a), "
                                 "min(a, b) and max(a, b)",
                                 what));
}

bool ExpressionGrammar::expect(std::string_view token) {
  if (take(token)) return true;
  const std::string what = found();
  return refuse(at_, fmt::format("{} is expected, not {}", token, what));
}

bool ExpressionGrammar::nested(bool (ExpressionGrammar::*rule)()) {
  if (depth_ == Expression::max_depth)
    return refuse(at_, fmt::format("brackets, powers and conditions nest deeper than {}",
                                   Expression::max_depth));
  ++depth_;
  const bool keeps = (this->*rule)();
  --depth_;
  return keeps;
}

bool ExpressionGrammar::conditional() {
  if (!comparison()) return false;
  if (!take("?")) return true;
  return nested(&ExpressionGrammar::conditional) && expect(":") &&
         nested(&ExpressionGrammar::conditional) && operate(postfix_select);
}

bool ExpressionGrammar::comparison() {
  if (!sum()) return false;
  const auto kind = take_any({{"<=", postfix_less_or_equal},
                              {">=", postfix_greater_or_equal},
                              {"==", postfix_equal},
                              {"!=", postfix_not_equal},
                              {"<", postfix_less},
                              {">", postfix_greater}});
  return kind ? sum() && operate(*kind) : true;
}

bool ExpressionGrammar::sum() {
  if (!term()) return false;
  while (const auto kind = take_any({{"+", postfix_add}, {"-", postfix_subtract}}))
    if (!term() || !operate(*kind)) return false;
  return true;
}

bool ExpressionGrammar::term() {
  if (!factor()) return false;
  while (const auto kind = take_any({{"*", postfix_multiply}, {"/", postfix_divide}}))
    if (!factor() || !operate(*kind)) return false;
  return true;
}

// The sign is the last to work: -a^2 is -(a^2).
bool ExpressionGrammar::factor() {
  const bool negative = take("-");
  if (!negative) take("+");
  if (!value()) return false;
  if (take("^") && !(nested(&ExpressionGrammar::factor) && operate(postfix_power))) return false;
  return negative ? operate(postfix_negate) : true;
}

bool ExpressionGrammar::value() {
  const char first = peek();
  if (is_digit(first)) return number();
  if (begins_name(first)) return name();
  if (take("(")) return nested(&ExpressionGrammar::conditional) && expect(")");
  return refuse_value();
}

bool ExpressionGrammar::number() {
  const std::size_t begin = at_;
  const char* const end = text_.data() + text_.size();
  double parsed = 0;
  const auto [stop, error] = std::from_chars(text_.data() + at_, end, parsed);
  at_ = static_cast<std::size_t>(stop - text_.data());
  const std::string_view token = text_.substr(begin, at_ - begin);
  if (error != std::errc())
    return refuse(begin, fmt::format("{} is too large or too small for a number", token));
  if (at_ < text_.size() && continues_name(text_[at_]))
    return refuse(begin,
                  "a number ends in a letter; write 2*a for a product, and a parameter's "
                  "name begins with a letter or _");
  program_.push_back({postfix_number, parsed, 0});
  return true;
}

bool ExpressionGrammar::name() {
  const std::size_t begin = at_;
  while (at_ < text_.size() && continues_name(text_[at_])) ++at_;
  const std::string_view token = text_.substr(begin, at_ - begin);
  const Function* const function = function_of(token);
  if (peek() == '(') {
    if (function == nullptr)
      return refuse(begin, fmt::format("{} is no function here; abs, min and max are", token));
    return call(function->values) && operate(function->kind);
  }
  if (function != nullptr)
    return refuse(begin, fmt::format("{0} is a function and needs its values in ( ); a parameter "
                                     "called {0} cannot stand in an expression",
                                     token));
  if (token.size() > max_name_bytes)
    return refuse(begin, fmt::format("the name has {} bytes; at most {} can stand in an "
                                     "expression",
                                     token.size(), max_name_bytes));
  parameter(token);
  return true;
}

void ExpressionGrammar::parameter(std::string_view token) {
  const auto found = std::find(variables_.begin(), variables_.end(), token);
  program_.push_back({postfix_variable, 0, static_cast<std::size_t>(found - variables_.begin())});
  if (found == variables_.end()) variables_.emplace_back(token);
}

bool ExpressionGrammar::call(int values) {
  expect("(");
  for (int i = 0; i < values; ++i)
    if ((i > 0 && !expect(",")) || !nested(&ExpressionGrammar::conditional)) return false;
  return expect(")");
}

}  // namespace reident
