#include "service/satcs/platform/thermal_network.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "service/satcs/platform/sunlight.hpp"

namespace reident::satcs::platform::thermal_network_test {
namespace {

constexpr double stefan_boltzmann = 5.670374e-8;  // [W/m2K4]

TEST(ThermalNetwork, KeepsTheHeatThatItTakesUpAndDoesNotEmit) {
  ThermalNetwork network({}, 0.25);
  NodeValues heat_W{};
  heat_W[deck] = 200;
  heat_W[tank] = 20;
  for (int k = 0; k < 20'000; ++k) {
    const double before = network.stored_J();
    network.step(heat_W);
    ASSERT_NEAR(network.stored_J() - before, 0.25 * (220 - network.emitted_W()), 1e-7);
  }
}

TEST(ThermalNetwork, SettlesWhereAPanelEmitsWhatItTakesUp) {
  ThermalConstants alone;
  for (LinkConstants& link : alone.link) link.conductance_W_K = 0;
  ThermalNetwork network(alone, 1);
  NodeValues heat_W{};
  heat_W[space_panel] = 150;
  for (int k = 0; k < 100'000; ++k) network.step(heat_W);
  const PanelConstants& panel = alone.panel[space_panel];
  const double kelvin = std::pow(150 / (stefan_boltzmann * panel.area_m2 * panel.emittance), 0.25);
  EXPECT_NEAR(network.temperature_C(space_panel), kelvin - 273.15, 1e-6);
}

TEST(ThermalNetwork, LeadsHeatFromTheWarmerToTheColderNode) {
  ThermalConstants pair;
  for (LinkConstants& link : pair.link) link.conductance_W_K = 0;
  pair.link[amplifier_link].conductance_W_K = 3.5;
  pair.initial_C[amplifier_case] = 40;
  pair.initial_C[transmitter_plate] = 0;
  ThermalNetwork network(pair, 0.25);
  for (int k = 0; k < 40'000; ++k) network.step({});
  const double mixed =
      40 * pair.heat_capacity_J_K[amplifier_case] /
      (pair.heat_capacity_J_K[amplifier_case] + pair.heat_capacity_J_K[transmitter_plate]);
  EXPECT_NEAR(network.temperature_C(amplifier_case), mixed, 1e-6);
  EXPECT_NEAR(network.temperature_C(transmitter_plate), mixed, 1e-6);
}

TEST(Sunlight, LightsThePanelsThatLookAtTheSunAndNoneInEclipse) {
  const reference::Orbit orbit{reference::OrbitConstants{}};
  constexpr storage::Time start = 1'498'867'200'000'000'000;
  double zenith = 0, nadir = 0, dark = 0;
  for (int s = 0; s < 6016; ++s) {
    const Sunlight light = sunlight_at(orbit, {}, start + s * storage::second_ns);
    EXPECT_EQ(light.direct[space_panel], 0);
    EXPECT_TRUE(light.direct[zenith_panel] == 0 || light.direct[nadir_panel] == 0);
    double squares = 0;
    for (const double direct : light.direct) squares += direct * direct;
    EXPECT_LE(std::sqrt(squares), light.flux + 1e-12);
    if (light.illumination == 0) {
      EXPECT_EQ(squares, 0);
    }
    zenith += light.direct[zenith_panel];
    nadir += light.direct[nadir_panel];
    dark += light.illumination == 0;
  }
  EXPECT_GT(zenith, 3 * nadir);  // most of what the nadir panel would see is in the Earth's shadow
  EXPECT_GT(dark, 1500);
  EXPECT_LT(dark, 2300);
}

}  // namespace
}  // namespace reident::satcs::platform::thermal_network_test
