#include "service/model_export/fmu_variables.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

namespace reident::model_export {
namespace {

using identification::Index;

constexpr double start_within_expressions = 1;

std::string range_text(const Signal& signal) {
  return fmt::format("identified between {:.6g} and {:.6g} {}", signal.low, signal.high,
                     signal.unit);
}

std::vector<std::string> operands_of(const Signal& input) {
  if (input.expression.empty()) return {input.name};
  return InputExpressions({input.name}, derived_inputs({input})).parameters();
}

FmuVariable variable_of(const EquipmentModel& model, const std::string& parameter) {
  FmuVariable variable{parameter, {}, {}, start_within_expressions};
  std::vector<std::string> uses;
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    const Signal& input = model.inputs[i];
    if (input.expression.empty() && input.name == parameter) {
      variable.unit = input.unit;
      variable.start = model.dynamics.u0(static_cast<Index>(i));
      uses.push_back(range_text(input));
    } else if (!input.expression.empty()) {
      const auto operands = operands_of(input);
      if (std::find(operands.begin(), operands.end(), parameter) != operands.end())
        uses.push_back(
            fmt::format("in {} = {}, {}", input.name, input.expression, range_text(input)));
    }
  }
  variable.description = fmt::format("{}", fmt::join(uses, "; "));
  return variable;
}

/// A name that no parameter has.
std::string own_name(std::string name, const FmuVariables& variables) {
  const auto is_taken = [&name](const FmuVariable& variable) { return variable.name == name; };
  while (std::any_of(variables.inputs.begin(), variables.inputs.end(), is_taken) ||
         std::any_of(variables.outputs.begin(), variables.outputs.end(), is_taken))
    name += '_';
  return name;
}

void add_states(FmuVariables& variables, const identification::StateSpaceModel& dynamics,
                const identification::Vector& x0) {
  for (Index i = 0; i < dynamics.order(); ++i)
    variables.states.push_back(
        {own_name(fmt::format("state[{}]", i + 1), variables),
         {},
         "of the model, where the next tick begins; 0 is the operating point",
         x0.size() == 0 ? 0 : x0(i)});
  for (Index q = 0; q < dynamics.outputs(); ++q) {
    std::vector<std::size_t>& shown = variables.shown.emplace_back();
    for (Index i = 0; i < dynamics.order(); ++i)
      if (dynamics.C(q, i) != 0) shown.push_back(static_cast<std::size_t>(i));
  }
}

}  // namespace

std::size_t place_of(const std::vector<FmuVariable>& inputs, const std::string& parameter) {
  const auto found = std::find_if(inputs.begin(), inputs.end(), [&](const FmuVariable& variable) {
    return variable.name == parameter;
  });
  if (found == inputs.end()) throw std::logic_error(parameter + " is no input of the FMU");
  return static_cast<std::size_t>(found - inputs.begin());
}

FmuVariables fmu_variables(const EquipmentModel& model, const identification::Vector& x0) {
  FmuVariables variables;
  const InputExpressions inputs(signal_names(model.inputs), derived_inputs(model.inputs));
  for (const std::string& parameter : inputs.parameters())
    variables.inputs.push_back(variable_of(model, parameter));
  for (std::size_t q = 0; q < model.outputs.size(); ++q) {
    const Signal& output = model.outputs[q];
    variables.outputs.push_back({output.name, output.unit, range_text(output)});
    std::set<std::size_t> direct;
    for (std::size_t i = 0; i < model.inputs.size(); ++i) {
      if (model.dynamics.D(static_cast<Index>(q), static_cast<Index>(i)) == 0) continue;
      for (const std::string& parameter : operands_of(model.inputs[i]))
        direct.insert(place_of(variables.inputs, parameter));
    }
    variables.direct.emplace_back(direct.begin(), direct.end());
  }
  add_states(variables, model.dynamics, x0);
  variables.time = own_name("time", variables);
  return variables;
}

}  // namespace reident::model_export
