// What a step of an FMU does: which ticks it runs, with which inputs, and what it shows.
#include <gmock/gmock.h>

#include "tests/service/model_export/hosted_fmu.hpp"

namespace reident::test::fmu_steps_test {
namespace {

using model_export::ExportedVersion;

// A master sets the inputs of a communication point, steps, and records at the next one, before it
// sets the inputs of that.
TEST(FmuSteps, GivesAfterAStepTheOutputsOfItsEndAsAMasterRecordsThem) {
  for (const bool direct : {false, true}) {
    Hosted run(random_version({4, 2, 2, direct, 0.5}, 4));
    const identification::StateSpaceModel& model = run.version.model.dynamics;
    run.instance->start();
    Noise noise(40);
    Distance distance;
    identification::Vector x = identification::Vector::Zero(4);
    std::vector<double> u = run.inputs(noise);
    for (int k = 0; k < 100; ++k) {
      EXPECT_EQ(run.instance->set(u), fmi2OK);
      EXPECT_EQ(run.instance->step(0.5), fmi2OK);
      x = model.A * x +
          model.B * (Eigen::Map<const identification::Vector>(u.data(), 2) - model.u0);
      distance.add(run.instance->outputs(), outputs_of(run.version, x, u));
      u = run.inputs(noise);
      EXPECT_EQ(run.instance->set(u), fmi2OK);
      distance.add(run.instance->outputs(), outputs_of(run.version, x, u));
    }
    EXPECT_LE(distance.largest, 1e-12);
  }
}

TEST(FmuSteps, HoldsInputsOverTheTicksOfALongStepAndOutputsBetweenTicks) {
  Hosted run(random_version({3, 2, 2}, 5));
  run.instance->start();
  Noise noise(6);
  Distance distance;
  for (int k = 0; k < 50; ++k) {
    const std::vector<double> u = run.inputs(noise);
    EXPECT_EQ(run.instance->set(u), fmi2OK);
    distance.add(run.instance->outputs(), run.reference.step(u));
    EXPECT_EQ(run.instance->step(3), fmi2OK);
    for (int i = 0; i < 2; ++i) run.reference.step(u);
  }
  std::vector<double> expected;
  for (int quarter = 0; quarter < 40; ++quarter) {
    const std::vector<double> u = run.inputs(noise);
    EXPECT_EQ(run.instance->set(u), fmi2OK);
    if (quarter % 4 == 0) expected = run.reference.step(u);
    distance.add(run.instance->outputs(), expected);  // what is set between ticks does not count
    EXPECT_EQ(run.instance->step(0.25), fmi2OK);
  }
  EXPECT_LE(distance.largest, 1e-12);
}

// So that a master which knows the inputs of the next communication point gets its outputs.
TEST(FmuSteps, InterpolatesInputsByTheirDerivativesOverOneStep) {
  Hosted run(random_version({3, 2, 2, true, 0.5, {"U * I_1"}}, 26));
  run.instance->start();
  const std::size_t count = run.reference.variables.inputs.size();
  const std::vector<fmi2ValueReference> references = {0, 1};
  const std::vector<int> orders(count, 1);
  ASSERT_EQ(count, references.size());
  Noise noise(27);
  Distance distance;
  std::vector<double> u = run.inputs(noise);
  for (int k = 0; k < 60; ++k) {
    const int periods = 1 + k % 3;
    const double step = 0.5 * periods;
    const std::vector<double> next = run.inputs(noise);
    std::vector<double> slopes(count);
    for (std::size_t i = 0; i < count; ++i) slopes[i] = (next[i] - u[i]) / step;
    EXPECT_EQ(run.instance->set(u), fmi2OK);
    EXPECT_EQ(run.binary.set_input_derivatives(run.instance->component, references.data(), count,
                                               orders.data(), slopes.data()),
              fmi2OK);
    for (int tick = 0; tick < periods; ++tick) {
      std::vector<double> between = u;
      for (std::size_t i = 0; i < count; ++i) between[i] += slopes[i] * 0.5 * tick;
      const std::vector<double> expected = run.reference.step(between);
      if (tick == 0) distance.add(run.instance->outputs(), expected);
    }
    EXPECT_EQ(run.instance->step(step), fmi2OK);
    u = next;
  }
  EXPECT_LE(distance.largest, 1e-12);
  EXPECT_EQ(run.instance->set(u), fmi2OK);
  EXPECT_EQ(run.instance->step(2), fmi2OK);
  for (int i = 0; i < 4; ++i) run.reference.step(u);
  distance.add(run.instance->outputs(), run.reference.step(u));
  EXPECT_LE(distance.largest, 1e-12) << "derivatives are of one step";
}

/// How many ticks have run, of a model that counts them.
double counted(const Hosted& run) {
  const fmi2ValueReference state = 2;
  double value = 0;
  EXPECT_EQ(run.binary.get_real(run.instance->component, &state, 1, &value), fmi2OK);
  return value;
}

/// x[k] = k for an input of 1.
ExportedVersion counter(double period_s) {
  ExportedVersion exported = random_version({1, 1, 1, false, period_s}, 1);
  identification::StateSpaceModel& dynamics = exported.version.model.dynamics;
  dynamics.A(0, 0) = 1;
  dynamics.B(0, 0) = 1;
  dynamics.C(0, 0) = 1;
  dynamics.u0(0) = 0;
  exported.version.digest = model_digest(exported.version.model);
  return exported;
}

struct Steps {
  const char* what;
  double period_s, start, step_s;
  int steps;
  double ticks;  // that must have run
};

TEST(FmuSteps, NeitherGainsNorLosesATickByTheRoundingOfTime) {
  const Steps table[] = {
      {"one period, added up", 0.1, 0, 0.1, 1'000'000, 1'000'000},
      {"a third of one", 0.1, 0, 0.1 / 3, 300'000, 100'000},
      {"three of them", 0.1, 0, 0.3, 100'000, 300'000},
      {"from a time of day", 0.1, 1.7e9, 0.1, 100'000, 100'000},
      {"one and a half", 2, -7, 3, 100'001, 150'002},
      {"of no relation", 1, 0, 0.7310585786300049, 100'000, 73'106},
  };
  for (const Steps& steps : table) {
    Hosted run(counter(steps.period_s));
    run.instance->start(steps.start);
    EXPECT_EQ(run.instance->set({1}), fmi2OK);
    for (int i = 0; i < steps.steps; ++i)
      ASSERT_EQ(run.instance->step(steps.step_s), fmi2OK) << run.instance->logged();
    EXPECT_EQ(counted(run), steps.ticks) << steps.what;
  }
}

TEST(FmuSteps, ShowsBeforeItsFirstTickWhatThatWillGive) {
  Hosted run(random_version({3, 2, 2}, 8));
  EXPECT_EQ(run.binary.enter_initialization(run.instance->component), fmi2OK);
  const identification::Vector& y0 = run.version.model.dynamics.y0;
  EXPECT_THAT(run.instance->outputs(), ::testing::ElementsAre(y0(0), y0(1)))
      << "inputs start at the operating point";
  EXPECT_EQ(run.instance->set({1, 2}), fmi2OK);
  const std::vector<double> shown = run.instance->outputs();
  Distance distance;
  distance.add(shown, run.reference.step({1, 2}));
  EXPECT_LE(distance.largest, 1e-12);
  EXPECT_EQ(run.binary.exit_initialization(run.instance->component), fmi2OK);
  EXPECT_EQ(run.instance->outputs(), shown);
}

TEST(FmuSteps, KeepsAnInputsLastValueWhereItsExpressionHasNone) {
  const ExportedVersion version = random_version({2, 1, 1, true, 1, {"U / V_BUS"}}, 11);
  Hosted run(version);
  run.instance->start();
  for (const std::vector<double>& u : std::vector<std::vector<double>>{{0, 0}, {4, 2}, {1, 0}}) {
    EXPECT_EQ(run.instance->set(u), fmi2OK);
    EXPECT_EQ(run.instance->step(1), u[1] == 0 ? fmi2Warning : fmi2OK);
    const std::string said = run.instance->logged();
    EXPECT_EQ(said.find("input 0 of the model has no finite value") == 0, u[1] == 0) << said;
  }
  Hosted other(version);
  const double u0 = other.version.model.dynamics.u0(0);
  other.instance->start();
  for (const std::vector<double>& u : std::vector<std::vector<double>>{{u0, 1}, {2, 1}, {2, 1}}) {
    EXPECT_EQ(other.instance->set(u), fmi2OK);
    EXPECT_EQ(other.instance->step(1), fmi2OK);
  }
  EXPECT_EQ(run.instance->outputs(), other.instance->outputs());
}

TEST(FmuSteps, KeepsTheValueOfTheTickBeforeWhereAnExpressionHasNoneWithinAStep) {
  Hosted run(random_version({2, 1, 1, true, 1, {"U / V_BUS"}}, 28));
  run.instance->start();
  const fmi2ValueReference references[] = {0, 1};
  const int orders[] = {1, 1};
  const double slopes[] = {1, -1};  // V_BUS is 1, then 0
  EXPECT_EQ(run.instance->set({3, 1}), fmi2OK);
  EXPECT_EQ(
      run.binary.set_input_derivatives(run.instance->component, references, 2, orders, slopes),
      fmi2OK);
  EXPECT_EQ(run.instance->step(2), fmi2Warning);
  run.reference.step({3, 1});
  run.reference.step({4, 0});
  Distance distance;
  EXPECT_EQ(run.instance->set({5, 2}), fmi2OK);
  distance.add(run.instance->outputs(), run.reference.step({5, 2}));
  EXPECT_LE(distance.largest, 1e-12);
}

}  // namespace
}  // namespace reident::test::fmu_steps_test
