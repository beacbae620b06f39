#include "identification/simulation/simulate.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::simulate_test {
namespace {

StateSpaceModel with_operating_point(test::Noise& noise) {
  StateSpaceModel model = test::random_system(noise, 3, 2, 2);
  model.u0 << 4, -7;
  model.y0 << 28, 3;
  return model;
}

std::vector<Index> record_rows_without(Index begin, Index end, Index rows) {
  std::vector<Index> left;
  for (Index k = 0; k < rows; ++k)
    if (k < begin || k >= end) left.push_back(k);
  return left;
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

/// An integrator beside a fast state, measured with noise of 0.1; rows 400 to 403 are missing.
struct Holed {
  StateSpaceModel model{(Matrix(2, 2) << 1, 0, 0, 0.2).finished(),
                        (Matrix(2, 1) << 0.01, 1).finished(),
                        Matrix::Ones(1, 2),
                        Matrix::Zero(1, 1),
                        {},
                        Vector::Zero(1),
                        Vector::Zero(1),
                        1};
  Matrix y;  // without noise
  Record record;

  Holed(test::Noise& noise, const Matrix& u) {
    y = test::simulated(model, u, Vector::Zero(2));
    record = test::with_gap(contiguous_record(1, u, y + 0.1 * noise.normal(u.rows(), 1)), 400, 404);
  }
  double error_behind_the_hole() const {
    const Matrix run = free_run(model, record, record.all(), Vector::Zero(2));
    const Index rows = record.rows() - 400;
    return (run.bottomRows(rows) - y.bottomRows(rows)).norm() / std::sqrt(double(rows));
  }
};

TEST(FreeRun, CarriesSlowStatesThroughAHoleAndTakesFastOnesFromTheOutputsBehindIt) {
  test::Noise noise(7);
  const Matrix fast = noise.normal(600, 1);
  EXPECT_LT(Holed(noise, fast).error_behind_the_hole(), 0.05) << "of inputs unknown in the hole";
  Matrix slow(600, 1);
  for (Index k = 0; k < 600; ++k) slow(k, 0) = std::sin(double(k) * 0.01);
  const Holed holed(noise, slow);
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

TEST(FreeRun, OfNoRowsIsEmpty) {
  test::Noise noise(3);
  const Record record = contiguous_record(1, noise.normal(5, 2), noise.normal(5, 2));
  EXPECT_EQ(free_run(with_operating_point(noise), record, {2, 2}).rows(), 0);
}

TEST(InitialState, DoesNotRestOnTheFewRowsBeforeAHole) {
  test::Noise noise(7);
  const Matrix u = noise.normal(1500, 1);
  const Holed holed(noise, u);
  Record record = contiguous_record(
      1, u, holed.y + 0.1 * noise.normal(u.rows(), 1));  // six rows, a hole of two, and the rest
  record = test::with_gap(record, 6, 8);
  const Vector alone =
      estimate_initial_state(holed.model, record, {record.segments.front()}, state_rows);
  const Vector x0 = estimate_initial_state(holed.model, record, record.segments, state_rows);
  EXPECT_GT(std::abs(alone(0)), 0.02);
  EXPECT_LT(std::abs(x0(0)), 0.02) << "the integrator began at 0";
  const Matrix run = free_run(holed.model, record, record.all());
  const Matrix y = holed.y(record_rows_without(6, 8, u.rows()), Eigen::all);
  EXPECT_LT((run - y).bottomRows(1400).cwiseAbs().maxCoeff(), 0.02);
}

/// An integrator beside five fast states; no part between the holes has more rows than there are.
TEST(InitialState, DoesNotRestOnTheFirstRowsWhereEverySeventhIsMissing) {
  test::Noise noise(9);
  StateSpaceModel model{Matrix::Zero(6, 6),
                        Matrix::Ones(6, 1),
                        Matrix::Ones(1, 6),
                        Matrix::Zero(1, 1),
                        {},
                        Vector::Zero(1),
                        Vector::Zero(1),
                        1};
  model.A.diagonal() << 1, 0.1, 0.2, 0.3, 0.4, 0.5;
  model.B(0, 0) = 0.01;
  constexpr Index parts = 100;
  double of_all = 0, of_the_first = 0;  // sums of squares
  for (int i = 0; i < 20; ++i) {
    const Matrix u = noise.normal(7 * parts, 1);
    const Matrix y = test::simulated(model, u, Vector::Zero(6)) + 0.1 * noise.normal(u.rows(), 1);
    Record record{1, Matrix(6 * parts, 1), Matrix(6 * parts, 1), {}};
    for (Index part = 0; part < parts; ++part) {
      record.u.middleRows(6 * part, 6) = u.middleRows(7 * part, 6);
      record.y.middleRows(6 * part, 6) = y.middleRows(7 * part, 6);
      record.segments.push_back({6 * part, 6 * part + 6, 7 * part});
    }
    const std::vector<Segment> first{record.segments.front()};
    of_all += std::pow(estimate_initial_state(model, record, record.segments, state_rows)(0), 2);
    of_the_first += std::pow(estimate_initial_state(model, record, first, state_rows)(0), 2);
  }
  EXPECT_LT(std::sqrt(of_all / of_the_first), 0.6);
}

TEST(InitialState, ComesFromTheOtherOutputsWhereOneIsZero) {
  test::Noise noise(10);
  const Matrix u = noise.normal(600, 1);
  const Holed holed(noise, u);
  Record record = test::with_gap(contiguous_record(1, u, holed.y), 100, 102);
  const Vector alone = estimate_initial_state(holed.model, record, record.segments, state_rows);
  StateSpaceModel model = holed.model;
  model.C.conservativeResizeLike(Matrix::Zero(2, 2));
  model.D = Matrix::Zero(2, 1);
  model.y0 = Vector::Zero(2);
  record.y.conservativeResizeLike(Matrix::Zero(record.rows(), 2));
  const Vector x0 = estimate_initial_state(model, record, record.segments, state_rows);
  EXPECT_LT((x0 - alone).norm(), 1e-6);
}

TEST(InitialState, IsThatOfItsOwnRowsBeforeALongHole) {
  test::Noise noise(8);
  const Matrix u = noise.normal(1500, 1);
  const Holed holed(noise, u);
  const Record record = test::with_gap(contiguous_record(1, u, holed.y), 100, 300);
  const std::vector<Segment> first{record.segments.front()};
  EXPECT_EQ(estimate_initial_state(holed.model, record, record.segments, state_rows),
            estimate_initial_state(holed.model, record, first, state_rows));
}

TEST(InitialState, IsOfLeastNormWhereItCannotBeSeen) {
  StateSpaceModel model{Matrix::Identity(2, 2) * 0.5,
                        Matrix::Zero(2, 1),
                        Matrix(1, 2),
                        Matrix::Zero(1, 1),
                        {},
                        Vector::Zero(1),
                        Vector::Zero(1),
                        1};
  model.C << 1, 1;  // sees the sum alone
  Matrix y(4, 1);
  y << 4, 2, 1, 0.5;
  const Record record = contiguous_record(1, Matrix::Zero(4, 1), y);
  const Vector x0 = estimate_initial_state(model, record, {record.segments[0]}, 4);
  EXPECT_NEAR(x0(0), 2, 1e-12);
  EXPECT_NEAR(x0(1), 2, 1e-12);
}

TEST(Score, IsTheErrorOverTheSignalAndOverItsSpread) {
  Matrix y(4, 1), y_hat(4, 1);
  y << 1, 3, 1, 3;
  y_hat << 1, 3, 1, 1;
  const Score s = score(y, y_hat);
  EXPECT_NEAR(s.mrse_percent(0), 100 * 2 / std::sqrt(20), 1e-12);
  EXPECT_NEAR(s.fit_percent(0), 100 * (1 - 2 / std::sqrt(4)), 1e-12);
  EXPECT_EQ(s.rows, 4);
}

TEST(Score, OfSeveralOutputsTakesTheMeanErrorAndTheWorstFit) {
  Score s{Vector(2), Vector(2), 5};
  s.mrse_percent << 1, 3;
  s.fit_percent << 90, 70;
  EXPECT_DOUBLE_EQ(s.mrse(), 2);
  EXPECT_DOUBLE_EQ(s.fit(), 70);
}

TEST(Score, OfDeadOutputsHasTheLimits) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Matrix zero = Matrix::Zero(5, 1), constant = Matrix::Constant(5, 1, 0.1);
  EXPECT_EQ(score(zero, constant).mrse_percent(0), infinity);
  EXPECT_EQ(score(zero, constant).fit_percent(0), -infinity);
  EXPECT_EQ(score(constant, zero).fit_percent(0), -infinity);
  EXPECT_EQ(score(constant, constant).mrse_percent(0), 0);
  EXPECT_EQ(score(constant, constant).fit_percent(0), 100);
}

TEST(Score, OfANonFiniteRunIsTheWorst) {
  const Matrix y = Matrix::Random(5, 1);
  const Score s = score(y, Matrix::Constant(5, 1, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_EQ(s.mrse_percent(0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(s.fit_percent(0), -std::numeric_limits<double>::infinity());
}

TEST(Score, OfAFreeRunCountsTheScoredRowsAlone) {
  test::Noise noise(4);
  const StateSpaceModel model = with_operating_point(noise);
  Record record = test::excited(model, noise, 200, 0);
  record.y.topRows(100).array() += 5;  // wrong where it is not scored, once the state has settled
  const Score s = score_free_run(model, record, {0, 200}, {180, 200}, Vector::Zero(3));
  EXPECT_EQ(s.rows, 20);
  EXPECT_LT(s.mrse(), 0.1);
}

}  // namespace
}  // namespace reident::identification::simulate_test
