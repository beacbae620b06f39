#include "service/client/model_runner.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "identification/simulation/free_run.hpp"
#include "service/client/include/reident/client.h"
#include "tests/service/client/live_telemetry.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool counts_allocations = false;  // the sanitizer owns malloc
#else
constexpr bool counts_allocations = true;
namespace {
std::size_t allocations = 0;
}
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
#endif

namespace reident::test::model_runner_test {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Vector;

std::unique_ptr<PreparedModel> prepare(EquipmentModel model, const Declaration& declaration) {
  ModelVersion version;
  version.model = std::move(model);
  auto made = PreparedModel::make(std::move(version), declaration);
  if (const auto* reason = std::get_if<std::string>(&made)) throw std::runtime_error(*reason);
  auto prepared = std::get<std::unique_ptr<PreparedModel>>(std::move(made));
  prepared->prepare_following();
  return prepared;
}

/// A runner whose simulator declares what the model has.
class Simulation {
 public:
  explicit Simulation(const EquipmentModel& model) : Simulation(model, declaration_of(model)) {}
  Simulation(const EquipmentModel& model, Declaration declaration)
      : declaration_(std::move(declaration)), runner(declaration_) {
    swap(model);
  }

  double step(const Vector& u) {
    flags = runner.step(u.data(), &y_);
    return y_;
  }
  double follow(const Vector& u, double measured) {
    flags = runner.follow(u.data(), &measured, &y_);
    return y_;
  }
  void observe(double measured) { runner.observe(&measured); }
  ModelRunner::Swap swap(const EquipmentModel& model) {
    auto next = prepare(model, declaration_);
    return runner.swap(next);
  }

 private:
  Declaration declaration_;
  double y_ = 0;

