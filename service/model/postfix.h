/* An expression as a program for a stack of numbers, and its one evaluator. The service and the
 * client library include this from C++, and every FMU has it among its C sources, so that all of
 * them compute the same.
 *
 * The stack begins empty. A step takes its operands off the stack, the last of them first, and puts
 * its result on it; what the program leaves is the value. Every operation is that of IEEE 754, or
 * pow of the C library. In the file of an FMU's model a step is one word:
 *
 *   p3            the value of variable 3 (from 0)
 *   0x1.8p+1      the number
 *   neg abs       of a: -a, |a|
 *   + - * / ^     of a, b: a+b, a-b, a*b, a/b, pow(a, b)
 *   min max       of a, b: b < a ? b : a and a < b ? b : a, or NaN where one of them is
 *   < <= > >= == !=    of a, b: 1 where it holds, or else 0
 *   select        of a, b, c: c where a is 0, or else b
 */
#ifndef REIDENT_POSTFIX_H
#define REIDENT_POSTFIX_H

#include <math.h>
#include <stddef.h>
#include <string.h>

typedef enum {
  postfix_number,
  postfix_variable,
  postfix_negate,
  postfix_magnitude,
  postfix_add,
  postfix_subtract,
  postfix_multiply,
  postfix_divide,
  postfix_power,
  postfix_least,
  postfix_largest,
  postfix_less,
  postfix_less_or_equal,
  postfix_greater,
  postfix_greater_or_equal,
  postfix_equal,
  postfix_not_equal,
  postfix_select
} PostfixKind;

typedef struct {
  PostfixKind kind;
  double number;   /* of postfix_number */
  size_t variable; /* of postfix_variable: its place among the values */
} PostfixStep;

enum { postfix_most_values = 512 }; /* on the stack at a time */

/* The word of an operation; empty for what puts a number or a variable on the stack. */
static inline const char* postfix_word(PostfixKind kind) {
  static const char* const words[] = {"",    "",    "neg", "abs", "+", "-",  "*",  "/",  "^",
                                      "min", "max", "<",   "<=",  ">", ">=", "==", "!=", "select"};
  return words[kind];
}

/* The operation that a word names; postfix_number where it names none. */
static inline PostfixKind postfix_kind(const char* word, size_t length) {
  for (int kind = postfix_negate; kind <= postfix_select; ++kind) {
    const char* const known = postfix_word((PostfixKind)kind);
    if (strlen(known) == length && memcmp(known, word, length) == 0) return (PostfixKind)kind;
  }
  return postfix_number;
}

static inline size_t postfix_operands(PostfixKind kind) {
  if (kind <= postfix_variable) return 0;
  if (kind <= postfix_magnitude) return 1;
  return kind == postfix_select ? 3 : 2;
}

/* Whether a program leaves one value, never takes from an empty stack and needs no larger one than
 * there is. */
static inline int postfix_is_sound(const PostfixStep* steps, size_t count) {
  size_t depth = 0;
  for (size_t i = 0; i < count; ++i) {
    const size_t operands = postfix_operands(steps[i].kind);
    if (depth < operands) return 0;
    depth = depth - operands + 1;
    if (depth > postfix_most_values) return 0;
  }
  return depth == 1;
}

static inline double postfix_least_of(double a, double b) {
  if (isnan(a) || isnan(b)) return NAN;
  return b < a ? b : a;
}

static inline double postfix_largest_of(double a, double b) {
  if (isnan(a) || isnan(b)) return NAN;
  return a < b ? b : a;
}

/* NOLINTBEGIN(clang-analyzer-core.*): a sound program takes no more than it has put on the stack */

/* The value of a sound program; it need not be finite. */
static inline double postfix_value(const PostfixStep* steps, size_t count,
                                   const double* variables) {
  double stack[postfix_most_values];
  double* end = stack; /* behind the value on top */
  for (const PostfixStep* step = steps; step != steps + count; ++step) {
    switch (step->kind) {
      case postfix_number:
        *end++ = step->number;
        break;
      case postfix_variable:
        *end++ = variables[step->variable];
        break;
      case postfix_negate:
        end[-1] = -end[-1];
        break;
      case postfix_magnitude:
        end[-1] = fabs(end[-1]);
        break;
      case postfix_add:
        --end;
        end[-1] += end[0];
        break;
      case postfix_subtract:
        --end;
        end[-1] -= end[0];
        break;
      case postfix_multiply:
        --end;
        end[-1] *= end[0];
        break;
      case postfix_divide:
        --end;
        end[-1] /= end[0];
        break;
      case postfix_power:
        --end;
        end[-1] = pow(end[-1], end[0]);
        break;
      case postfix_least:
        --end;
        end[-1] = postfix_least_of(end[-1], end[0]);
        break;
      case postfix_largest:
        --end;
        end[-1] = postfix_largest_of(end[-1], end[0]);
        break;
      case postfix_less:
        --end;
        end[-1] = end[-1] < end[0];
        break;
      case postfix_less_or_equal:
        --end;
        end[-1] = end[-1] <= end[0];
        break;
      case postfix_greater:
        --end;
        end[-1] = end[-1] > end[0];
        break;
      case postfix_greater_or_equal:
        --end;
        end[-1] = end[-1] >= end[0];
        break;
      case postfix_equal:
        --end;
        end[-1] = end[-1] == end[0];
        break;
      case postfix_not_equal:
        --end;
        end[-1] = end[-1] != end[0];
        break;
      case postfix_select:
        end -= 2;
        end[-1] = end[-1] == 0 ? end[1] : end[0];
        break;
    }
  }
  return stack[0];
}

/* NOLINTEND(clang-analyzer-core.*) */

#endif
