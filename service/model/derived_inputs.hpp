// Inputs of a model that follow from telemetry parameters by expressions, where an equipment is
// linear in a power or a difference and not in what is measured. The service, the client library
// and the FMU compute the same bits (postfix.h).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "identification/samples/record.hpp"
#include "service/model/expression.hpp"

namespace reident {

/// An input of the configuration that is computed.
struct DerivedInput {
  std::string name;
  std::string expression;  // over SATCS parameters (expression.hpp)
  std::string unit;
  bool operator==(const DerivedInput&) const = default;
};

/// What is wrong with one key of one derived input.
struct DerivedInputMistake {
  std::size_t index = 0;  // of the derived input
  std::string_view key;   // "name" or "expression"
  std::string message;    // what is wrong and what would mend it
};

/// Returns all that is wrong with `derived` in a model of these inputs and outputs: a name that
/// comes twice, is not among the inputs or is an output's; an expression that cannot be read or
/// uses no parameter, an output, another derived input or its own name. Empty where all is right.
std::vector<DerivedInputMistake> mistakes_in(const std::vector<DerivedInput>& derived,
                                             const std::vector<std::string>& inputs,
                                             const std::vector<std::string>& outputs);

/// A bias that a sensor may have.
struct SensorBias {
  std::string sensor;
  int direction = 0;  // 1: it reads too high; -1: too low; 0: either, by whatever
  int size = 0;       // of `direction`: the exponent of a power of two, modulo bias_sizes

  bool operator==(const SensorBias&) const = default;
};

/// Sizes of a bias of one direction that are looked at.
inline constexpr int bias_sizes = 5;

/// Returns the biases whose effects on the inputs are looked at, in the order of
/// BlockScore::bias_effects: those of derived inputs' sensors first, and each in the order of first
/// use. Where what a bias does to a derived input is no multiple of it, the sensor has all sizes
/// downwards and upwards.
std::vector<SensorBias> biases_of(const std::vector<std::string>& inputs,
                                  const std::vector<DerivedInput>& derived);

/// Returns the size of the bias in the sensor's unit, whose values have this deviation: for a
/// direction a power of two, from a 64th of the deviation to a half. A bias keeps its size as long
/// as that is so, however the deviation changes.
double size_of(const SensorBias& bias, double deviation);

/// Computes the m inputs of a model from the values of q parameters, tick by tick. Not const where
/// it computes, since it keeps room for operands: one thread at a time.
class InputExpressions {
 public:
  /// An input is the derived one of its name, or else the parameter itself. Throws
  /// std::invalid_argument naming an input whose expression is none.
  InputExpressions(const std::vector<std::string>& inputs,
                   const std::vector<DerivedInput>& derived);

  /// The q parameters that the inputs are computed from, each once, in the order of first use; the
  /// inputs themselves where none is derived.
  const std::vector<std::string>& parameters() const { return parameters_; }

  /// Sets `inputs` (m) from the values (q) of parameters(); NaN where a derived one has no finite
  /// value. Requires both vectors to have their sizes. Allocates nothing.
  void evaluate(const identification::Vector& parameters, identification::Vector& inputs);

  /// Returns the input at `place` alone, likewise.
  double evaluate(const identification::Vector& parameters, identification::Index place);

  /// Places of the inputs that are computed from the parameter at this place of parameters().
  std::vector<identification::Index> inputs_of(identification::Index parameter) const;

  /// Whether these are all affine in the parameter.
  bool are_affine_in(identification::Index parameter) const;

  /// Returns the record with the inputs (N x m) in the place of its u (N x q), which holds
  /// parameters(). Rows at which an input has no finite value are left out as holes are: the record
  /// may have fewer rows and more segments. Where no input is derived it comes back as it is.
  identification::Record evaluate(identification::Record record);

 private:
  struct Input {
    std::vector<identification::Index> operands;  // places in parameters_
    std::optional<Expression> expression;         // absent: the one operand itself
    std::vector<double> values;
  };
  /// The parameter's place in parameters_, which gets it where it is new.
  identification::Index place_of(const std::string& parameter);

  std::vector<std::string> parameters_;
  std::vector<Input> inputs_;
  bool any_derived_ = false;
};

}  // namespace reident
