// The relations of REFERENCE.md between readings, second by second.
#include <cmath>
#include <limits>
#include <map>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/reference/reference_spacecraft.hpp"

namespace reident::satcs::reference::reference_relations_test {
namespace {

struct Relation {
  std::vector<std::pair<double, std::string_view>> terms;  // their sum is about 0
  double tolerance;
};

const std::vector<Relation> relations{
    {{{1, "I_SG2"}, {1, "I_BDROUT"}, {-1, "I_BUS"}}, 0.45},
    {{{1, "I_BUS"}, {-1, "I_DIST"}}, 0.45},
    {{{1, "I_SAG2"}, {-1, "I_SG2"}, {-1, "I_SHUNT"}}, 0.45},
    {{{1, "I_DIST"},
      {-1, "I_PF"},
      {-1, "I_TX"},
      {-1, "I_HTR"},
      {-1, "I_DC1IN"},
      {-1, "I_DC2IN"},
      {-1, "I_DC3IN"}},
     0.4},
    {{{1, "I_HTR"}, {-1, "I_EH"}, {-1, "I_BH1"}, {-1, "I_BH2"}}, 0.15},
    {{{1, "I_SGBCHC"}, {-1, "I_BDRIN1"}, {-1, "I_BAT1"}}, 0.8},
    {{{1, "I_SGBCHC2"}, {-1, "I_BDRIN2"}, {-1, "I_BAT2"}}, 0.8},
    {{{1, "I_SAG1A"}, {-1, "I_SGBCHC"}, {-1, "I_CSH1"}}, 0.13},
    {{{1, "I_SAG1B"}, {-1, "I_SGBCHC2"}, {-1, "I_CSH2"}}, 0.13},
    {{{1, "V_BAT1"}, {-1, "V_CHC1"}}, 0.5},
    {{{1, "V_BAT1"}, {-1, "V_BDRIN1"}}, 0.5},
    {{{1, "V_BAT2"}, {-1, "V_CHC2"}}, 0.5},
    {{{1, "V_BAT2"}, {-1, "V_BDRIN2"}}, 0.5},
    {{{1, "V_BUS"}, {-1, "V_BUSD"}, {-0.004, "I_DIST"}}, 0.04},
    {{{1, "V_MEA"}, {-1, "V_MEAB"}}, 0.1},
    {{{1, "I_DC1OUT"}, {-1, "I_SD1"}}, 0.15},
    {{{1, "I_DC2OUT"}, {-1, "I_SD2"}}, 0.15},
    {{{1, "I_DC3OUT"}, {-1, "I_SD3"}}, 0.15},
    {{{1, "T_BAT1"}, {-1, "T_BAT1B"}}, 0.45},
    {{{1, "T_BAT2"}, {-1, "T_BAT2B"}}, 0.45},
    {{{1, "T_BDR"}, {-1, "T_BDRB"}}, 0.6},
    {{{1, "T_DCC"}, {-1, "T_DCCB"}}, 0.6},
};

TEST(ReferenceRelations, HoldBetweenTheLastSamplesInEverySecond) {
  Spacecraft spacecraft(Constants{}, {}, 1'498'867'200'000'000'000, 5);
  std::map<std::uint32_t, double> last;
  for (const TelemetryPoint& point : telemetry_points())
    last[parameter_id(point.name)] = std::numeric_limits<double>::quiet_NaN();
  std::vector<storage::Sample> samples;
  constexpr int two_orbits = 2 * 6016;
  for (int s = 0; s < two_orbits; ++s, spacecraft.advance()) {
    spacecraft.read(samples);
    for (const storage::Sample& sample : samples) last[sample.parameter] = sample.value;
    if (s < 32) continue;  // until every point was sampled
    for (const Relation& relation : relations) {
      double sum = 0;
      for (const auto& [factor, name] : relation.terms) sum += factor * last.at(parameter_id(name));
      ASSERT_LT(std::abs(sum), relation.tolerance) << relation.terms.front().second << " at " << s;
    }
  }
}

}  // namespace
}  // namespace reident::satcs::reference::reference_relations_test