 public:
  ModelRunner runner;
  int flags = 0;
};

/// The example model with a gain that lets it follow.
EquipmentModel following_model() {
  EquipmentModel model = example_model();
  identification::TrackingGain& gain = model.tracking.emplace().gain;
  gain.state = (Matrix(2, 2) << 1.07, -0.2, 0.32, -0.03).finished();
  gain.integral = (Matrix(2, 2) << -0.33, -0.03, -0.08, -0.01).finished();
  gain.error_limit = Vector::Constant(1, 5);
  return model;
}

Matrix inputs(Index rows) {
  Matrix u(rows, 2);
  for (Index k = 0; k < rows; ++k) u.row(k) = example_input(k).transpose();
  return u;
}

TEST(ModelRunner, StepsAreTheFreeRunOfTheIdentification) {
  const EquipmentModel model = example_model();
  const auto record = identification::contiguous_record(1, inputs(100), Matrix::Zero(100, 1));
  const Matrix expected =
      identification::free_run(model.dynamics, record, record.all(), Vector(Vector::Zero(2)));
  Simulation run(model);
  for (Index k = 0; k < 100; ++k) EXPECT_NEAR(run.step(example_input(k)), expected(k, 0), 1e-12);
}

TEST(ModelRunner, StartsFromTheStateOfTheMeasuredRows) {
  ExamplePlant plant;
  Matrix u = inputs(20);
  Matrix y(20, 1);
  for (Index k = 0; k < 20; ++k) y(k, 0) = plant.step(example_input(k));
  Simulation run(example_model());
  run.runner.start(u.bottomRows(6), y.bottomRows(6));
  for (Index k = 20; k < 60; ++k)
    EXPECT_NEAR(run.step(example_input(k)), plant.step(example_input(k)), 1e-9);
}

TEST(ModelRunner, AllocatesNothingWhileItRunsFollowsAndChangesToAnotherVersion) {
  if (!counts_allocations) GTEST_SKIP() << "the sanitizer owns malloc";
  EquipmentModel model = following_model();
  model.inputs[1] = {"P_IN", "W", -0.25, 4, "max(V_BUS, 1) * I_BDRIN2"};
  const Declaration declaration{{{"I_BDRIN1", ""}, {"I_BDRIN2", "A"}, {"V_BUS", ""}},
                                {{"I_BDROUT", ""}}};
  Simulation run(model, declaration);
  auto next = prepare(model, declaration);
  const Vector u = (Vector(3) << 3, 1, 1.1).finished();
  run.step(u);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const std::size_t before = allocations;
  for (int k = 0; k < 300; ++k) run.step(u);
  for (int k = 0; k < 300; ++k) run.follow(u, 4.5);
  run.runner.swap(next);
  for (int k = 0; k < 300; ++k) run.follow(u, 4.5);
  for (int k = 0; k < 300; ++k) run.step(u);
  EXPECT_EQ(allocations, before);
  EXPECT_GT(before, 0U);
#endif
}

TEST(ModelRunner, FlagsInputsOutsideTheIdentifiedRangeAndUsesThemAsTheyAre) {
  Simulation run(example_model());
  run.step((Vector(2) << 5, -0.25).finished());
  EXPECT_EQ(run.flags, 0);
  Simulation wide(example_model());
  const Vector outside = (Vector(2) << 50, 0).finished();
  EXPECT_DOUBLE_EQ(wide.step(outside), 4.25 + 0.1 * (50 - 2.5));
  EXPECT_EQ(wide.flags, REIDENT_INPUT_OUTSIDE);
  EXPECT_EQ(wide.runner.input_flags(0), REIDENT_INPUT_OUTSIDE);
  EXPECT_EQ(wide.runner.input_flags(1), 0);
}

TEST(ModelRunner, HoldsTheLastValueOfAnInputThatIsMissing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Simulation run(example_model()), held(example_model());
  EXPECT_EQ(run.step((Vector(2) << nan, 2).finished()), held.step((Vector(2) << 2.5, 2).finished()))
      << "the operating point's before the first";
  EXPECT_EQ(run.flags, REIDENT_INPUT_MISSING);
  run.step((Vector(2) << 3, 1).finished());
  held.step((Vector(2) << 3, 1).finished());
  EXPECT_EQ(run.step((Vector(2) << 2, nan).finished()), held.step((Vector(2) << 2, 1).finished()));
  EXPECT_EQ(run.runner.input_flags(0), 0);
  EXPECT_EQ(run.runner.input_flags(1), REIDENT_INPUT_MISSING);
  EXPECT_EQ(run.step((Vector(2) << 2, -HUGE_VAL).finished()),
            held.step((Vector(2) << 2, 1).finished()));
}

TEST(ModelRunner, TakesInputsByNameInAnyOrderAndComputesDerivedOnes) {
  EquipmentModel derived = example_model();
  derived.inputs[1] = {"P_IN", "W", -0.25, 4, "V_BUS * I_BDRIN2"};
  Simulation by_name(derived, {{{"V_BUS", "V"}, {"OTHER", ""}, {"I_BDRIN2", ""}, {"I_BDRIN1", "A"}},
                               {{"I_BDROUT", "A"}}});
  Simulation direct(derived, {{{"P_IN", "W"}, {"I_BDRIN1", "A"}}, {{"I_BDROUT", ""}}});
  Simulation plain(example_model());
  for (Index k = 0; k < 20; ++k) {
    const Vector u = example_input(k);
    const double expected = plain.step((Vector(2) << u(0), 2 * u(1)).finished());
    EXPECT_EQ(by_name.step((Vector(4) << 2, 7, u(1), u(0)).finished()), expected);
    EXPECT_EQ(direct.step((Vector(2) << 2 * u(1), u(0)).finished()), expected);
  }
  by_name.step((Vector(4) << 9, 7, 9, 3).finished());
  EXPECT_EQ(by_name.runner.input_flags(0), REIDENT_INPUT_OUTSIDE) << "its product is";
  EXPECT_EQ(by_name.runner.input_flags(1), 0);
  EXPECT_EQ(by_name.runner.input_flags(2), REIDENT_INPUT_OUTSIDE);
}

TEST(ModelRunner, SaysWhatADeclarationLacks) {
  const std::vector<std::pair<Declaration, std::string>> cases = {
      {{{{"I_BDRIN1", ""}}, {{"I_BDROUT", ""}}},
       "it needs I_BDRIN2, which the simulator does not declare"},
      {{{{"I_BDRIN1", "mA"}, {"I_BDRIN2", ""}}, {{"I_BDROUT", ""}}},
       "its I_BDRIN1 is in A, and the simulator's in mA"},
      {{{{"I_BDRIN1", ""}, {"I_BDRIN2", ""}}, {{"V_BUS", ""}}},
       "it needs I_BDROUT, which the simulator does not declare"},
      {{{{"I_BDRIN1", ""}, {"I_BDRIN2", ""}}, {{"I_BDROUT", ""}, {"V_BUS", ""}}},
       "it has not all of the outputs that the simulator declares"},
  };
  for (const auto& [declaration, reason] : cases) {
    ModelVersion version;
    version.model = example_model();
    const auto made = PreparedModel::make(version, declaration);
    ASSERT_TRUE(std::holds_alternative<std::string>(made)) << reason;
    EXPECT_EQ(std::get<std::string>(made), reason);
  }
}

TEST(ModelRunner, FollowsWhatIsMeasuredAndLetsGoWithoutAJump) {
  for (const bool integral : {true, false}) {
    EquipmentModel model = integral ? following_model() : example_model();
    Simulation run(model), free(model);
    ExamplePlant plant;
    const double bias = 0.5;
    double last = 0, largest_step = 0, error = 0;
    const auto look = [&](Index k, double y) {
      if (k > 0) largest_step = std::max(largest_step, std::abs(y - last));
      last = y;
    };
    for (Index k = 0; k < 100; ++k) {
      const Vector u = example_input(k);
      look(k, run.step(u));
      free.step(u);
      plant.step(u);
    }
    const double own_step = largest_step;
    for (Index k = 100; k < 400; ++k) {
      const Vector u = example_input(k);
      const double measured = plant.step(u) + bias;
      look(k, run.follow(u, measured));
      EXPECT_EQ(run.flags, 0);
      EXPECT_TRUE(run.runner.is_following());
      free.step(u);
      error = measured - last;
    }
    EXPECT_LT(std::abs(error), integral ? 0.01 : 0.6 * bias);
    EXPECT_LT(largest_step, 2 * own_step) << "the correction comes in";
    double free_output = 0;
    for (Index k = 400; k < 1200; ++k) {
      look(k, run.step(example_input(k)));
      EXPECT_FALSE(run.runner.is_following());
      free_output = free.step(example_input(k));
    }
    EXPECT_LT(largest_step, 2 * own_step) << "and fades";
    EXPECT_NEAR(last, free_output, 1e-9) << "to the free run";
  }
}

TEST(ModelRunner, RunsFreeAndSaysSoWhereItCannotFollow) {
  EquipmentModel model = example_model();
  model.dynamics.K.resize(0, 0);
  Simulation run(model), free(model);
  EXPECT_EQ(run.follow(example_input(0), 7), free.step(example_input(0)));
  EXPECT_EQ(run.flags, REIDENT_NOT_FOLLOWING);
  Simulation follows(following_model()), silent(following_model());
  for (Index k = 0; k < 50; ++k) {
    follows.follow(example_input(k), std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(follows.flags, REIDENT_NOT_FOLLOWING);
    silent.step(example_input(k));
  }
  EXPECT_NEAR(follows.runner.output()[0], silent.runner.output()[0], 1e-12);
}

TEST(ModelRunner, AMeasuredSpikeMovesAFollowingRunNoFurtherThanItsClamp) {
  for (const bool integral : {true, false}) {
    EquipmentModel model = integral ? following_model() : example_model();
    Simulation run(model), free(model);
    double most = 0;
    for (Index k = 0; k < 300; ++k) {
      run.follow(example_input(k), k % 50 == 7 ? 1e300 : free.runner.output()[0]);
      free.step(example_input(k));
      most = std::max(most, std::abs(run.runner.output()[0] - free.runner.output()[0]));
    }
    EXPECT_GT(most, 0.1);
    EXPECT_LT(most, 100);
  }
}

TEST(ModelRunner, StartsOverAtTheOperatingPointWhenTheRunIsNotFinite) {
  Simulation run(example_model());
  EXPECT_DOUBLE_EQ(run.step((Vector(2) << 1e308, 1e308).finished()), 1e307);
  double y = 0;
  for (int k = 0; k < 5 && (run.flags & REIDENT_DIVERGED) == 0; ++k)
    y = run.step((Vector(2) << 1.7e308, 1.7e308).finished());
  EXPECT_NE(run.flags & REIDENT_DIVERGED, 0);
  EXPECT_EQ(y, 4.25);
  EXPECT_NEAR(run.step((Vector(2) << 3.5, 1.5).finished()), 4.35, 1e-12) << "it goes on";
  for (Index k = 0; k < 200; ++k) run.step(example_input(k));
  EquipmentModel other = example_model();
  other.dynamics.y0(0) += 0.1;
  EXPECT_LT(run.swap(other).transition, ModelRunner::most_transition) << "its pace is known again";
}

TEST(ModelRunner, ASwapToTheSameModelInAnotherBasisIsNotFelt) {
  EquipmentModel other = example_model();
  const Matrix T = (Matrix(2, 2) << 3, 1, -2, 5).finished();
  other.dynamics.A = T * other.dynamics.A * T.inverse();
  other.dynamics.B = T * other.dynamics.B;
  other.dynamics.C = other.dynamics.C * T.inverse();
  Simulation stays(example_model()), swaps(example_model());
  for (Index k = 0; k < 40; ++k) {
    stays.step(example_input(k));
    swaps.step(example_input(k));
  }
  const double last = swaps.runner.output()[0];
  const ModelRunner::Swap swap = swaps.swap(other);
  EXPECT_EQ(swap.rows, 40);
  EXPECT_LT(swap.largest, 1e-9);
  EXPECT_EQ(swap.transition, ModelRunner::least_transition);
  EXPECT_EQ(swaps.runner.output()[0], last) << "what was put out stays";
  for (Index k = 40; k < 80; ++k)
    EXPECT_NEAR(swaps.step(example_input(k)), stays.step(example_input(k)), 1e-9);
}

TEST(ModelRunner, ASwapToADifferentModelContinuesTheOutputAndThenFollowsTheNewOne) {
  EquipmentModel other = example_model();
  other.dynamics.A(0, 0) = 0.92;
  other.dynamics.B *= 1.05;
  std::swap(other.inputs[0], other.inputs[1]);
  other.dynamics.B.col(0).swap(other.dynamics.B.col(1));
  other.dynamics.D.col(0).swap(other.dynamics.D.col(1));
  std::swap(other.dynamics.u0(0), other.dynamics.u0(1));
  Simulation run(example_model()), always_new(other, declaration_of(example_model()));
  double own_step = 0;
  for (Index k = 0; k < 300; ++k) {
    const double last = run.runner.output()[0];
    run.step(example_input(k));
    if (k > 100) own_step = std::max(own_step, std::abs(run.runner.output()[0] - last));
    always_new.step(example_input(k));
  }
  const double difference = always_new.runner.output()[0] - run.runner.output()[0];
  EXPECT_GT(std::abs(difference), 1);
  const ModelRunner::Swap swap = run.swap(other);
  EXPECT_GT(swap.largest / std::abs(difference), 0.3);
  for (Index k = 300; k < 300 + swap.transition; ++k) {
    EXPECT_EQ(run.runner.transition_left(), 300 + swap.transition - k);
    const double last = run.runner.output()[0];
    run.step(example_input(k));
    EXPECT_LT(std::abs(run.runner.output()[0] - last), 2.5 * own_step) << k;
    always_new.step(example_input(k));
  }
  EXPECT_EQ(run.flags, 0);
  EXPECT_NEAR(run.runner.output()[0], always_new.runner.output()[0], 1e-4);
}

TEST(ModelRunner, ASwapStartsFromMeasuredOutputsWhereTheyAreKnown) {
  EquipmentModel wrong = example_model();
  wrong.dynamics.B *= 0.5;
  Simulation run(wrong);
  ExamplePlant plant;
  double measured = 0;
  for (Index k = 0; k < 300; ++k) {
    run.step(example_input(k));
    measured = plant.step(example_input(k));
    run.observe(measured);
  }
  const double put_out = run.runner.output()[0];
  EXPECT_NEAR(run.swap(example_model()).largest, std::abs(measured - put_out), 1e-9);
}

TEST(ModelRunner, PutsNothingOutBeforeItsFirstModel) {
  ModelRunner runner(declaration_of(example_model()));
  double y = 0;
  const Vector u = example_input(0);
  EXPECT_EQ(runner.step(u.data(), &y), REIDENT_NO_MODEL);
  EXPECT_TRUE(std::isnan(y));
  EXPECT_EQ(runner.input_flags(0), 0);
}

TEST(ModelRunner, ASwapToAnotherPeriodGoesFromTheOutputToTheOperatingPoint) {
  Simulation run(example_model());
  for (Index k = 0; k < 100; ++k) run.step(example_input(k));
  const double last = run.runner.output()[0];
  EquipmentModel other = example_model();
  other.dynamics.period_s = 10;
  const ModelRunner::Swap swap = run.swap(other);
  EXPECT_EQ(swap.rows, 0);
  EXPECT_DOUBLE_EQ(swap.largest, std::abs(4.25 - last));
  const double y = run.step((Vector(2) << 2.5, 1.5).finished());
  EXPECT_NEAR(y, last, std::abs(4.25 - last) / ModelRunner::least_transition + 1e-12);
}

TEST(ModelRunner, ASwapBeforeTheFirstStepStartsAtTheOperatingPoint) {
  Simulation run(example_model());
  const ModelRunner::Swap swap = run.swap(example_model());
  EXPECT_EQ(swap.rows, 0);
  EXPECT_EQ(swap.largest, 0);
  EXPECT_EQ(run.runner.output()[0], 4.25);
}

TEST(ModelRunner, TellsModelsWithOtherSignalsOrPeriod) {
  const EquipmentModel model = example_model();
  EquipmentModel other = example_model();
  other.inputs[0].high = 9;
  EXPECT_TRUE(same_signals(model, other)) << "another range";
  std::swap(other.inputs[0], other.inputs[1]);
  EXPECT_TRUE(same_signals(model, other)) << "another order";
  other.inputs[0].unit = "mA";
  EXPECT_FALSE(same_signals(model, other));
  other = example_model();
  other.inputs[0].expression = "V_BUS * 2";
  EXPECT_FALSE(same_signals(model, other)) << "another meaning of the same name";
  other = example_model();
  other.dynamics.period_s = 2;
  EXPECT_FALSE(same_signals(model, other));
  other = example_model();
  other.inputs.pop_back();
  EXPECT_FALSE(same_signals(model, other));
}

TEST(ModelRunner, RunsAStaticModel) {
  EquipmentModel model = example_model();
  model.dynamics.A.resize(0, 0);
  model.dynamics.B.resize(0, 2);
  model.dynamics.C.resize(1, 0);
  model.dynamics.K.resize(0, 0);
  Simulation run(model);
  EXPECT_DOUBLE_EQ(run.step((Vector(2) << 3.5, 1.5).finished()), 4.25 + 0.1);
  run.swap(example_model());
  EXPECT_EQ(run.runner.model()->dynamics().order(), 2);
  run.swap(model);
  EXPECT_EQ(run.runner.model()->dynamics().order(), 0);
  run.step((Vector(2) << 3.5, 1.5).finished());
  EXPECT_TRUE(std::isfinite(run.runner.output()[0]));
}

}  // namespace
}  // namespace reident::test::model_runner_test
