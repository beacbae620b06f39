/* A model's input as a program for a stack of numbers, over the values of parameters.
 *
 * In the model's file a step is one word:
 *
 *   p3            puts the value of parameter 3 (from 0) on the stack
 *   0x1.8p+1      puts the number on it
 *   neg abs       replaces a, the value on top, by -a, |a|
 *   + - * / ^     replaces a, b (b on top) by a+b, a-b, a*b, a/b, pow(a, b)
 *   min max       by b < a ? b : a and a < b ? b : a, or NaN where one of them is
 *   < <= > >= == !=    by 1 where it holds, or else 0
 *   select        replaces a, b, c (c on top) by c where a is 0, or else b
 */
#ifndef REIDENT_POSTFIX_H
#define REIDENT_POSTFIX_H

#include <math.h>
#include <stddef.h>
#include <string.h>

typedef enum {
  step_number,
  step_parameter,
  step_negate,
  step_magnitude,
  step_add,
  step_subtract,
  step_multiply,
  step_divide,
  step_power,
  step_least,
  step_largest,
  step_less,
  step_less_or_equal,
  step_greater,
  step_greater_or_equal,
  step_equal,
  step_not_equal,
  step_select
} StepKind;

typedef struct {
  StepKind kind;
  double number;
  size_t parameter;
} Step;

typedef struct {
  Step* steps;
  size_t count;
} Program;

enum { program_max_depth = 512 };

static const char* const step_words[] = {
    [step_number] = "",          [step_parameter] = "",   [step_negate] = "neg",
    [step_magnitude] = "abs",    [step_add] = "+",        [step_subtract] = "-",
    [step_multiply] = "*",       [step_divide] = "/",     [step_power] = "^",
    [step_least] = "min",        [step_largest] = "max",  [step_less] = "<",
    [step_less_or_equal] = "<=", [step_greater] = ">",    [step_greater_or_equal] = ">=",
    [step_equal] = "==",         [step_not_equal] = "!=", [step_select] = "select"};

/* The operation that a word names; step_number where it names none. */
static StepKind step_named(const char* word, size_t length) {
  for (int kind = step_negate; kind <= step_select; ++kind)
    if (strlen(step_words[kind]) == length && memcmp(step_words[kind], word, length) == 0)
      return (StepKind)kind;
  return step_number;
}

static size_t step_operands(StepKind kind) {
  if (kind <= step_parameter) return 0;
  if (kind <= step_magnitude) return 1;
  return kind == step_select ? 3 : 2;
}

/* Whether a program leaves one value, never takes from an empty stack and needs no deeper one than
 * there is. */
static int program_is_sound(const Program* program) {
  size_t depth = 0;
  for (size_t i = 0; i < program->count; ++i) {
    const size_t operands = step_operands(program->steps[i].kind);
    if (depth < operands) return 0;
    depth = depth - operands + 1;
    if (depth > program_max_depth) return 0;
  }
  return depth == 1;
}

static double least_of(double a, double b) {
  if (isnan(a) || isnan(b)) return NAN;
  return b < a ? b : a;
}

static double largest_of(double a, double b) {
  if (isnan(a) || isnan(b)) return NAN;
  return a < b ? b : a;
}

static double step_result(StepKind kind, const double* operands) {
  const double a = operands[0], b = operands[1];
  switch (kind) {
    case step_add:
      return a + b;
    case step_subtract:
      return a - b;
    case step_multiply:
      return a * b;
    case step_divide:
      return a / b;
    case step_power:
      return pow(a, b);
    case step_least:
      return least_of(a, b);
    case step_largest:
      return largest_of(a, b);
    case step_less:
      return a < b;
    case step_less_or_equal:
      return a <= b;
    case step_greater:
      return a > b;
    case step_greater_or_equal:
      return a >= b;
    case step_equal:
      return a == b;
    case step_not_equal:
      return a != b;
    case step_negate:
      return -a;
    case step_magnitude:
      return fabs(a);
    case step_select:
      return a == 0 ? operands[2] : b;
    default:
      return NAN; /* what puts a value takes none */
  }
}

/* The value of a sound program; it need not be finite. */
static double program_value(const Program* program, const double* parameters) {
  double stack[program_max_depth + 2] = {
      0}; /* an operation may look at two places beyond its own */
  size_t depth = 0;
  for (size_t i = 0; i < program->count; ++i) {
    const Step* step = &program->steps[i];
    depth -= step_operands(step->kind);
    stack[depth] = step->kind == step_number      ? step->number
                   : step->kind == step_parameter ? parameters[step->parameter]
                                                  : step_result(step->kind, &stack[depth]);
    ++depth;
  }
  return stack[0];
}

#endif
