#include "identification/fit/output_error_fit.hpp"

#include <gtest/gtest.h>

#include "identification/fit/regression.hpp"
#include "identification/simulation/free_run.hpp"
#include "tests/support/naive_n4sid.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::output_error_fit_test {
namespace {

double output_error(const Response& response, const Record& record) {
  const Matrix y_hat = free_run(response.model, record, record.all(), response.x0);
  return (record.y - y_hat).norm() / std::sqrt(double(record.rows()));
}

TEST(Response, RecoversBAndDAndTheOffsetExactly) {
  test::Noise noise(1);
  for (const Accuracy accuracy : {Accuracy::fast, Accuracy::exact}) {
    StateSpaceModel truth = test::random_system(noise, 4, 2, 2);
    truth.y0 << 3, -1;
    const Record record = test::with_gap(test::excited(truth, noise, 700, 0), 300, 320);
    const Response found = fit_response(truth.A, truth.C, true, record, record.all(), accuracy);
    EXPECT_LT((found.model.B - truth.B).norm(), 1e-7);
    EXPECT_LT((found.model.D - truth.D).norm(), 1e-7);
    EXPECT_LT((found.model.y0 - truth.y0).norm(), 1e-7);
    EXPECT_LT(output_error(found, record), 1e-7);
  }
}

TEST(Response, AgreesWithExplicitRegressors) {
  test::Noise noise(2);
  const StateSpaceModel truth = test::random_system(noise, 3, 2, 2);
  const Record record = test::with_gap(test::excited(truth, noise, 160, 0.2), 60, 75);
  const auto naive = test::naive_n4sid(record, 3, 4, Weighting::moesp);
  for (const Accuracy accuracy : {Accuracy::fast, Accuracy::exact}) {
    const Response found =
        fit_response(naive.model.A, naive.model.C, true, record, record.all(), accuracy);
    EXPECT_LT((found.model.B - naive.model.B).norm(), 1e-6 * naive.model.B.norm());
    EXPECT_LT((found.model.D - naive.model.D).norm(), 1e-6 * naive.model.D.norm());
    EXPECT_LT((found.model.y0 - naive.model.y0).norm(), 1e-6);
    EXPECT_LT((found.x0 - naive.x0).norm(), 1e-5 * naive.x0.norm());
  }
}

/// A system of two inputs that differ by noise of the size `apart` times theirs.
struct AlmostEqualInputs {
  explicit AlmostEqualInputs(double apart)
      : truth(test::random_system(noise, 2, 2, 1)),
        record(test::excited(truth, noise, 400, 0)),
        between(noise.normal(400, 1)) {
    record.u.col(1) = record.u.col(0) + apart * between;
    record.y = test::simulated(truth, record.u, Vector::Zero(2));
  }

