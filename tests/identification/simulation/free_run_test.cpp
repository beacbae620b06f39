#include "identification/simulation/free_run.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/identification/simulation/holed_record.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::free_run_test {
namespace {

StateSpaceModel with_operating_point(test::Noise& noise) {
  StateSpaceModel model = test::random_system(noise, 3, 2, 2);
  model.u0 << 4, -7;
  model.y0 << 28, 3;
  return model;
}

TEST(FreeRun, FollowsTheEquationsOfTheModel) {
  test::Noise noise(1);
  const StateSpaceModel model = with_operating_point(noise);
  const Matrix u = noise.normal(50, 2);
  const Vector x0 = noise.normal(3, 1);
  const Matrix y = test::simulated(model, u, x0);
  const Record record = contiguous_record(1, u, Matrix::Zero(50, 2));
  EXPECT_LT((free_run(model, record, record.all(), x0) - y).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(FreeRun, EstimatesTheStateOfEverySegment) {
  test::Noise noise(2);
  const StateSpaceModel model = with_operating_point(noise);
  const Matrix u = noise.normal(90, 2);
  const Record record = test::with_gap(
      contiguous_record(1, u, test::simulated(model, u, noise.normal(3, 1))), 40, 55);
  EXPECT_LT((free_run(model, record, record.all()) - record.y).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((free_run(model, record, {20, 70}) - record.y.middleRows(20, 50)).norm(), 1e-9);
}

TEST(FreeRun, CarriesSlowStatesThroughAHoleAndTakesFastOnesFromTheOutputsBehindIt) {
  test::Noise noise(7);
  const Matrix fast = noise.normal(600, 1);
  EXPECT_LT(test::HoledRecord(noise, fast).error_behind_the_hole(), 0.05)
      << "of inputs unknown in the hole";
  Matrix slow(600, 1);
  for (Index k = 0; k < 600; ++k) slow(k, 0) = std::sin(double(k) * 0.01);
  const test::HoledRecord holed(noise, slow);
  EXPECT_LT(holed.error_behind_the_hole(), 0.01);
  // Outputs that drift away from the run do not take it with them.
  Record drifted = holed.record;
  for (Index k = 0; k < drifted.rows(); ++k) drifted.y(k, 0) += 0.01 * double(k);
  const Matrix run = free_run(holed.model, drifted, drifted.all(), Vector::Zero(2));
  EXPECT_NEAR(run(run.rows() - 1, 0), holed.y(599, 0), 0.1);
}

/// Every seventh row is missing, as where frames get lost, and one of the inputs makes large steps:
/// the run of a model that errs by the other one must show its error all the same.
TEST(FreeRun, ShowsThroughManyShortHolesWhatItShowsWithoutThem) {
  test::Noise noise(11);
  StateSpaceModel truth{Matrix::Constant(1, 1, 0.998),
                        (Matrix(1, 2) << 0.01, 0.002).finished(),
                        Matrix::Ones(1, 1),
                        Matrix::Zero(1, 2),
                        {},
                        Vector::Zero(2),
                        Vector::Zero(1),
                        1};
  constexpr Index rows = 12600;
  Matrix u(rows, 2);
  for (Index k = 0; k < rows; ++k)
    u.row(k) << 10.0 * double(k / 2000 % 2), std::sin(double(k) * 0.001);
  const Record whole = contiguous_record(
      1, u, test::simulated(truth, u, Vector::Zero(1)) + 0.01 * noise.normal(rows, 1));
  StateSpaceModel wrong = truth;
  wrong.B(0, 1) *= 1.1;
  Record holed{1, Matrix(rows / 7 * 6, 2), Matrix(rows / 7 * 6, 1), {}};
  for (Index tick = 0, row = 0; tick < rows; tick += 7, row += 6) {
    holed.u.middleRows(row, 6) = whole.u.middleRows(tick, 6);
    holed.y.middleRows(row, 6) = whole.y.middleRows(tick, 6);
    holed.segments.push_back({row, row + 6, tick});
  }
  const auto error = [&wrong](const Record& record) {
    return (free_run(wrong, record, record.all()) - record.y).norm() / record.y.norm();
  };
  EXPECT_NEAR(error(holed) / error(whole), 1, 0.1);
}

TEST(FreeRun, OfAnUnstableModelMayOverflowButEnds) {
  StateSpaceModel model{Matrix::Constant(1, 1, 1e10),
                        Matrix::Ones(1, 1),
                        Matrix::Ones(1, 1),
                        Matrix::Zero(1, 1),
                        {},
                        Vector::Zero(1),
                        Vector::Zero(1),
                        1};
  const Record record = contiguous_record(1, Matrix::Ones(100, 1), Matrix::Ones(100, 1));
  EXPECT_FALSE(free_run(model, record, record.all()).allFinite());
}

TEST(FreeRun, OfManyStatesThatHandOnAValueIsThatOfTheModelAfterADelay) {
  constexpr Index delay = 40, rows = 300;
  test::Noise noise(4);
  const StateSpaceModel model = with_operating_point(noise);
  StateSpaceModel delayed = model;  // its first input acts after so many rows
  const Index n = model.order(), all = n + delay;
  delayed.A = Matrix::Zero(all, all);
  delayed.A.topLeftCorner(n, n) = model.A;
  delayed.A.col(all - 1).head(n) = model.B.col(0);
  delayed.A.block(n + 1, n, delay - 1, delay - 1).setIdentity();
  delayed.B = Matrix::Zero(all, 2);
  delayed.B.col(1).head(n) = model.B.col(1);
  delayed.B(n, 0) = 1;
  delayed.C = Matrix::Zero(2, all);
  delayed.C.leftCols(n) = model.C;
  delayed.C.col(all - 1) = model.D.col(0);
  delayed.D.col(0).setZero();
  const Matrix u = noise.normal(rows, 2);
  Matrix shifted = u;
  shifted.col(0).head(delay).setConstant(model.u0(0));
  shifted.col(0).tail(rows - delay) = u.col(0).head(rows - delay);
  const Matrix y = test::simulated(model, shifted, Vector::Zero(n));
  const Record record = contiguous_record(1, u, y);
  const Vector at_rest = Vector::Zero(all);
  EXPECT_LT((free_run(delayed, record, record.all(), at_rest) - y).cwiseAbs().maxCoeff(), 1e-12);
  const Record holed = test::with_gap(record, 100, 110);
  const Matrix bridged = free_run(delayed, holed, holed.all(), at_rest);
  EXPECT_LT((bridged.bottomRows(100) - y.bottomRows(100)).norm(), 1e-3 * y.bottomRows(100).norm());
}

TEST(FreeRun, OfNoRowsIsEmpty) {
  test::Noise noise(3);
  const Record record = contiguous_record(1, noise.normal(5, 2), noise.normal(5, 2));
  EXPECT_EQ(free_run(with_operating_point(noise), record, {2, 2}).rows(), 0);
}

}  // namespace
}  // namespace reident::identification::free_run_test
