#include "service/judgement/rivals.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "service/judgement/run_comparison.hpp"
#include "service/operations/refresh.hpp"
#include "tests/service/daemon_fixture.hpp"

namespace reident::test::rivals_test {
namespace {

class Rivals : public DaemonTest {
 protected:
  Rivals() { archive.describe(descriptors()); }

  RefreshResult run(storage::Time end, const EquipmentConfig& equipment = plant()) {
    WindowCache kept = window_cache_of("SAT", equipment);
    return refresh(archive, registry,
                   {"SAT", equipment, {end - equipment.window, end}, "slide", "digest"}, kept, {},
                   [] { return false; });
  }
  void record(const RefreshResult& result) {
    registry.record(result.attempt, result.version, *result.decision);
  }
  /// Telemetry of the simulator, whose model has another gain.
  void simulate(storage::Time begin, int seconds, double gain) {
    auto frames = telemetry(begin, seconds, gain, 0);
    for (auto& frame : frames) {
      frame.source = "simulator";
      frame.origin = storage::Origin::simulated;
    }
    archive.append(frames);
  }

  void operate(storage::Time begin, int seconds, const Operation& now) {
    archive.append(operation(begin, seconds, now));
  }

  storage::Database database = open();
  storage::Archive archive{database};
  storage::Registry registry{database};
};

TEST_F(Rivals, TheSimulatorsTelemetryIsTheBaselineOfTheFirstVersion) {
  archive.append(telemetry(day, 601));
  simulate(day, 601, 0.5);
  const RefreshResult result = run(day + 10 * minute);
  ASSERT_TRUE(result.evidence.baseline);
  EXPECT_EQ(result.evidence.baseline->rows, 180);
  EXPECT_GT(result.evidence.baseline->rival_mrse_percent, 2);
  EXPECT_GT(result.evidence.baseline->sure_percent, 50);
  EXPECT_EQ(result.attempt.outcome, "approved") << result.attempt.reason;
}

TEST_F(Rivals, ASimulatorThatIsAsGoodKeepsItsModel) {
  archive.append(telemetry(day, 601, 1, 0.2));
  simulate(day, 601, 1);
  const RefreshResult result = run(day + 10 * minute);
  ASSERT_TRUE(result.evidence.baseline);
  EXPECT_EQ(result.attempt.outcome, "not_better_than_baseline") << result.attempt.reason;
}

TEST_F(Rivals, AChampionWithOtherOutputsGivesWayToNoOlderWindow) {
  archive.append(telemetry(day, 1201));
  record(run(day + 20 * minute));
  EquipmentConfig other = plant();
  other.inputs = {"v", "y"};
  other.outputs = {"u"};
  other.max_mrse_percent = 100;
  const RefreshResult older = run(day + 15 * minute, other);
  ASSERT_TRUE(older.evidence.champion) << older.attempt.reason;
  EXPECT_FALSE(older.evidence.champion->comparison);
  EXPECT_EQ(older.attempt.outcome, "older_than_champion") << older.attempt.reason;
}

TEST_F(Rivals, TelemetryOfTheSimulatorForLessThanHalfOfTheValidationIsNoBaseline) {
  archive.append(telemetry(day, 601));
  simulate(day + 8 * minute + 40 * second, 80, 0.5);
  EXPECT_FALSE(run(day + 10 * minute).evidence.baseline);
}

TEST_F(Rivals, ACandidateOfAQuietWindowHasToAgreeWithTheChampionWhereItWasNot) {
  archive.append(telemetry(day, 601));
  record(run(day + 10 * minute));
  // The output hardly follows the inputs for a while, as with loads switched off.
  operate(day + 20 * minute, 601, {.u = 0.2, .v = 0.2, .gain = 0.3});
  const RefreshResult result = run(day + 30 * minute);
  ASSERT_TRUE(result.evidence.champion && result.evidence.champion->elsewhere)
      << result.attempt.reason;
  EXPECT_GT(result.evidence.champion->elsewhere->disagreement_percent, 10);
  EXPECT_EQ(result.attempt.outcome, "disagrees_with_champion") << result.attempt.reason;
}

TEST_F(Rivals, AnOperationThatMovesTheInputsLessIsUnusual) {
  archive.append(telemetry(day, 601));
  record(run(day + 10 * minute));
  archive.append(telemetry(day + 20 * minute, 601, 2.0));
  EXPECT_NEAR(run(day + 30 * minute).evidence.champion->movement, 1, 0.01);
  operate(day + 40 * minute, 601, {.u = 0.5, .v = 0.5, .gain = 2});
  EXPECT_NEAR(run(day + 50 * minute).evidence.champion->movement, 0.5, 0.01);
  // The input v moves the output half as much as u does, so that it counts as a third.
  operate(day + 60 * minute, 601, {.v = 0, .gain = 2});
  EXPECT_NEAR(run(day + 70 * minute).evidence.champion->movement, 0.67, 0.02);
}

TEST_F(Rivals, AnInputThatStandsStillAllOverTheWindowIsNamedUnlessItIsASwitch) {
  archive.append(telemetry(day, 601));
  record(run(day + 10 * minute));
  operate(day + 20 * minute, 601, {.v = 0, .gain = 2});
  EXPECT_EQ(run(day + 30 * minute).evidence.champion->still, "v");
  operate(day + 40 * minute, 601, {.gain = 2});
  EXPECT_EQ(run(day + 50 * minute).evidence.champion->still, "");
  auto switches = descriptors();
  switches[1].kind = storage::ParameterKind::digital;
  archive.describe(switches);
  EXPECT_EQ(run(day + 30 * minute).evidence.champion->still, "");
}

TEST_F(Rivals, ADerivedInputThatStandsStillIsNamedUnlessSwitchesAloneMakeIt) {
  EquipmentModel model;
  model.spacecraft = "SAT";
  model.inputs = {{"sum", "", 0, 2, "u + v"}};
  const identification::Matrix still = identification::Matrix::Ones(5, 1);
  EXPECT_EQ(still_input(archive, model, still), "sum");
  auto switches = descriptors();
  switches[0].kind = storage::ParameterKind::digital;
  archive.describe(switches);
  EXPECT_EQ(still_input(archive, model, still), "sum");
  switches[1].kind = storage::ParameterKind::digital;
  archive.describe(switches);
  EXPECT_EQ(still_input(archive, model, still), "");
}

/// A voltage with an effect of 200 on an output of range 5, and a current with one of 4.
EquipmentModel of_a_voltage_and_a_current() {
  using identification::Matrix;
  using identification::Vector;
  EquipmentModel model;
  model.inputs = {{"V", "V", 27.9, 28.1}, {"I", "A", 0, 10}};
  model.outputs = {{"y", "V", 0, 5}};
  model.dynamics.A = Matrix::Zero(0, 0);
  model.dynamics.B = Matrix::Zero(0, 2);
  model.dynamics.C = Matrix::Zero(1, 0);
  model.dynamics.D = (Matrix(1, 2) << 1000, 0.4).finished();
  model.dynamics.u0 = Vector::Zero(2);
  model.dynamics.y0 = Vector::Zero(1);
  return model;
}

TEST(Movement, CountsAnInputByTheOutputsRangeAtMost) {
  const identification::Matrix u{{28, 0}, {28.02, 10}};
  EXPECT_NEAR(movement(of_a_voltage_and_a_current(), u), (5 * 0.1 + 4) / 9, 1e-12);
}

/// The voltage is held near a point but for two transients, the current moves over `share` of its
/// range.
identification::Matrix transients(double share) {
  identification::Matrix u(4000, 2);
  for (identification::Index k = 0; k < u.rows(); ++k) {
    const bool first = k == 1000, second = k == 2000;
    u.row(k) << (first ? 27.9 : second ? 28.1 : 28.0), (k % 2 == 0 ? 0 : 10 * share);
  }
  return u;
}

TEST(Movement, IsThatOfTheOthersWhereAnInputIsHeldNearAPoint) {
  EXPECT_NEAR(movement(of_a_voltage_and_a_current(), transients(0.2)), 0.2, 1e-12);
}

TEST(Movement, IsOfInputsThatAreHeldWhereThereAreNoOthers) {
  EquipmentModel model = of_a_voltage_and_a_current();
  model.inputs.pop_back();
  model.dynamics.B = identification::Matrix::Zero(0, 1);
  model.dynamics.D = identification::Matrix{{1000}};
  model.dynamics.u0 = identification::Vector::Zero(1);
  EXPECT_NEAR(movement(model, transients(0).leftCols(1)), 1, 1e-12);
}

TEST(Movement, OfAnInputThatStandsStillIsNothing) {
  EXPECT_NEAR(movement(of_a_voltage_and_a_current(), transients(0)), 0, 1e-12);
}

TEST_F(Rivals, WhatMayBeAConstantAloneHasToAgreeAllOverTheChampionsWindow) {
  archive.append(telemetry(day, 361));
  operate(day + 6 * minute + second, 240, {.v = 0.01});  // that validates the champion too
  record(run(day + 10 * minute));
  operate(day + 20 * minute, 601, {.v = 0.005, .offset = 1, .noise = 0.4});
  const RefreshResult result = run(day + 30 * minute);
  ASSERT_TRUE(result.evidence.champion) << result.attempt.reason;
  const Evidence::Champion& champion = *result.evidence.champion;
  ASSERT_TRUE(champion.without_offset && champion.elsewhere) << result.attempt.reason;
  EXPECT_LE(champion.without_offset->sure_percent, 0);
  EXPECT_GT(champion.elsewhere->without_offset_percent, 10);
  EXPECT_EQ(result.attempt.outcome, "disagrees_with_champion") << result.attempt.reason;
}

TEST_F(Rivals, AChangeByAConstantMakesTheCandidateErrOnThePastByThatConstant) {
  archive.append(telemetry(day, 601));
  record(run(day + 10 * minute));
  operate(day + 20 * minute, 601, {.u = 0.5, .v = 0.5, .offset = 1});
  EquipmentConfig equipment = plant();
  equipment.confirmation = equipment.slide;
  const RefreshResult result = run(day + 30 * minute, equipment);
  ASSERT_TRUE(result.evidence.champion && result.evidence.champion->elsewhere)
      << result.attempt.reason;
  EXPECT_GT(result.evidence.champion->elsewhere->disagreement_percent, 30);
  EXPECT_LT(result.evidence.champion->elsewhere->without_offset_percent, 10);
  EXPECT_NE(result.attempt.outcome, "disagrees_with_champion") << result.attempt.reason;
}

TEST_F(Rivals, WhereTheWindowVisitedAllThatTheChampionDidThereIsNoElsewhere) {
  archive.append(telemetry(day, 601));
  record(run(day + 10 * minute));
  archive.append(telemetry(day + 20 * minute, 601, 2.0));
  const RefreshResult result = run(day + 30 * minute);
  ASSERT_TRUE(result.evidence.champion);
  EXPECT_FALSE(result.evidence.champion->elsewhere);
  EXPECT_EQ(result.attempt.outcome, "approved") << result.attempt.reason;
}

TEST_F(Rivals, WhereTheChampionErrsAsEverTheCandidateIsLookedAtWhereThatWasValidated) {
  archive.append(telemetry(day, 601, 1, 0.3));
  record(run(day + 10 * minute));
  archive.append(telemetry(day + 20 * minute, 601, 1, 0.01));
  EquipmentConfig equipment = plant();
  equipment.confirmation = 5 * minute;
  equipment.unvouched = UnvouchedPolicy::approve;
  const RefreshResult result = run(day + 30 * minute, equipment);
  ASSERT_TRUE(result.evidence.champion && result.evidence.champion->where_validated)
      << result.attempt.reason;
  EXPECT_EQ(result.evidence.champion->where_validated->rows, 180);
  EXPECT_GT(result.evidence.champion->comparison->sure_percent, 15);
  EXPECT_LT(result.evidence.champion->where_validated->sure_percent, 15) << "all is noise there";
  EXPECT_EQ(result.attempt.outcome, "on_probation") << result.attempt.reason;
}

TEST_F(Rivals, AHoldLetsNoVersionThrough) {
  archive.append(telemetry(day, 601));
  registry.put_on_hold("SAT", "PLANT", {"ana", "eclipse season", day});
  const RefreshResult result = run(day + 10 * minute);
  EXPECT_EQ(result.attempt.outcome, "held") << result.attempt.reason;
  EXPECT_EQ(result.decision->kind, storage::DecisionKind::wait);
}

TEST(WorstOfRival, IsThatOfTheWorstStretch) {
  using identification::Matrix;
  PairedRuns runs;
  runs.y = Matrix::Constant(100, 1, 2);
  runs.rival = runs.y;
  runs.rival.bottomRows(10).array() += 1;
  EXPECT_NEAR(worst_of_rival(runs, 10), 50, 1e-9);
  EXPECT_NEAR(worst_of_rival(runs, 100), 50 * std::sqrt(0.1), 1e-9);
  EXPECT_EQ(worst_of_rival(runs, 101), 0);
  runs.y.setZero();
  EXPECT_EQ(worst_of_rival(runs, 10), 0) << "an output that rests";
}

TEST(RowsOutside, AreThoseWhereAnInputLeavesItsRangeByMoreThanNoise) {
  identification::Matrix u(4, 2);
  u << 0, 0, 1.04, 0, 1.06, 0, 0.5, -0.06;
  EXPECT_THAT(rows_outside(u, {{"a", "A", 0, 1}, {"b", "A", 0, 1}}), testing::ElementsAre(2, 3));
}

}  // namespace
}  // namespace reident::test::rivals_test
