#include "service/client/model_runner.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

#include "identification/simulate.hpp"
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

namespace reident::test {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Vector;

Matrix inputs(Index rows) {
  Matrix u(rows, 2);
  for (Index k = 0; k < rows; ++k) u.row(k) = example_input(k).transpose();
  return u;
}

TEST(ModelRunner, steps_are_the_free_run_of_the_identification) {
  const EquipmentModel model = example_model();
  const auto record = identification::contiguous_record(1, inputs(100), Matrix::Zero(100, 1));
  const Matrix expected =
      identification::free_run(model.dynamics, record, record.all(), Vector(Vector::Zero(2)));
  ModelRunner runner(model);
  for (Index k = 0; k < 100; ++k) {
    EXPECT_NEAR(runner.step(example_input(k))(0), expected(k, 0), 1e-12);
  }
}

TEST(ModelRunner, starts_from_the_state_of_the_measured_rows) {
  ExamplePlant plant;
  Matrix u = inputs(20);
  Matrix y(20, 1);
  for (Index k = 0; k < 20; ++k) y(k, 0) = plant.step(example_input(k));
  ModelRunner runner(example_model());
  runner.start(u.bottomRows(6), y.bottomRows(6));
  for (Index k = 20; k < 60; ++k) {
    EXPECT_NEAR(runner.step(example_input(k))(0), plant.step(example_input(k)), 1e-9);
  }
}

TEST(ModelRunner, does_not_allocate_in_a_step) {
  if (!counts_allocations) GTEST_SKIP() << "the sanitizer owns malloc";
  ModelRunner runner(example_model());
  const Vector u = example_input(0);
  runner.step(u);
  runner.swap(example_model());
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const std::size_t before = allocations;
  for (int k = 0; k < 1000; ++k) runner.step(u);
  EXPECT_EQ(allocations, before);
  EXPECT_GT(before, 0U);
#endif
}

TEST(ModelRunner, flags_inputs_outside_the_identified_range) {
  ModelRunner runner(example_model());
  runner.step((Vector(2) << 5, -0.25).finished());
  EXPECT_FALSE(runner.is_any_outside());
  runner.step((Vector(2) << 5.01, 0).finished());
  EXPECT_TRUE(runner.is_outside(0));
  EXPECT_FALSE(runner.is_outside(1));
  EXPECT_TRUE(runner.is_any_outside());
}

TEST(ModelRunner, a_swap_to_the_same_model_in_another_basis_is_not_felt) {
  EquipmentModel other = example_model();
  const Matrix T = (Matrix(2, 2) << 3, 1, -2, 5).finished();
  other.dynamics.A = T * other.dynamics.A * T.inverse();
  other.dynamics.B = T * other.dynamics.B;
  other.dynamics.C = other.dynamics.C * T.inverse();
  ModelRunner stays(example_model());
  ModelRunner swaps(example_model());
  for (Index k = 0; k < 40; ++k) {
    stays.step(example_input(k));
    swaps.step(example_input(k));
  }
  const double last = swaps.output()(0);
  const ModelRunner::Swap swap = swaps.swap(other);
  EXPECT_EQ(swap.rows, 40);
  EXPECT_LT(std::abs(swap.change(0)), 1e-9);
  EXPECT_EQ(swaps.output()(0), last) << "what was put out stays";
  for (Index k = 40; k < 80; ++k) {
    EXPECT_NEAR(swaps.step(example_input(k))(0), stays.step(example_input(k))(0), 1e-9);
  }
}

TEST(ModelRunner, a_swap_to_a_different_model_continues_the_output_and_then_follows_the_new_one) {
  EquipmentModel other = example_model();
  other.dynamics.A(0, 0) = 0.92;
  other.dynamics.B *= 1.05;
  ModelRunner runner(example_model());
  ModelRunner goes_on(example_model());
  ModelRunner always_new(other);
  for (Index k = 0; k < 300; ++k) {
    runner.step(example_input(k));
    goes_on.step(example_input(k));
    always_new.step(example_input(k));
  }
  const double difference = always_new.output()(0) - runner.output()(0);
  EXPECT_GT(std::abs(difference), 1);
  const ModelRunner::Swap swap = runner.swap(other);
  EXPECT_GT(swap.change(0) / difference, 0.3);
  const double jump = runner.step(example_input(300))(0) - goes_on.step(example_input(300))(0);
  EXPECT_LT(std::abs(jump), 0.1 * std::abs(difference));
  always_new.step(example_input(300));
  for (Index k = 301; k < 300 + ModelRunner::transition_steps; ++k) {
    runner.step(example_input(k));
    always_new.step(example_input(k));
  }
  EXPECT_NEAR(runner.output()(0), always_new.output()(0), 1e-6);
}

TEST(ModelRunner, a_swap_starts_from_measured_outputs_where_they_are_known) {
  EquipmentModel wrong = example_model();
  wrong.dynamics.B *= 0.5;
  ModelRunner runner(wrong);
  ExamplePlant plant;
  double measured = 0;
  for (Index k = 0; k < 300; ++k) {
    runner.step(example_input(k));
    measured = plant.step(example_input(k));
    runner.observe(Vector::Constant(1, measured));
  }
  const double put_out = runner.output()(0);
  const ModelRunner::Swap swap = runner.swap(example_model());
  EXPECT_NEAR(swap.change(0), measured - put_out, 1e-9);
}

TEST(ModelRunner, a_swap_before_the_first_step_starts_at_the_operating_point) {
  ModelRunner runner(example_model());
  const ModelRunner::Swap swap = runner.swap(example_model());
  EXPECT_EQ(swap.rows, 0);
  EXPECT_EQ(swap.change(0), 0);
  EXPECT_EQ(runner.output()(0), 4.25);
}

TEST(ModelRunner, tells_models_with_other_signals_or_period) {
  const ModelRunner runner(example_model());
  EXPECT_TRUE(runner.fits(example_model()));
  EquipmentModel other = example_model();
  other.inputs[0].high = 9;
  EXPECT_TRUE(runner.fits(other)) << "another range";
  other.inputs[0].unit = "mA";
  EXPECT_FALSE(runner.fits(other));
  other = example_model();
  other.inputs[0].expression = "V_BUS * 2";
  EXPECT_FALSE(runner.fits(other)) << "another meaning of the same name";
  other = example_model();
  std::swap(other.inputs[0], other.inputs[1]);
  EXPECT_FALSE(runner.fits(other));
  other = example_model();
  other.dynamics.period_s = 2;
  EXPECT_FALSE(runner.fits(other));
}

TEST(ModelRunner, runs_a_static_model) {
  EquipmentModel model = example_model();
  model.dynamics.A.resize(0, 0);
  model.dynamics.B.resize(0, 2);
  model.dynamics.C.resize(1, 0);
  model.dynamics.K.resize(0, 0);
  ModelRunner runner(model);
  EXPECT_DOUBLE_EQ(runner.step((Vector(2) << 3.5, 1.5).finished())(0), 4.25 + 0.1);
  runner.swap(example_model());
  EXPECT_EQ(runner.model().dynamics.order(), 2);
}

}  // namespace
}  // namespace reident::test
