#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>

#include <fmt/format.h>

#include "service/model_export/fmu_text.hpp"

namespace reident::model_export {
namespace {

using identification::Index;
using identification::Matrix;

/// As C writes it by %a, in every locale.
std::string exact(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), std::fabs(value),
                                 std::chars_format::hex);
  return (std::signbit(value) ? "-0x" : "0x") + std::string(digits.data(), end.ptr);
}

std::string row_by_row(std::string_view name, const Matrix& matrix) {
  std::string text(name);
  for (Index row = 0; row < matrix.rows(); ++row)
    for (Index column = 0; column < matrix.cols(); ++column)
      text += ' ' + exact(matrix(row, column));
  return text + '\n';
}

std::string start_values(std::string_view name, const std::vector<FmuVariable>& variables) {
  std::string text(name);
  for (const FmuVariable& variable : variables) text += ' ' + exact(variable.start);
  return text + '\n';
}

/// "input COUNT STEP..."
std::string input_text(const Signal& input, const std::vector<FmuVariable>& parameters) {
  if (input.expression.empty())
    return fmt::format("input 1 p{}\n", place_of(parameters, input.name));
  const auto parsed = Expression::parse(input.expression);
  const Expression& expression = std::get<Expression>(parsed);
  std::string text = fmt::format("input {}", expression.program().size());
  for (const PostfixStep& step : expression.program()) {
    text += ' ';
    if (step.kind == postfix_number)
      text += exact(step.number);
    else if (step.kind == postfix_variable)
      text += fmt::format("p{}", place_of(parameters, expression.variables()[step.variable]));
    else
      text += postfix_word(step.kind);
  }
  return text + '\n';
}

/// FNV-1a of 64 bits.
std::uint64_t checksum(std::string_view text) {
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (const char c : text) sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return sum;
}

}  // namespace

std::string fmu_resources(const ModelVersion& version, const FmuVariables& variables) {
  const EquipmentModel& model = version.model;
  const identification::StateSpaceModel& dynamics = model.dynamics;
  std::string text = fmt::format(
      "reident-fmu-model 2\ndigest {}\nperiod {}\norder {}\ninputs {}\noutputs {}\nparameters {}\n",
      version.digest, exact(dynamics.period_s), dynamics.order(), dynamics.inputs(),
      dynamics.outputs(), variables.inputs.size());
  text += start_values("start", variables.inputs) + start_values("state", variables.states);
  text += row_by_row("A", dynamics.A) + row_by_row("B", dynamics.B) + row_by_row("C", dynamics.C) +
          row_by_row("D", dynamics.D) + row_by_row("u0", dynamics.u0) +
          row_by_row("y0", dynamics.y0);
  for (const Signal& input : model.inputs) text += input_text(input, variables.inputs);
  return text + fmt::format("checksum {:016x}\n", checksum(text));
}

}  // namespace reident::model_export
