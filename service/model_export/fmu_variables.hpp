// The variables of a model's FMU, in the order of their value references, from 0: inputs, outputs,
// states, and the time.
#pragma once

#include <string>
#include <vector>

#include "service/model/model_version.hpp"

namespace reident::model_export {

/// One variable, a real number.
struct FmuVariable {
  std::string name;
  std::string unit;  // empty where a version does not say it
  std::string description;
  double start = 0;  // of an input or a state, before it was set
};

/// All variables of one FMU.
struct FmuVariables {
  /// The SATCS parameters that the model's inputs are computed from. A parameter that stands in
  /// expressions alone starts at 1: a version keeps the operating point of inputs, not of what they
  /// are computed from.
  std::vector<FmuVariable> inputs;
  std::vector<FmuVariable> outputs;
  std::vector<FmuVariable> states;  // x, in its order
  std::string time;                 // its name
  /// For each output, places in `inputs` of those that it follows at once (by D), ascending.
  std::vector<std::vector<std::size_t>> direct;
  /// For each output, places in `states` of those that it shows (by C), ascending.
  std::vector<std::vector<std::size_t>> shown;
};

/// Returns the variables of a model without obstacle(). Parameters come in the order of first use.
/// `x0` (n) is where the states start; empty: at 0.
FmuVariables fmu_variables(const EquipmentModel& model, const identification::Vector& x0 = {});

/// Returns the place of a parameter in `inputs`. Throws std::logic_error where it is not one of
/// them.
std::size_t place_of(const std::vector<FmuVariable>& inputs, const std::string& parameter);

}  // namespace reident::model_export
