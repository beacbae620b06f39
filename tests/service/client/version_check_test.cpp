#include "service/client/version_check.hpp"

#include <functional>
#include <limits>

#include <gmock/gmock.h>

#include "identification/correction/integral_feedback_search.hpp"
#include "tests/service/model/example_model.hpp"

namespace reident::test::version_check_test {
namespace {

struct Case {
  const char* name;
  std::function<void(ModelVersion&)> change;
  bool signed_again;  // the digest is computed after the change
  const char* says;
};
void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

identification::TrackingGain& gain(ModelVersion& version) {
  const identification::Poles poles = {0.5, 0.6, 0.7, 0.8};
  const auto placed = identification::place_tracking_poles(version.model.dynamics, poles,
                                                           identification::Vector::Constant(1, 10));
  const auto& gain = std::get<identification::TrackingPlacement>(placed).gain;
  version.model.tracking = EquipmentModel::Tracking{gain, version.model.validation};
  return version.model.tracking->gain;
}

class DamagedVersion : public testing::TestWithParam<Case> {};

TEST_P(DamagedVersion, IsToldWithTheReason) {
  ModelVersion version = example_version(1);
  GetParam().change(version);
  if (GetParam().signed_again) version.digest = model_digest(version.model);
  EXPECT_THAT(damage(version).value_or("sound"), testing::HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    table, DamagedVersion,
    testing::Values(
        Case{"sound", [](auto&) {}, false, "sound"},
        Case{"one bit", [](auto& v) { v.model.dynamics.A(0, 0) += 1e-16; }, false, "digest"},
        Case{"renamed input", [](auto& v) { v.model.inputs[0].name = "I_BDRIN9"; }, false,
             "digest"},
        Case{"unstable", [](auto& v) { v.model.dynamics.A(0, 0) = 1.2; }, true, "spectral radius"},
        Case{"integrator",
             [](auto& v) { v.model.dynamics.A = identification::Matrix::Identity(2, 2); }, true,
             "spectral radius"},
        Case{"not finite",
             [](auto& v) { v.model.dynamics.D(0, 0) = std::numeric_limits<double>::quiet_NaN(); },
             true, "finite"},
        Case{"missing column", [](auto& v) { v.model.dynamics.B.conservativeResize(2, 1); }, true,
             "fit together"},
        Case{"missing input", [](auto& v) { v.model.inputs.pop_back(); }, true, "fit together"},
        Case{"expression", [](auto& v) { v.model.inputs[0].expression = "a * b"; }, true, "sound"},
        Case{"no expression", [](auto& v) { v.model.inputs[0].expression = "a *"; }, true,
             "input I_BDRIN1 cannot be computed: at byte 4"},
        Case{"tracking", [](auto& v) { gain(v); }, true, "sound"},
        Case{"tracking changed", [](auto& v) { gain(v); }, false, "digest"},
        Case{"state gain", [](auto& v) { gain(v).state.resize(2, 1); }, true, "tracking gain"},
        Case{"integral gain", [](auto& v) { gain(v).integral.resize(2, 1); }, true,
             "tracking gain"},
        Case{"error limit", [](auto& v) { gain(v).error_limit.resize(0); }, true, "tracking gain"},
        Case{"gain turned round", [](auto& v) { gain(v).integral *= -1; }, true, "stabilise"},
        Case{"gain not finite",
             [](auto& v) { gain(v).integral(0, 0) = std::numeric_limits<double>::infinity(); },
             true, "tracking gain"},
        Case{"no period", [](auto& v) { v.model.dynamics.period_s = 0; }, true, "fit together"}));

TEST(Succession, FollowsTheNumberAndLetsARollbackGoBack) {
  const ModelVersion running = example_version(5);
  EXPECT_EQ(succession(example_version(6), running), Succession::newer);
  EXPECT_EQ(succession(example_version(5), running), Succession::same);
  EXPECT_EQ(succession(example_version(4), running), Succession::older);
  ModelVersion back = example_version(3);
  back.rollback = true;
  EXPECT_EQ(succession(back, running), Succession::newer);
  ModelVersion other = example_version(5);
  other.model.dynamics.D(0, 0) = 9;
  other.digest = model_digest(other.model);
  EXPECT_EQ(succession(other, running), Succession::different);
}

}  // namespace
}  // namespace reident::test::version_check_test
