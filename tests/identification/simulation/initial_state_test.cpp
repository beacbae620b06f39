#include "identification/simulation/initial_state.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "identification/simulation/free_run.hpp"
#include "tests/identification/simulation/holed_record.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::initial_state_test {
namespace {

std::vector<Index> record_rows_without(Index begin, Index end, Index rows) {
  std::vector<Index> left;
  for (Index k = 0; k < rows; ++k)
    if (k < begin || k >= end) left.push_back(k);
  return left;
}

TEST(InitialState, DoesNotRestOnTheFewRowsBeforeAHole) {
  test::Noise noise(7);
  const Matrix u = noise.normal(1500, 1);
  const test::HoledRecord holed(noise, u);
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

/// An integrator and five fast states; no part between the holes has more rows than there are.
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
  const test::HoledRecord holed(noise, u);
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
  const test::HoledRecord holed(noise, u);
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

}  // namespace
}  // namespace reident::identification::initial_state_test
