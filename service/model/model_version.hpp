// A published model: the state-space model with all that a simulator or an operator asks of it.
// What JSON, the digest and files have of it follows from model_fields.hpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "identification/simulation/integral_feedback.hpp"
#include "identification/simulation/scores.hpp"
#include "identification/simulation/state_space.hpp"
#include "service/model/derived_inputs.hpp"
#include "storage/types/telemetry.hpp"

namespace reident {

/// One input or output of a model, in the model's order.
struct Signal {
  std::string name;  // SATCS parameter, or what `expression` computes
  std::string unit;  // as telemetry describes it; of a computed input, as the configuration does
  double low = 0;    // range visited in the identification window
  double high = 0;
  /// How an input follows from SATCS parameters; empty where it is the parameter `name` itself.
  std::string expression = {};
  bool operator==(const Signal&) const = default;
};

/// Returns the names, in the order of the signals.
inline std::vector<std::string> signal_names(const std::vector<Signal>& signals) {
  std::vector<std::string> names;
  names.reserve(signals.size());
  for (const Signal& signal : signals) names.push_back(signal.name);
  return names;
}

/// Returns the signals with the ranges of their samples (N x signals, N at least 1, finite).
inline std::vector<Signal> with_ranges(std::vector<Signal> signals,
                                       const identification::Matrix& samples) {
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const auto column = samples.col(static_cast<identification::Index>(i));
    signals[i].low = column.minCoeff();
    signals[i].high = column.maxCoeff();
  }
  return signals;
}

/// Whether any of them follows from parameters by an expression.
inline bool has_expressions(const std::vector<Signal>& signals) {
  return std::any_of(signals.begin(), signals.end(),
                     [](const Signal& signal) { return !signal.expression.empty(); });
}

/// Returns those that follow from parameters, in their order.
inline std::vector<DerivedInput> derived_inputs(const std::vector<Signal>& inputs) {
  std::vector<DerivedInput> derived;
  for (const Signal& input : inputs) {
    if (!input.expression.empty()) derived.push_back({input.name, input.expression, input.unit});
  }
  return derived;
}

/// What is identified, stored as JSON and digested; it says nothing about when it was approved. A
/// value: a copy is another model, and none is changed once it was recorded.
struct EquipmentModel {
  std::string spacecraft;
  std::string equipment;
  std::vector<Signal> inputs;   // m, in the order of u
  std::vector<Signal> outputs;  // p, in the order of y
  identification::StateSpaceModel dynamics;
  std::int64_t sample_hold_ns = 0;     // a sample of an input or output serves this long
  storage::TimeRange identified_from;  // times of the rows that were identified from
  storage::TimeRange validated_on;     // times of the rows that nothing was chosen on
  identification::Score validation;    // free run on samples that the identification did not use
  struct Tracking {
    identification::TrackingGain gain;
    identification::Score validation;  // corrected by the gain, on the same samples
  };
  std::optional<Tracking> tracking;  // absent where no gain helped, or none was looked for
  std::string method;                // such as "N4SID, horizon 12, order 3"
  /// A tick has the values that are known so long after it; absent: at it. Below the period.
  std::optional<std::int64_t> phase_ns{};
};

/// Whether the dynamics are well formed and have as many inputs and outputs as are named.
inline bool is_well_formed(const EquipmentModel& model) {
  const identification::StateSpaceModel& dynamics = model.dynamics;
  return identification::is_well_formed(dynamics) &&
         dynamics.inputs() == static_cast<identification::Index>(model.inputs.size()) &&
         dynamics.outputs() == static_cast<identification::Index>(model.outputs.size());
}

/// A version as simulators receive it. Number and digest identify it, for one equipment.
struct ModelVersion {
  EquipmentModel model;
  std::int64_t number = 0;    // counts the versions of one equipment from 1
  std::string digest;         // model_digest(model)
  storage::Time decided = 0;  // UTC
  std::string decided_by;     // "gate" or an operator's name
  bool rollback = false;      // an older version on purpose
  std::string program_version;
};

}  // namespace reident
