#include "service/satcs/reference/reference_orbit.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace reident::satcs::reference::reference_orbit_test {
namespace {

constexpr storage::Time second = 1'000'000'000;
constexpr storage::Time hour = 3600 * second;
constexpr storage::Time day = 24 * hour;
constexpr storage::Time july = 1'498'867'200 * second;  // 2017-07-01T00:00:00Z
constexpr double degree = std::numbers::pi / 180;

/// The share of an orbit in the shadow of a sphere under parallel light.
double cylindrical_eclipse_fraction(const OrbitConstants& c, double beta) {
  const double ratio = c.earth_radius_km / c.semi_major_axis_km;
  return std::acos(std::sqrt(1 - ratio * ratio) / std::cos(beta)) / std::numbers::pi;
}

TEST(ReferenceOrbit, EclipseLastsAsLongAsTheGeometrySays) {
  const OrbitConstants constants;
  const Orbit orbit(constants);
  double dark_s = 0;
  constexpr int orbits = 14;
  const auto span_s = static_cast<int>(orbits * constants.period_s);
  for (int s = 0; s < span_s; ++s) dark_s += 1 - orbit.illumination(july + s * second);
  const double expected = cylindrical_eclipse_fraction(constants, orbit.beta(july + day / 2));
  EXPECT_NEAR(dark_s / span_s, expected, 0.0005);
  EXPECT_NEAR(dark_s / orbits / 60, 34, 1);  // minutes, at this height
}

TEST(ReferenceOrbit, EclipsesRepeatWithThePeriod) {
  const Orbit orbit{OrbitConstants{}};
  std::vector<storage::Time> entries;
  double before = orbit.illumination(july);
  for (int s = 1; s < 86'400; ++s) {
    const double now = orbit.illumination(july + s * second);
    if (before >= 0.5 && now < 0.5) entries.push_back(july + s * second);
    before = now;
  }
  ASSERT_GE(entries.size(), 14U);
  const double period_s = static_cast<double>(entries.back() - entries.front()) * 1e-9 /
                          static_cast<double>(entries.size() - 1);
  EXPECT_NEAR(period_s, 100.26 * 60, 0.5);  // entries are seen to the second
}

TEST(ReferenceOrbit, PenumbraIsAShortSmoothRamp) {
  const Orbit orbit{OrbitConstants{}};
  int partial = 0;
  double before = orbit.illumination(july);
  for (int tenth = 1; tenth < 60'200; ++tenth) {
    const double now = orbit.illumination(july + tenth * second / 10);
    ASSERT_GE(now, 0);
    ASSERT_LE(now, 1);
    EXPECT_LT(std::abs(now - before), 0.02);
    if (now > 0 && now < 1) ++partial;
    before = now;
  }
  // One entry and one exit: the Sun's disc of 0.53 degrees at 0.06 degrees a second, aslant.
  EXPECT_GT(partial, 2 * 85);
  EXPECT_LT(partial, 2 * 130);
}

TEST(ReferenceOrbit, BetaGoesThroughTheYear) {
  const Orbit orbit{OrbitConstants{}};
  double least = 90 * degree;
  double most = -90 * degree;
  for (int d = 0; d < 366; ++d) {
    const double beta = orbit.beta(july + d * day);
    least = std::min(least, beta);
    most = std::max(most, beta);
  }
  // 22.5 degrees from noon at the equinox, less and more at the solstices.
  EXPECT_GT(least, 10 * degree);
  EXPECT_LT(least, 20 * degree);
  EXPECT_GT(most, 22 * degree);
  EXPECT_LT(most, 32 * degree);
}

TEST(ReferenceOrbit, SunIsNearestInJanuary) {
  const Orbit orbit{OrbitConstants{}};
  EXPECT_NEAR(orbit.relative_flux(july + 3 * day), 0.967, 0.001);    // aphelion
  EXPECT_NEAR(orbit.relative_flux(july + 186 * day), 1.034, 0.001);  // perihelion
}

TEST(ReferenceOrbit, StationsSeeItForMinutesAFewTimesADay) {
  const Orbit orbit{OrbitConstants{}};
  std::vector<int> passes_s;
  bool before = true;
  for (int s = 0; s < 3 * 86'400; s += 5) {
    const bool contact = orbit.in_contact(july + s * second);
    if (contact && !before) passes_s.push_back(0);
    if (contact && !passes_s.empty()) passes_s.back() += 5;
    before = contact;
  }
  EXPECT_GE(passes_s.size(), 3 * 6U);
  EXPECT_LE(passes_s.size(), 3 * 25U);
  for (const int pass_s : passes_s) EXPECT_LE(pass_s, 25 * 60);  // neighbours may hand over
}

TEST(ReferenceOrbit, NoonIsInTheMiddleOfTheSunlitPart) {
  const Orbit orbit{OrbitConstants{}};
  const double noon = orbit.noon_phase(july);
  const auto at_phase = [&](double phase) {
    const auto count = orbit.count(july);
    return july + static_cast<storage::Time>((phase - count.phase) * orbit.period_s() * 1e9);
  };
  EXPECT_EQ(orbit.illumination(at_phase(noon)), 1);
  EXPECT_EQ(orbit.illumination(at_phase(noon + 0.5)), 0);
  EXPECT_EQ(orbit.illumination(at_phase(noon + 0.3)), 1);
  EXPECT_EQ(orbit.illumination(at_phase(noon - 0.3)), 1);
}

}  // namespace
}  // namespace reident::satcs::reference::reference_orbit_test
