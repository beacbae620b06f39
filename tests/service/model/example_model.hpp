// A small, well-behaved model of two inputs and one output, with its version and digest.
#pragma once

#include "service/model/model_json.hpp"

namespace reident::test {

inline EquipmentModel example_model() {
  EquipmentModel model;
  model.spacecraft = "CBERS4";
  model.equipment = "BDR";
  model.inputs = {{"I_BDRIN1", "A", 0, 5}, {"I_BDRIN2", "A", -0.25, 4}};
  model.outputs = {{"I_BDROUT", "A", 0, 10}};
  identification::StateSpaceModel& dynamics = model.dynamics;
  dynamics.A = (identification::Matrix(2, 2) << 0.9, 0.1, -0.2, 0.7).finished();
  dynamics.B = (identification::Matrix(2, 2) << 0.5, 0.25, 0.125, 1.0 / 3).finished();
  dynamics.C = (identification::Matrix(1, 2) << 1, -0.5).finished();
  dynamics.D = (identification::Matrix(1, 2) << 0.1, 0).finished();
  dynamics.K = (identification::Matrix(2, 1) << 0.3, 0.2).finished();
  dynamics.u0 = (identification::Vector(2) << 2.5, 1.5).finished();
  dynamics.y0 = identification::Vector::Constant(1, 4.25);
  dynamics.period_s = 1;
  model.sample_hold_ns = 3'000'000'000;
  model.identified_from = {1'000, 5'000};
  model.validated_on = {5'000, 7'000};
  model.validation.mrse_percent = identification::Vector::Constant(1, 6.9);
  model.validation.fit_percent = identification::Vector::Constant(1, 81.5);
  model.validation.rows = 2000;
  model.method = "N4SID, horizon 12, order 2";
  return model;
}

/// example_model() with all that not every model has: a computed input and a tracking gain.
inline EquipmentModel full_example_model() {
  EquipmentModel model = example_model();
  model.inputs[1] = {"P_IN", "W", -0.25, 4, "V_BUS * I_BDRIN2"};
  EquipmentModel::Tracking& tracking = model.tracking.emplace();
  tracking.gain.state = (identification::Matrix(2, 2) << 0.5, -1, 1.0 / 3, 0).finished();
  tracking.gain.integral = (identification::Matrix(2, 2) << 0.1, 0.2, -0.3, 0.7).finished();
  tracking.gain.error_limit = identification::Vector::Constant(1, 2.5);
  tracking.validation.mrse_percent = identification::Vector::Constant(1, 0.5);
  tracking.validation.fit_percent = identification::Vector::Constant(1, 99);
  tracking.validation.rows = 2000;
  return model;
}

inline ModelVersion example_version(std::int64_t number) {
  ModelVersion version;
  version.model = example_model();
  version.number = number;
  version.digest = model_digest(version.model);
  version.decided = 42;
  version.decided_by = "gate";
  version.program_version = "0.1.0";
  return version;
}

}  // namespace reident::test
