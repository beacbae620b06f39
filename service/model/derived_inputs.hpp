// Inputs of a model that follow from telemetry parameters by expressions.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "identification/samples/record.hpp"
#include "service/model/expression.hpp"

namespace reident {

struct DerivedInput {
  std::string name;
  std::string expression;  // over SATCS parameters
  std::string unit;
  bool operator==(const DerivedInput&) const = default;
};

struct DerivedInputMistake {
  std::size_t index = 0;  // of the derived input
  std::string_view key;   // "name" or "expression"
  std::string message;    // what is wrong and what would mend it
};

/// All that is wrong with `derived` in a model of these inputs and outputs.
std::vector<DerivedInputMistake> mistakes_in(const std::vector<DerivedInput>& derived,
                                             const std::vector<std::string>& inputs,
                                             const std::vector<std::string>& outputs);

/// From values of parameters to those of a model's inputs, tick by tick.
class InputExpressions {
 public:
  /// An input is the derived one of its name, or else the parameter itself. Throws
  /// std::invalid_argument naming an input whose expression is none.
  InputExpressions(const std::vector<std::string>& inputs,
                   const std::vector<DerivedInput>& derived);

  /// What the inputs are computed from, each once, in the order of first use; the inputs themselves
  /// where none is derived.
  const std::vector<std::string>& parameters() const { return parameters_; }

  /// The inputs (m) for values of parameters(); NaN where a derived one has no finite value.
  void evaluate(const identification::Vector& parameters, identification::Vector& inputs);

  /// The record with the inputs in the place of its u, which holds parameters(). Rows at which an
  /// input has no finite value are left out as holes are.
  identification::Record evaluate(identification::Record record);

 private:
  struct Input {
    std::vector<identification::Index> operands;  // places in parameters_
    std::optional<Expression> expression;         // absent: the one operand itself
    std::vector<double> values;
  };
  identification::Index place_of(const std::string& parameter);

  std::vector<std::string> parameters_;
  std::vector<Input> inputs_;
  bool any_derived_ = false;
};

}  // namespace reident
