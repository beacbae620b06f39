// An arithmetic expression of telemetry parameters, such as U_IN * I_IN / V_BUS.
//
//   conditional := comparison [ ? conditional : conditional ]
//   comparison  := sum [ < sum | <= sum | > sum | >= sum | == sum | != sum ]       (1 or 0)
//   sum         := term { + term | - term }
//   term        := factor { * factor | / factor }
//   factor      := [ + | - ] value [ ^ factor ]                        (-a^2 is -(a^2))
//   value       := number | parameter | ( conditional )
//                | abs(conditional) | min(conditional, conditional) | max(conditional, conditional)
//
// A number is written as 2, 0.5 or 1e-3, in every locale. A parameter stands by its name, where
// this has ASCII letters, digits, _ and . alone, begins with a letter or _, has at most 100 bytes
// and is not abs, min or max.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "service/model/postfix.h"

namespace reident {

/// What is wrong with an expression, where (1 is its first byte), and what would be right.
struct ExpressionMistake {
  std::string message;
};

/// A checked expression, ready to be evaluated. A value type; any number of threads may evaluate
/// one at the same time.
class Expression {
 public:
  static constexpr std::size_t max_bytes = 1000;  // of a text: bounds memory and time of evaluate()
  static constexpr int max_depth = 32;  // of brackets, powers and conditions in each other

  /// Reads the whole text. A mistake where it is no expression, is too long or nests too deep.
  /// Names are not looked up: whoever evaluates knows which parameters there are.
  static std::variant<Expression, ExpressionMistake> parse(std::string_view text);

  /// Names of the parameters, each once, in the order of their first use.
  const std::vector<std::string>& variables() const { return variables_; }

  /// What evaluate() computes, but for values that are not finite.
  const std::vector<PostfixStep>& program() const { return program_; }

  /// Returns the value for those of variables(), in their order and of their number. NaN where one
  /// of them, or the result, is not finite, also one that a condition does not choose. The same
  /// values give the same bits, in the service, in simulators and in an FMU. Allocates nothing.
  double evaluate(std::span<const double> values) const;

  /// Whether a change of the variable at `place` of variables() changes the value by a multiple of
  /// it, the others held, as the operations show: a ^ 1 is not affine in a.
  bool is_affine_in(std::size_t place) const;

 private:
  Expression(std::vector<std::string> variables, std::vector<PostfixStep> program);

  std::vector<std::string> variables_;
  std::vector<PostfixStep> program_;
};

}  // namespace reident
