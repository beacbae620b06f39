#include "service/client/state_match.hpp"

#include <gtest/gtest.h>

#include "identification/simulation/initial_state.hpp"
#include "tests/support/systems.hpp"

namespace reident::test::state_match_test {
namespace {

TEST(StateMatch, IsTheStateOfTheScoresWhateverTheOutputsUnits) {
  Noise noise(31);
  StateSpaceModel model = random_system(noise, 4, 2, 2);
  constexpr Index rows = 100;
  Record record = excited(model, noise, rows, 0.1);
  record.u *= 3;  // the model errs
  Matrix states(4, 2);
  for (const Index unit : {0, 1}) {
    const StepKernel kernel(model);
    StateMatch match(model, kernel, rows);
    for (Index k = 0; k < rows; ++k)
      match.add(record.u.row(k).transpose() - model.u0, record.y.row(k).transpose() - model.y0);
    states.col(unit) = match.solve();
    Vector x = estimate_initial_state(model, record, record.segments, rows);
    for (Index k = 0; k < rows; ++k) x = model.A * x + model.B * record.u.row(k).transpose();
    EXPECT_LT((states.col(unit) - x).norm(), 1e-6 * x.norm());
    constexpr double Pa_in_bar = 1e5;
    for (Matrix* of_output : {&model.C, &model.D}) of_output->row(1) *= Pa_in_bar;
    record.y.col(1) *= Pa_in_bar;
  }
  EXPECT_LT((states.col(1) - states.col(0)).norm(), 1e-6 * states.col(0).norm());
}

}  // namespace
}  // namespace reident::test::state_match_test
