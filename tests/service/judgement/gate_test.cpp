#include "service/judgement/gate.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace reident::test::gate_test {
namespace {

using Code = ReasonCode;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

struct Case {
  const char* name;
  void (*change)(Evidence&);
  std::optional<Code> reason;
};

const Case cases[] = {
    {"good", [](Evidence&) {}, std::nullopt},
    {"sizes_that_disagree", [](Evidence& e) { e.well_formed = false; }, Code::not_finite},
    {"an_error_that_is_no_number", [](Evidence& e) { e.mrse_percent = not_a_number; },
     Code::not_finite},
    {"unstable", [](Evidence& e) { e.spectral_radius = 1; }, Code::unstable},
    {"an_integrator", [](Evidence& e) { e.slowest_over_window = 1.01; }, Code::slower_than_window},
    {"as_slow_as_the_window", [](Evidence& e) { e.slowest_over_window = 1; }, std::nullopt},
    {"above_the_limit", [](Evidence& e) { e.mrse_percent = 20.01; }, Code::error_above_limit},
    {"the_mean", [](Evidence& e) { e.fit_percent = 0; }, Code::not_better_than_mean},
    {"an_output_that_stands_still",
     [](Evidence& e) {
       e.still_output = "y";
       e.mrse_percent = std::numeric_limits<double>::infinity();
     },
     Code::still_validation},
};

class Candidate : public testing::TestWithParam<Case> {};

TEST_P(Candidate, IsAdmissibleOrNot) {
  Evidence evidence{true, 0.99, 0.5, 5, 60, {}};
  GetParam().change(evidence);
  const auto reason = inadmissible(evidence, {});
  EXPECT_EQ(reason ? std::optional(reason->code) : std::nullopt, GetParam().reason);
}

INSTANTIATE_TEST_SUITE_P(Gate, Candidate, testing::ValuesIn(cases),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace reident::test::gate_test
