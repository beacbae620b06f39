#include <cmath>

#include <gtest/gtest.h>

#include "service/satcs/reference/random.hpp"
#include "service/satcs/reference/reference_array.hpp"
#include "service/satcs/reference/reference_battery.hpp"
#include "service/satcs/reference/reference_bdr.hpp"
#include "service/satcs/reference/reference_bus.hpp"
#include "service/satcs/reference/reference_charger.hpp"
#include "service/satcs/reference/reference_converter.hpp"
#include "service/satcs/reference/reference_loads.hpp"

namespace reident::satcs::reference::reference_parts_test {
namespace {

constexpr storage::Time second = 1'000'000'000;
constexpr storage::Time july = 1'498'867'200 * second;  // 2017-07-01T00:00:00Z

TEST(RandomStream, HasTheMomentsOfItsDistributions) {
  RandomStream random(1, 2);
  constexpr int n = 200'000;
  double mean = 0, square = 0, fourth = 0, uniform = 0;
  for (int i = 0; i < n; ++i) {
    const double g = random.gaussian();
    mean += g / n;
    square += g * g / n;
    fourth += g * g * g * g / n;
    uniform += random.uniform() / n;
  }
  EXPECT_NEAR(mean, 0, 0.01);
  EXPECT_NEAR(square, 1, 0.02);
  EXPECT_NEAR(fourth, 3, 0.15);
  EXPECT_NEAR(uniform, 0.5, 0.005);
}

TEST(RandomStream, OfOneSeedAreIndependent) {
  RandomStream a(1, 1), b(1, 2);
  double correlation = 0;
  constexpr int n = 100'000;
  for (int i = 0; i < n; ++i) correlation += a.gaussian() * b.gaussian() / n;
  EXPECT_NEAR(correlation, 0, 0.015);
}

TEST(ReferenceArray, GivesLessBeyondTheKneeAndNothingInTheDark) {
  SolarArray array{ArrayConstants{}};
  EXPECT_EQ(array.string_current(16, 28), 0);
  array.set_sun(1, 1);
  const double flat_A = array.string_current(16, 28);
  EXPECT_NEAR(flat_A, 0.5, 0.01);
  EXPECT_NEAR(array.string_current(16, 20), flat_A, 1e-3);
  EXPECT_LT(array.string_current(16, 41), 0.8 * flat_A);
  EXPECT_EQ(array.string_current(16, 60), 0);
  array.set_sun(0.25, 1);
  EXPECT_NEAR(array.string_current(16, 20), flat_A / 4, 1e-3);
}

TEST(ReferenceArray, SettlesWhereAbsorbedAndEmittedHeatAreEqual) {
  const ArrayConstants c;
  SolarArray array(c);
  array.set_sun(1, 1);
  for (int s = 0; s < 20'000; ++s) array.step(1, 1600);
  const double absorbed =
      c.solar_flux_W_m2 * c.absorptance + c.earth_infrared_W_m2 - 1600 / c.area_m2;
  EXPECT_NEAR(array.temperature_C() + 273.15,
              std::pow(absorbed / (2 * c.emittance * 5.670374e-8), 0.25), 1e-6);
}

TEST(ReferenceBattery, RelaxesWithItsTwoTimeConstants) {
  BatteryConstants c;
  c.initial_soc = 0.5;
  c.capacity_Ah = 1e9;  // charge stays
  c.heat_capacity_J_K = 1e12;
  Battery battery(c, 0.1);
  const double rest_V = battery.open_circuit_V();
  const int steps = static_cast<int>(c.slow_s / 0.1);
  for (int i = 0; i < steps; ++i) battery.step(-10, 0);
  const double expected_V =
      -10 * (c.fast_ohm * (1 - std::exp(-c.slow_s / c.fast_s)) + c.slow_ohm * (1 - std::exp(-1)));
  EXPECT_NEAR(battery.internal_V() - rest_V, expected_V, 1e-6);
}

TEST(ReferenceBattery, GivesConstantPowerAtTheVoltageThatItsResistanceLeaves) {
  const Battery battery(BatteryConstants{}, 0.1);
  const double voltage = battery.terminal_V(3, 400);
  EXPECT_NEAR(voltage, battery.internal_V() + 0.045 * (3 - 400 / voltage), 1e-12);
  EXPECT_EQ(battery.terminal_V(0, 1e9), battery.internal_V() / 2);
}

TEST(ReferenceBattery, ChemicalEnergyIsTheIntegralOfTheOpenCircuitVoltage) {
  BatteryConstants c;
  c.initial_C = 10;
  double sum_J = 0;
  constexpr int pieces = 4000;
  for (int i = 0; i < pieces; ++i) {
    c.initial_soc = 0.9 * (i + 0.5) / pieces;
    sum_J += Battery(c, 1).open_circuit_V() * 3600 * c.capacity_Ah * 0.9 / pieces;
  }
  c.initial_soc = 0.9;
  EXPECT_NEAR(Battery(c, 1).chemical_J(), sum_J, 1e-6 * sum_J);
}

TEST(ReferenceBattery, StoresLessTheFullerItIs) {
  BatteryConstants c;
  double before = 1;
  for (const double soc : {0.2, 0.8, 0.95, 0.98, 0.99, 1.0}) {
    c.initial_soc = soc;
    const double efficiency = Battery(c, 0.1).charge_efficiency();
    EXPECT_LE(efficiency, before) << soc;
    before = efficiency;
  }
  EXPECT_LT(before, 0.3);
  EXPECT_EQ(Battery(c, 0.1).stored_A(-5), -5);
}

TEST(ReferenceBdr, IsLessEfficientAtLowAndAtHighOutput) {
  const DischargeRegulator bdr(DischargeRegulatorConstants{}, 0.05);
  const auto efficiency = [&](double output_A) {
    return 28 * output_A / (28 * output_A + bdr.loss_W(output_A, 50));
  };
  EXPECT_LT(efficiency(1), 0.85);
  EXPECT_GT(efficiency(12), 0.93);
  EXPECT_LT(efficiency(30), efficiency(12));
}

TEST(ReferenceBdr, FullerBatteryGivesMoreAndAnEmptyOneNothing) {
  DischargeRegulator bdr(DischargeRegulatorConstants{}, 0.05);
  for (int i = 0; i < 10'000; ++i) bdr.step({51, 50}, 30);
  const auto both = bdr.share(20, {true, true});
  EXPECT_NEAR(both[0], 20 * 0.56, 1e-6);
  EXPECT_NEAR(both[0] + both[1], 20, 1e-12);
  EXPECT_EQ(bdr.share(20, {false, true}), (DischargeRegulator::Modules{0, 20}));
  EXPECT_EQ(bdr.max_output_A({false, true}), 30);
  EXPECT_EQ(bdr.max_output_A({false, false}), 0);
}

TEST(ReferenceBus, AnswersALoadStepAtOnceAndThenTakesTheErrorOut) {
  const ErrorAmplifierConstants mea;
  Bus bus(BusConstants{}, mea, 0.05);
  const auto run = [&](double load_A, double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / 0.05); ++i) {
      bus.step({.channel_A = {}, .bdr_max_A = 60, .load_A = load_A});
    }
  };
  run(20, 100);
  EXPECT_NEAR(bus.bus_V(), 28, 1e-4);
  const double settled_V = bus.mea_V();
  run(32, 0.2);  // 12 A more are 0.8 V of the amplifier's output and 80 mV of the bus
  EXPECT_NEAR(settled_V - bus.mea_V(), 0.8, 1e-3);
  EXPECT_NEAR(bus.bus_V(), 28 - 0.08, 0.004);
  run(32, mea.integral_s);
  EXPECT_NEAR(bus.bus_V(), 28 - 0.08 * std::exp(-1), 0.004);
}

TEST(ReferenceConverters, LoseTheirIdlePowerAndMoreWithCurrentAndTemperature) {
  const Constants constants;
  Converters converters(constants.converter, constants.converter_plate, 1);
  const double idle_W = constants.converter[logic_line].idle_W;
  EXPECT_EQ(converters.input_W(logic_line, 0), idle_W);
  EXPECT_EQ(converters.output_V(logic_line, 20), 5 - 20 * 2e-3);
  const auto loss_W = [&](double output_A) {
    return converters.input_W(logic_line, output_A) -
           converters.output_V(logic_line, output_A) * output_A;
  };
  EXPECT_GT(loss_W(20), 2 * loss_W(10) - idle_W);
  const double before_W = loss_W(20);
  for (int s = 0; s < 20'000; ++s) converters.step(60);
  EXPECT_NEAR(converters.temperature_C(), 12 + 60 / 2.2, 1e-3);
  EXPECT_GT(loss_W(20), before_W);
}

TEST(ReferenceCharger, LetsLessThroughAboveItsLimitWhichFallsWithTemperature) {
  const ChargerConstants c;
  Charger charger(c, 1);
  EXPECT_NEAR(charger.limit_V(10), c.cells * 1.425, 1e-12);
  EXPECT_LT(charger.limit_V(20), charger.limit_V(10));
  charger.step(charger.limit_V(10) - 1, 10);
  EXPECT_EQ(charger.share(), 1);
  charger.step(charger.limit_V(10) + 1, 10);
  EXPECT_NEAR(charger.share(), 1 - c.gain_per_Vs, 1e-12);
  charger.age(Constants{}.charger[1]);
  charger.step(charger.limit_V(10) + 1, 10);
  EXPECT_NEAR(charger.share(), 1 - c.gain_per_Vs - Constants{}.charger[1].gain_per_Vs, 1e-12);
  EXPECT_EQ(charger.section_V(50, 0), 50);
  EXPECT_NEAR(charger.section_V(50, 6), 50 + 0.6 + 6 * 0.03, 0.02);
}

TEST(ReferenceLoads, CamerasRunInSunlightAndTheTransmitterOverStations) {
  const Orbit orbit{OrbitConstants{}};
  const OperationsPlan plan(orbit, LoadConstants{}, {}, 3);
  int payload_s = 0;
  int beyond_contact_s = 0;
  for (int s = 0; s < 86'400; s += 10) {
    const auto time = july + s * second;
    const auto on = plan.at(time);
    EXPECT_EQ(on.transmitter, orbit.in_contact(time));
    EXPECT_TRUE(!on.payload || orbit.illumination(time) == 1);
    payload_s += on.payload ? 10 : 0;
    beyond_contact_s += on.payload && !on.transmitter ? 10 : 0;
  }
  EXPECT_GT(payload_s, 3600);
  EXPECT_GT(beyond_contact_s, 1200);
}

TEST(ReferenceLoads, PlanIsAFunctionOfTimeAndSeed) {
  const Orbit orbit{OrbitConstants{}};
  const OperationsPlan a(orbit, LoadConstants{}, {}, 3), again(orbit, LoadConstants{}, {}, 3),
      b(orbit, LoadConstants{}, {}, 4);
  int differ = 0;
  for (int s = 0; s < 86'400; s += 10) {
    const auto time = july + s * second;
    EXPECT_EQ(a.at(time).payload, again.at(time).payload);
    differ += a.at(time).payload != b.at(time).payload;
  }
  EXPECT_GT(differ, 60);
}

TEST(ReferenceLoads, HeatersKeepTheBatteryBetweenTheirThresholds) {
  Loads loads(Orbit{OrbitConstants{}}, LoadConstants{}, {}, 1);
  loads.update(july, 1, {4.9, 8});
  EXPECT_TRUE(loads.battery_heater_on(0));
  EXPECT_FALSE(loads.battery_heater_on(1));
  loads.update(july, 1, {6, 6});
  EXPECT_TRUE(loads.battery_heater_on(0));
  EXPECT_FALSE(loads.battery_heater_on(1));
  loads.update(july, 1, {7.1, 4.9});
  EXPECT_FALSE(loads.battery_heater_on(0));
  EXPECT_TRUE(loads.battery_heater_on(1));
  const auto nominal = loads.currents_A(28, {100, 0, 0});
  const auto low = loads.currents_A(25, {100, 0, 0});
  EXPECT_NEAR(nominal[battery_heater_2] * 28, LoadConstants{}.battery_heater_W, 1e-9);
  EXPECT_NEAR(nominal[battery_heater_2] / low[battery_heater_2], 28.0 / 25, 1e-12);
  EXPECT_NEAR(nominal[platform] * 28, low[platform] * 25, 1e-9);
  EXPECT_NEAR(nominal[converter_1] * 28, 100, 1e-9);
}

}  // namespace
}  // namespace reident::satcs::reference::reference_parts_test
