// Seeded models with an equipment's signals around them, and runs of them to compare with.
#pragma once

#include "service/client/model_runner.hpp"
#include "service/model/model_json.hpp"
#include "service/model_export/fmu_variables.hpp"
#include "service/model_export/model_export.hpp"
#include "tests/support/systems.hpp"

namespace reident::test {

/// Numbers in [-0.5, 0.5) that are the same everywhere.
using test::Noise;

struct ModelKind {
  int order, inputs, outputs;
  bool direct = true;  // D is not 0
  double period_s = 1;
  std::vector<std::string> expressions = {};  // of the first inputs
};

inline model_export::ExportedVersion random_version(const ModelKind& kind, std::uint64_t seed) {
  Noise noise(seed);
  model_export::ExportedVersion exported;
  exported.status = "approved";
  ModelVersion& version = exported.version;
  EquipmentModel& model = version.model;
  model.spacecraft = "CBERS-4";
  model.equipment = "BAT 1";
  model.dynamics = test::random_system(noise, kind.order, kind.inputs, kind.outputs);
  model.dynamics.period_s = kind.period_s;
  if (!kind.direct) model.dynamics.D.setZero();
  model.dynamics.u0 = noise.normal(kind.inputs, 1);
  model.dynamics.y0 = noise.normal(kind.outputs, 1) * 10;
  model.dynamics.K = noise.normal(kind.order, kind.outputs);
  for (int i = 0; i < kind.inputs; ++i) {
    const auto at = static_cast<std::size_t>(i);
    model.inputs.push_back({"I_" + std::to_string(i), "A", -3, 3});
    if (at < kind.expressions.size()) {
      model.inputs[at].name = "P_" + std::to_string(i);
      model.inputs[at].unit = "W";
      model.inputs[at].expression = kind.expressions[at];
    }
  }
  for (int q = 0; q < kind.outputs; ++q)
    model.outputs.push_back({"V_" + std::to_string(q), "mV", -30, 30});
  const auto scores = identification::Vector::Constant(kind.outputs, 2.5);
  model.validation = {scores, scores, 100};
  model.method = "N4SID, horizon 12";
  version.number = 7;
  version.digest = model_digest(model);
  version.decided = 1'700'000'000'000'000'000;
  version.decided_by = "gate";
  version.program_version = "0.1.0";
  return exported;
}

/// The version as the library of simulators runs it, fed with the FMU's inputs.
class Reference {
 public:
  explicit Reference(const ModelVersion& version)
      : variables(model_export::fmu_variables(version.model)),
        declaration_(declared(variables)),
        runner_(declaration_),
        y_(variables.outputs.size()) {
    auto made = PreparedModel::make(version, declaration_);
    auto prepared = std::get<std::unique_ptr<PreparedModel>>(std::move(made));
    runner_.swap(prepared);
  }

  const std::vector<double>& step(const std::vector<double>& inputs) {
    runner_.step(inputs.data(), y_.data());
    return y_;
  }

  const model_export::FmuVariables variables;

 private:
  static Declaration declared(const model_export::FmuVariables& variables) {
    Declaration declaration;
    for (const auto& input : variables.inputs) declaration.inputs.push_back({input.name, ""});
    for (const auto& output : variables.outputs) declaration.outputs.push_back({output.name, ""});
    return declaration;
  }

  Declaration declaration_;
  ModelRunner runner_;
  std::vector<double> y_;
};

inline std::vector<double> random_inputs(Noise& noise, std::size_t count) {
  std::vector<double> values(count);
  for (double& value : values) value = 2 + noise.normal();
  return values;
}

}  // namespace reident::test
