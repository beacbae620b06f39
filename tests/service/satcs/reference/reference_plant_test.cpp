#include "service/satcs/reference/reference_plant.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

namespace reident::satcs::reference::reference_plant_test {
namespace {

constexpr storage::Time second = 1'000'000'000;
constexpr storage::Time july = 1'498'867'200 * second;  // 2017-07-01T00:00:00Z
constexpr int two_orbits = 2 * 6016;                    // [s]

template <class Check>
void run(Plant& plant, int seconds, const Check& check) {
  for (int step = 0; step < seconds * Plant::usual_steps_per_second && !testing::Test::HasFailure();
       ++step) {
    plant.step();
    check(plant.flows());
  }
}

double sum(const auto& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(ReferencePlant, CurrentsBalanceAtEveryNode) {
  constexpr double rounding_A = 1e-12;  // of sums up to 100 A
  Plant plant(Constants{}, {}, july, 1);
  run(plant, two_orbits, [&](const Flows& f) {
    EXPECT_NEAR(f.sg2_A + f.shunt_A, f.array_A, rounding_A);
    EXPECT_NEAR(f.sg2_A + f.bdr_out_A, f.bus_A, rounding_A);
    EXPECT_NEAR(f.distributor_A + f.capacitor_A, f.bus_A, rounding_A);
    EXPECT_NEAR(sum(f.load_A), f.distributor_A, rounding_A);
    EXPECT_NEAR(sum(f.bdr_module_A), f.bdr_out_A, rounding_A);
    for (std::size_t k = 0; k < battery_count; ++k) {
      EXPECT_NEAR(f.charge_A[k] + f.section_shunt_A[k], f.section_A[k], rounding_A);
      EXPECT_NEAR(f.battery_A[k] + f.bdr_in_A[k], f.charge_A[k], rounding_A);
    }
  });
}

TEST(ReferencePlant, ArraysPowerIsUsedLostOrStoredInEveryStep) {
  Plant plant(Constants{}, {}, july, 2);
  run(plant, two_orbits, [&](const Flows& f) {
    const PowerBalance p = plant.power_balance();
    EXPECT_NEAR(p.array, p.use() + p.losses() + p.stored(), 1e-9);  // of 2 kW
    for (const double loss :
         {p.blocking_diodes, p.shunt_switches, p.chargers, p.discharge_regulators, p.harness,
          p.converters, p.capacitor_resistance}) {
      EXPECT_GE(loss, -1e-12);
    }
    EXPECT_NEAR(sum(f.bdr_loss_W) + f.bus_V * f.bdr_out_A,
                f.battery_V[0] * f.bdr_in_A[0] + f.battery_V[1] * f.bdr_in_A[1], 1e-9);
  });
}

TEST(ReferencePlant, EnergyOfOrbitsIsThatOfTheStates) {
  const Constants constants;
  Plant plant(constants, {}, july, 2);
  const auto stored_J = [&] {
    const double bus_V = plant.flows().bus_V;
    return constants.bus.capacitance_F * bus_V * bus_V / 2 + plant.battery(0).chemical_J() +
           plant.battery(1).chemical_J();
  };
  const double begin_J = stored_J();
  double array_J = 0, use_J = 0, losses_J = 0;
  run(plant, 2 * two_orbits, [&](const Flows&) {
    const PowerBalance p = plant.power_balance();
    array_J += p.array * plant.step_s();
    use_J += p.use() * plant.step_s();
    losses_J += p.losses() * plant.step_s();
  });
  EXPECT_GT(array_J, 15e6);
  EXPECT_GT(losses_J, 2e6);
  EXPECT_LT(std::abs(array_J - use_J - losses_J - (stored_J() - begin_J)), 1e-12 * array_J);
}

TEST(ReferencePlant, BatteriesAreWarmedByWhatIsNotStored) {
  const Constants constants;
  const BatteryConstants& c = constants.battery[0];
  Plant plant(constants, {}, july, 2);
  const double begin_C = plant.battery(0).state().temperature_C;
  double heat_J = 0;
  double before_C = begin_C;
  run(plant, two_orbits, [&](const Flows& f) {
    const double heater_W = f.load_A[battery_heater_1] * f.distributor_V;
    const double lost_W = c.conductance_W_K * (before_C - c.radiator_C);
    heat_J += (plant.battery(0).heat_W() + heater_W - lost_W) * plant.step_s();
    before_C = plant.battery(0).state().temperature_C;
  });
  EXPECT_NEAR(heat_J, (before_C - begin_C) * c.heat_capacity_J_K, 1e-6);
}

TEST(ReferencePlant, BatteryVoltageFollowsFromItsCurrent) {
  const Constants constants;
  Plant plant(constants, {}, july, 3);
  for (int step = 0; step < two_orbits * Plant::usual_steps_per_second; ++step) {
    const std::array internal_V{plant.battery(0).internal_V(), plant.battery(1).internal_V()};
    plant.step();
    for (std::size_t k = 0; k < battery_count; ++k) {
      ASSERT_NEAR(plant.flows().battery_V[k],
                  internal_V[k] + constants.battery[k].series_ohm * plant.flows().battery_A[k],
                  1e-11);
    }
  }
}

TEST(ReferencePlant, ChargeAndBusEnergyAreCounted) {
  const Constants constants;
  Plant plant(constants, {}, july, 4);
  const double soc = plant.battery(0).state().soc;
  const double bus_V = plant.flows().bus_V;
  double stored_As = 0;
  double capacitor_As = 0;
  run(plant, two_orbits, [&](const Flows& f) {
    stored_As += f.stored_A[0] * plant.step_s();
    capacitor_As += f.capacitor_A * plant.step_s();
    EXPECT_LE(std::abs(f.stored_A[0]), std::abs(f.battery_A[0]));
  });
  const double capacity_As = 3600 * constants.battery[0].capacity_Ah;
  EXPECT_NEAR((plant.battery(0).state().soc - soc) * capacity_As, stored_As, 1e-6);
  EXPECT_NEAR((plant.flows().bus_V - bus_V) * constants.bus.capacitance_F, capacitor_As, 1e-9);
}

TEST(ReferencePlant, AmplifierKeepsTheBusAndItsDomainsApart) {
  const Constants constants;
  Plant plant(constants, {}, july, 5);
  int discharging = 0;
  int shunting = 0;
  run(plant, two_orbits, [&](const Flows& f) {
    EXPECT_NEAR(f.bus_V, constants.mea.reference_V, 1.0);
    EXPECT_EQ(f.bdr_out_A > 0, f.mea_V < constants.mea.bdr_zero_V);
    EXPECT_EQ(f.shunt_A > 0, f.mea_V > constants.mea.shunt_first_V && f.array_A > 0);
    discharging += f.bdr_out_A > 0;
    shunting += f.shunt_A > 0;
  });
  EXPECT_GT(discharging, 60 * 60 * Plant::usual_steps_per_second);
  EXPECT_GT(shunting, 60 * 60 * Plant::usual_steps_per_second);
}

TEST(ReferencePlant, BatteriesDischargeInEclipseAndAreFullAgainBeforeTheNext) {
  Plant plant(Constants{}, {}, july, 6);
  double least = 1;
  double most = 0;
  run(plant, 10 * 6016, [&](const Flows& f) {
    const double soc = plant.battery(0).state().soc;
    least = std::min(least, soc);
    most = std::max(most, soc);
    EXPECT_TRUE(f.illumination > 0 || f.battery_A[0] < 0);
    EXPECT_LE(f.charge_A[0], f.section_A[0]);
    EXPECT_GE(f.section_shunt_A[0], 0);
  });
  EXPECT_GT(least, 0.80);
  EXPECT_LT(least, 0.92);
  EXPECT_GT(most, 0.97);
  EXPECT_LT(most, 1.00);
}

TEST(ReferencePlant, ChargersHoldTheBatteriesAtTheirLimit) {
  const Constants constants;
  Plant plant(constants, {}, july, 7);
  const Charger charger(constants.charger[0], 1);
  int tapering = 0;
  run(plant, two_orbits, [&](const Flows& f) {
    EXPECT_LT(f.battery_V[0], charger.limit_V(plant.battery(0).state().temperature_C) + 0.1);
    tapering += f.section_shunt_A[0] > 0;
  });
  EXPECT_GT(tapering, 10 * 60 * Plant::usual_steps_per_second);
}

TEST(ReferencePlant, BrownsOutWithEmptyBatteriesAndComesBackInSunlight) {
  Constants constants;
  for (auto& battery : constants.battery) {
    battery.capacity_Ah = 2;
    battery.initial_soc = 0.1;
  }
  Plant plant(constants, {}, july, 8);
  bool browned_out = false;
  bool recovered = false;
  run(plant, two_orbits, [&](const Flows& f) {
    EXPECT_TRUE(std::isfinite(f.mea_V) && std::isfinite(f.battery_V[0]));
    EXPECT_GE(f.bus_V, constants.bus.fold_back_V - 1e-9);
    EXPECT_LT(f.bus_V, constants.mea.reference_V + 1.5);
    EXPECT_NEAR(f.distributor_A + f.capacitor_A, f.bus_A, 1e-9);
    if (f.bus_V < constants.bus.fold_back_V + 1e-6) browned_out = true;
    if (browned_out && std::abs(f.bus_V - constants.mea.reference_V) < 0.1) recovered = true;
  });
  EXPECT_TRUE(browned_out);
  EXPECT_TRUE(recovered);
}

TEST(ReferencePlant, LosesOneSixthOfTheArrayWithAChannel) {
  Constants constants;
  constants.array.bus_strings[2] = 0;
  Plant damaged(constants, {}, july, 9);
  Plant whole(Constants{}, {}, july, 9);
  run(whole, 6016, [&](const Flows& f) {
    damaged.step();
    EXPECT_NEAR(damaged.flows().array_A, f.array_A * 5 / 6, 0.02);  // the bus differs a little
    EXPECT_NEAR(damaged.flows().sg2_A + damaged.flows().shunt_A, damaged.flows().array_A, 1e-12);
  });
}

}  // namespace
}  // namespace reident::satcs::reference::reference_plant_test