  test::Noise noise{3};
  StateSpaceModel truth;
  Record record;
  Matrix between;
};

TEST(Response, FallsBackWhereTheNormalEquationsLoseTooMuch) {
  const AlmostEqualInputs inputs(1e-6);
  const StateSpaceModel& truth = inputs.truth;
  const Record& record = inputs.record;
  const Response found = fit_response(truth.A, truth.C, true, record, record.all(), Accuracy::fast);
  EXPECT_LT(output_error(found, record), 1e-12);
  EXPECT_LT((found.model.B - truth.B).norm(), 1e-6);
}

TEST(Response, OfAlmostEqualInputsIsAsNearAndSharesTheEffectBesideNoise) {
  AlmostEqualInputs inputs(1e-7);
  const StateSpaceModel& truth = inputs.truth;
  Record& record = inputs.record;
  record.y += 0.01 * record.y.norm() / 20 * inputs.noise.normal(400, 1);
  const auto fitted = [&](Accuracy accuracy) {
    return fit_response(truth.A, truth.C, true, record, record.all(), accuracy);
  };
  const Response fast = fitted(Accuracy::fast), exact = fitted(Accuracy::exact);
  EXPECT_LT(output_error(fast, record), 1.01 * output_error(exact, record));
  for (const Response& found : {fast, exact})
    EXPECT_LT((found.model.B.col(0) - found.model.B.col(1)).norm(), 1e-3 * found.model.B.norm());
}

TEST(Response, FollowsWhatInputsThatAreAlmostEqualTellBesideNoise) {
  AlmostEqualInputs inputs(3e-6);
  const StateSpaceModel& truth = inputs.truth;
  Record& record = inputs.record;
  Matrix alone = Matrix::Zero(400, 2);
  alone.col(1) = inputs.between;
  record.y = test::simulated(truth, alone, Vector::Zero(2));
  record.y += 0.002 * record.y.norm() / 20 * inputs.noise.normal(400, 1);
  const auto error = [&](Accuracy accuracy) {
    return output_error(fit_response(truth.A, truth.C, true, record, record.all(), accuracy),
                        record);
  };
  EXPECT_LT(error(Accuracy::fast), 1.01 * error(Accuracy::exact));
}

TEST(Response, OfEqualInputsSharesTheEffect) {
  test::Noise noise(4);
  const StateSpaceModel truth = test::random_system(noise, 2, 2, 1);
  Record record = test::excited(truth, noise, 300, 0);
  record.u.col(1) = record.u.col(0);
  record.y = test::simulated(truth, record.u, Vector::Zero(2));
  const Response found =
      fit_response(truth.A, truth.C, true, record, record.all(), Accuracy::exact);
  EXPECT_LT(output_error(found, record), 1e-10);
  EXPECT_LT((found.model.B.col(0) - found.model.B.col(1)).norm(), 1e-9);
}

TEST(Response, SegmentsShorterThanTheOrderDoNoHarm) {
  test::Noise noise(5);
  const StateSpaceModel truth = test::random_system(noise, 5, 1, 1);
  Record record = test::excited(truth, noise, 400, 0);
  record.segments = {{0, 2, 0}, {2, 3, 50}, {3, 400, 90}};  // starts again at rows 2 and 3
  for (const Accuracy accuracy : {Accuracy::fast, Accuracy::exact})
    EXPECT_LT(
        (fit_response(truth.A, truth.C, true, record, record.all(), accuracy).model.B - truth.B)
            .norm(),
        1e-6);
}

TEST(Refinement, LowersTheOutputErrorTowardsTheTruth) {
  test::Noise noise(6);
  for (const Index outputs : {1, 2}) {
    const StateSpaceModel truth = test::random_system(noise, 3, 1, outputs, 0.9);
    const Record record = test::with_gap(test::excited(truth, noise, 1500, 0.1), 600, 650);
    const Matrix A = truth.A * 0.97;  // a start that is off
    const Response start = fit_response(A, truth.C, true, record, record.all(), Accuracy::fast);
    const Response refined = refine_response(A, truth.C, true, record, record.all(), 30);
    const Response best =
        fit_response(truth.A, truth.C, true, record, record.all(), Accuracy::fast);
    EXPECT_LT(output_error(refined, record), output_error(start, record));
    EXPECT_LT(output_error(refined, record), 1.001 * output_error(best, record));
    EXPECT_LT(test::pole_distance(refined.model, truth), 0.02);
    EXPECT_TRUE(is_stable(refined.model.A));
    EXPECT_NEAR(refined.error, output_error(refined, record), 1e-3 * refined.error)
        << "but for the state after the gap, which a free run takes from a few rows";
  }
}

TEST(Refinement, OfNoStepsIsTheFit) {
  test::Noise noise(7);
  const StateSpaceModel truth = test::random_system(noise, 2, 1, 1);
  const Record record = test::excited(truth, noise, 300, 0.1);
  const Response fit = fit_response(truth.A, truth.C, true, record, record.all(), Accuracy::fast);
  EXPECT_EQ(refine_response(truth.A, truth.C, true, record, record.all(), 0).model.B, fit.model.B);
}

TEST(Regression, HasNoSubnormalNumbersHoweverLongTheSegmentIs) {
  test::Noise noise(1);
  const StateSpaceModel model = test::random_system(noise, 4, 2, 1, 0.9);
  const Record record = test::excited(model, noise, 20'000, 0.1);
  Index subnormal = 0;
  walk_regression({4, 2, 1, true, false}, model, record, record.segments.front(), {},
                  [&subnormal](const RegressionRows& rows) {
                    subnormal +=
                        (rows.values.array() != 0 && rows.values.array().abs() < 1e-300).count();
                  });
  EXPECT_EQ(subnormal, 0);
}

}  // namespace
}  // namespace reident::identification::output_error_fit_test
