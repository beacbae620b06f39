// Writes example versions in every form, with a run of each, for programs that are not ours:
//   write_exports FOLDER
// leaves NAME.fmu, NAME.fmu3, NAME.mat, NAME.json and NAME.run.json (parameters, model inputs and
// outputs of 300 ticks) for NAME plain and derived.
#include <fstream>

#include "tests/service/model_export/export_fixture.hpp"

namespace {

using namespace reident;
using namespace reident::test;

void write(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

void add_tracking(ModelVersion& version) {
  const identification::StateSpaceModel& dynamics = version.model.dynamics;
  EquipmentModel::Tracking& tracking = version.model.tracking.emplace();
  Noise noise(77);
  tracking.gain.state = noise.normal(dynamics.inputs(), dynamics.order());
  tracking.gain.integral = noise.normal(dynamics.inputs(), 2 * dynamics.outputs());
  tracking.gain.error_limit = noise.normal(dynamics.outputs(), 1);
  tracking.validation = version.model.validation;
  version.digest = model_digest(version.model);
}

nlohmann::json run_of(const ModelVersion& version) {
  Reference reference(version);
  InputExpressions expressions(signal_names(version.model.inputs),
                               derived_inputs(version.model.inputs));
  Noise noise(5);
  nlohmann::json run;
  identification::Vector inputs(version.model.dynamics.inputs());
  for (int k = 0; k < 300; ++k) {
    const std::vector<double> parameters = random_inputs(noise, reference.variables.inputs.size());
    expressions.evaluate(
        Eigen::Map<const identification::Vector>(
            parameters.data(), static_cast<identification::Index>(parameters.size())),
        inputs);
    run["parameters"].push_back(parameters);
    run["inputs"].push_back(std::vector<double>(inputs.begin(), inputs.end()));
    run["outputs"].push_back(reference.step(parameters));
  }
  return run;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  auto plain = random_version({6, 4, 2}, 21);
  plain.version.model.inputs[1].unit = "°C";
  plain.version.model.inputs[2].unit = "";
  plain.version.model.inputs[3].unit = "counts & <more>";
  add_tracking(plain.version);
  auto derived = random_version({3, 2, 1, true, 0.1, {"U * I_1 / (1 + abs(V_BUS))"}}, 22);
  derived.version.model.dynamics.K.resize(0, 0);
  derived.version.digest = model_digest(derived.version.model);
  for (const auto& [name, exported] : {std::pair("plain", plain), std::pair("derived", derived)}) {
    const std::string path = std::string(argv[1]) + "/" + name;
    using model_export::FmiVersion;
    write(path + ".fmu", model_export::fmu_file(exported, FmiVersion::two, REIDENT_FMU_PARTS));
    write(path + ".fmu3", model_export::fmu_file(exported, FmiVersion::three, REIDENT_FMU_PARTS));
    write(path + ".mat", model_export::mat_file(exported));
    write(path + ".json", model_export::json_file(exported));
    write(path + ".run.json", run_of(exported.version).dump());
  }
}
