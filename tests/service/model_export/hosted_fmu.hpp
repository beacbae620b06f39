// A version exported as an FMU by FMI 2.0, run by a host next to the library that simulators link.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "tests/service/model_export/export_fixture.hpp"
#include "tests/service/model_export/fmu_host.hpp"

namespace reident::test {

inline std::string fmu_of(const model_export::ExportedVersion& exported) {
  return model_export::fmu_file(exported, model_export::FmiVersion::two, REIDENT_FMU_PARTS);
}

/// All that is needed to run one version.
struct Hosted {
  explicit Hosted(const model_export::ExportedVersion& exported)
      : version(exported.version),
        fmu(fmu_of(exported)),
        binary(fmu.binary()),
        reference(version),
        instance(another()) {}

  std::unique_ptr<FmuInstance> another() const { return another(binary); }
  std::unique_ptr<FmuInstance> another(const FmuBinary& its_binary) const {
    return std::make_unique<FmuInstance>(its_binary, version.digest, fmu.resources(),
                                         reference.variables.inputs.size(),
                                         reference.variables.outputs.size());
  }
  std::vector<double> inputs(Noise& noise) const {
    return random_inputs(noise, reference.variables.inputs.size());
  }

  ModelVersion version;
  UnpackedFmu fmu;
  FmuBinary binary;
  Reference reference;
  std::unique_ptr<FmuInstance> instance;
};

/// The farthest two runs are apart, over the size of what they say.
class Distance {
 public:
  void add(const std::vector<double>& a, const std::vector<double>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double apart = std::fabs(a[i] - b[i]) / std::max(1.0, std::fabs(b[i]));
      if (!(apart <= largest)) largest = apart;
    }
  }
  double largest = 0;
};

inline const ModelKind with_expressions = {
    3, 3, 2, true, 1, {"U * I_2 / V_BUS", "max(abs(U - 1), V_BUS ^ 1.5) * (U > V_BUS ? 2 : -0.5)"}};

/// C x + D (u - u0) + y0
inline std::vector<double> outputs_of(const ModelVersion& version, const identification::Vector& x,
                                      const std::vector<double>& u) {
  const identification::StateSpaceModel& model = version.model.dynamics;
  const Eigen::Map<const identification::Vector> inputs(u.data(), model.inputs());
  const identification::Vector y = model.C * x + model.D * (inputs - model.u0) + model.y0;
  return {y.begin(), y.end()};
}

}  // namespace reident::test
