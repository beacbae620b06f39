// The grammar of expression.hpp, checked by recursive descent, and what it says to do. This is the
// only reader of expressions: service, client and FMU get its postfix program. Nothing throws but
// std::bad_alloc; the text may be anything (tests/fuzz/expression_fuzz.cpp).
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "service/model/postfix.h"

namespace reident {

/// Reads one text, once. It points into the text, which has to outlive it. Each rule is a function
/// that reads what it is named after at the next byte, notes its steps in program_ behind those of
/// its operands, and returns false after the first mistake.
class ExpressionGrammar {
 public:
  explicit ExpressionGrammar(std::string_view text) : text_(text) {}

  /// Whether the whole text is an expression; call once. What follows holds afterwards.
  bool check();

  /// Where it is not: the first mistake, with its place.
  const std::string& mistake() const { return mistake_; }
  /// The parameters, each once, in the order of their first use.
  const std::vector<std::string>& variables() const { return variables_; }
  /// What the text says to compute; its variables are places in variables().
  const std::vector<PostfixStep>& program() const { return program_; }

 private:
  /// The next byte that is no blank; 0 at the end.
  char peek();
  /// Whether blanks alone are left.
  bool at_end();
  /// Steps over the token, and blanks before it, where it comes next.
  bool take(std::string_view token);
  struct Operator {
    std::string_view token;
    PostfixKind kind;
  };
  /// The first of them that stands at the next byte.
  std::optional<PostfixKind> take_any(std::initializer_list<Operator> operators);
  /// As take(), but a mistake where something else comes.
  bool expect(std::string_view token);

  /// Each notes the mistake, where there is none yet, and says false.
  bool refuse(std::size_t at, std::string_view what);
  bool refuse_value();
  bool refuse_rest();
  /// What stands at the next byte, for a message; the bytes of one character or name together.
  std::string found();

  /// What stands within something else: `rule`, one level deeper. A mistake below max_depth, so
  /// that no text exhausts the stack.
  bool nested(bool (ExpressionGrammar::*rule)());
  bool conditional();
  bool comparison();
  bool sum();
  bool term();
  bool factor();
  bool value();
  bool number();
  bool name();
  bool call(int values);  // the brackets behind abs, min and max, with so many values
  void parameter(std::string_view token);
  /// Notes an operation whose operands are noted.
  bool operate(PostfixKind kind);

  std::string_view text_;
  std::size_t at_ = 0;
  int depth_ = 0;
  std::string mistake_;
  std::vector<std::string> variables_;
  std::vector<PostfixStep> program_;
};

}  // namespace reident
