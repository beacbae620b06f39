#include "service/model/derived_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace reident {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::Vector;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_derived(const std::vector<DerivedInput>& derived, const std::string& name) {
  return std::any_of(derived.begin(), derived.end(),
                     [&name](const DerivedInput& one) { return one.name == name; });
}

/// What is wrong with the name of the derived input `index`; empty when nothing is.
std::string name_mistake(const std::vector<DerivedInput>& derived, std::size_t index,
                         const std::vector<std::string>& inputs,
                         const std::vector<std::string>& outputs) {
  const std::string& name = derived[index].name;
  const auto above = derived.begin() + static_cast<std::ptrdiff_t>(index);
  if (std::any_of(derived.begin(), above,
                  [&name](const DerivedInput& other) { return other.name == name; }))
    return fmt::format("{} is the name of a derived input above; give it another", name);
  if (contains(outputs, name))
    return fmt::format("{} is the name of an output; give the derived input another", name);
  if (!contains(inputs, name))
    return fmt::format("{} is not used; add it to the inputs or leave it out", name);
  return {};
}

std::string operand_mistake(const std::vector<DerivedInput>& derived, const DerivedInput& one,
                            const std::string& operand, const std::vector<std::string>& outputs) {
  if (operand == one.name)
    return fmt::format("uses its own name {}; a derived input and a parameter need two names",
                       operand);
  if (is_derived(derived, operand))
    return fmt::format("uses {}, which is derived itself; write its expression in its place",
                       operand);
  if (contains(outputs, operand))
    return fmt::format("uses the output {}; a model cannot be driven by what it computes", operand);
  return {};
}

}  // namespace

std::vector<DerivedInputMistake> mistakes_in(const std::vector<DerivedInput>& derived,
                                             const std::vector<std::string>& inputs,
                                             const std::vector<std::string>& outputs) {
  std::vector<DerivedInputMistake> mistakes;
  for (std::size_t i = 0; i < derived.size(); ++i) {
    const auto add = [&](std::string_view key, std::string message) {
      if (!message.empty()) mistakes.push_back({i, key, std::move(message)});
    };
    add("name", name_mistake(derived, i, inputs, outputs));
    const auto parsed = Expression::parse(derived[i].expression);
    if (const auto* mistake = std::get_if<ExpressionMistake>(&parsed)) {
      add("expression", mistake->message);
      continue;
    }
    const auto& operands = std::get<Expression>(parsed).variables();
    if (operands.empty())
      add("expression", "uses no parameter; what never changes cannot drive a model");
    for (const std::string& operand : operands)
      add("expression", operand_mistake(derived, derived[i], operand, outputs));
  }
  return mistakes;
}

std::vector<SensorBias> biases_of(const std::vector<std::string>& inputs,
                                  const std::vector<DerivedInput>& derived) {
  std::vector<std::string> computed;
  for (const DerivedInput& one : derived) computed.push_back(one.name);
  std::vector<SensorBias> biases;
  const InputExpressions expressions(computed, derived);
  for (Index place = 0; place < std::ssize(expressions.parameters()); ++place) {
    const std::string& sensor = expressions.parameters()[static_cast<std::size_t>(place)];
    if (expressions.are_affine_in(place)) {
      biases.push_back({sensor});
      continue;
    }
    for (const int direction : {-1, 1})
      for (int size = 0; size < bias_sizes; ++size) biases.push_back({sensor, direction, size});
  }
  for (const std::string& input : inputs)
    if (!is_derived(derived, input) &&
        std::ranges::find(biases, input, &SensorBias::sensor) == biases.end())
      biases.push_back({input});
  return biases;
}

double size_of(const SensorBias& bias, double deviation) {
  if (!(deviation > 0)) deviation = 1;
  if (bias.direction == 0) return deviation;
  // What a bias does to a root where the sensor rests at 0, the next larger size does as well, and
  // to larger values at most twice as much.
  const int largest = std::ilogb(deviation) - 1;
  const int below = ((largest - bias.size) % bias_sizes + bias_sizes) % bias_sizes;
  return std::ldexp(bias.direction, largest - below);
}

InputExpressions::InputExpressions(const std::vector<std::string>& inputs,
                                   const std::vector<DerivedInput>& derived) {
  for (const std::string& name : inputs) {
    Input input;
    const auto found = std::find_if(derived.begin(), derived.end(),
                                    [&name](const DerivedInput& one) { return one.name == name; });
    if (found == derived.end()) {
      input.operands.push_back(place_of(name));
    } else {
      auto parsed = Expression::parse(found->expression);
      if (const auto* mistake = std::get_if<ExpressionMistake>(&parsed))
        throw std::invalid_argument(
            fmt::format("the expression of input {}: {}", name, mistake->message));
      input.expression = std::get<Expression>(std::move(parsed));
      for (const std::string& operand : input.expression->variables())
        input.operands.push_back(place_of(operand));
      input.values.resize(input.operands.size());
      any_derived_ = true;
    }
    inputs_.push_back(std::move(input));
  }
}

Index InputExpressions::place_of(const std::string& parameter) {
  const auto found = std::find(parameters_.begin(), parameters_.end(), parameter);
  const Index place = found - parameters_.begin();
  if (found == parameters_.end()) parameters_.push_back(parameter);
  return place;
}

void InputExpressions::evaluate(const Vector& parameters, Vector& inputs) {
  for (Index place = 0; place < inputs.size(); ++place) inputs(place) = evaluate(parameters, place);
}

double InputExpressions::evaluate(const Vector& parameters, Index place) {
  Input& input = inputs_[static_cast<std::size_t>(place)];
  if (!input.expression) return parameters(input.operands.front());
  for (std::size_t i = 0; i < input.values.size(); ++i)
    input.values[i] = parameters(input.operands[i]);
  return input.expression->evaluate(input.values);
}

std::vector<Index> InputExpressions::inputs_of(Index parameter) const {
  std::vector<Index> places;
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    if (std::ranges::count(inputs_[i].operands, parameter) > 0)
      places.push_back(static_cast<Index>(i));
  return places;
}

bool InputExpressions::are_affine_in(Index parameter) const {
  return std::ranges::all_of(inputs_, [parameter](const Input& input) {
    const auto found = std::ranges::find(input.operands, parameter);
    return found == input.operands.end() || !input.expression ||
           input.expression->is_affine_in(static_cast<std::size_t>(found - input.operands.begin()));
  });
}

Record InputExpressions::evaluate(Record record) {
  if (!any_derived_) return record;
  const auto m = static_cast<Index>(inputs_.size());
  Record result;
  result.period_s = record.period_s;
  result.u.resize(record.rows(), m);
  result.y.resize(record.rows(), record.y.cols());
  Vector parameters(record.u.cols()), inputs(m);
  Index rows = 0;
  for (const identification::Segment& segment : record.segments) {
    for (Index row = segment.begin; row < segment.end; ++row) {
      parameters = record.u.row(row).transpose();
      evaluate(parameters, inputs);
      if (!inputs.allFinite()) continue;
      const std::int64_t tick = segment.tick_of(row);
      auto& segments = result.segments;
      if (segments.empty() || segments.back().end_tick() != tick)
        segments.push_back({rows, rows, tick});
      result.u.row(rows) = inputs.transpose();
      result.y.row(rows) = record.y.row(row);
      segments.back().end = ++rows;
    }
  }
  result.u.conservativeResize(rows, Eigen::NoChange);
  result.y.conservativeResize(rows, Eigen::NoChange);
  return result;
}

}  // namespace reident
