// An expression as a program for a stack of numbers: what other languages evaluate it from.
#pragma once

#include <cstddef>
#include <vector>

namespace reident {

/// One step, on a stack that begins empty. An operation takes its operands off the stack, the last
/// of them first, and puts its result on it; what the program leaves is the value. Every operation
/// is that of IEEE 754, or pow of the C library.
struct PostfixStep {
  enum class Kind {
    number,    // puts `number` on the stack
    variable,  // puts the value of variables()[variable] on the stack
    negate,
    add,
    subtract,
    multiply,
    divide,
    power,
    less,  // 1 where it holds, or else 0; likewise the five that follow
    less_or_equal,
    greater,
    greater_or_equal,
    equal,
    not_equal,
    magnitude,  // |a|
    least,      // b < a ? b : a; NaN where one of them is
    largest,    // a < b ? b : a; NaN where one of them is
    select,     // of a, b, c: c where a is 0, or else b
  };
  Kind kind = Kind::number;
  double number = 0;
  std::size_t variable = 0;
  bool operator==(const PostfixStep&) const = default;
};

using PostfixProgram = std::vector<PostfixStep>;

}  // namespace reident
