#include "identification/fit/adaptation.hpp"

#include <cmath>
#include <cstdint>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "identification/simulation/free_run.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::adaptation_test {
namespace {

double output_error(const StateSpaceModel& model, const Record& record) {
  return (record.y - free_run(model, record, record.all())).norm() /
         std::sqrt(double(record.rows()));
}

TEST(Adaptation, FindsGainsAndOffsetThatMovedAndKeepsThePoles) {
  test::Noise noise(1);
  const StateSpaceModel known = test::random_system(noise, 4, 2, 2);
  StateSpaceModel truth = known;
  truth.B *= 1.4;
  truth.D.col(1) *= 0.5;
  truth.y0 << 3, -1;
  const Record record = test::with_gap(test::excited(truth, noise, 900, 0), 300, 320);
  const StateSpaceModel found = adapted(known, record, record.all(), KnownFrom::other_rows);
  EXPECT_EQ(found.A, known.A);
  EXPECT_EQ(found.C, known.C);
  EXPECT_LT((found.B - truth.B).norm(), 1e-6);
  EXPECT_LT((found.D - truth.D).norm(), 1e-6);
  EXPECT_LT((found.y0 - truth.y0).norm(), 1e-6);
}

TEST(Adaptation, OfAModelThatFitsChangesNothing) {
  test::Noise noise(2);
  const StateSpaceModel known = test::random_system(noise, 3, 2, 1);
  const Record record = test::excited(known, noise, 600, 0);
  const StateSpaceModel found = adapted(known, record, record.all(), KnownFrom::other_rows);
  EXPECT_LT((found.B - known.B).norm() + (found.D - known.D).norm(), 1e-8);
  EXPECT_LT((found.y0 - known.y0).norm(), 1e-8);
}

TEST(Adaptation, LeavesTheGainOfAnInputThatDoesNotMove) {
  test::Noise noise(3);
  StateSpaceModel known = test::random_system(noise, 3, 2, 1);
  known.u0 << 0.5, -2;
  StateSpaceModel truth = known;
  truth.B.col(0) *= 1.5;
  truth.y0 << 0.3;
  Record record = test::excited(known, noise, 600, 0);
  record.u.col(1).setConstant(0.1);
  record.y = test::simulated(truth, record.u, Vector::Zero(3));
  const StateSpaceModel found = adapted(known, record, record.all(), KnownFrom::other_rows);
  EXPECT_EQ(found.B.col(1), known.B.col(1));
  EXPECT_EQ(found.D.col(1), known.D.col(1));
  EXPECT_LT((found.B.col(0) - truth.B.col(0)).norm(), 1e-6);
  EXPECT_LT((found.y0 - truth.y0).norm(), 1e-6);
  EXPECT_LT(output_error(found, record), 1e-6);
}

TEST(Adaptation, OfInputsThatDoNotMoveFindsTheOffset) {
  test::Noise noise(5);
  const StateSpaceModel known = test::random_system(noise, 3, 2, 1);
  Record record = test::excited(known, noise, 600, 0);
  record.u.setConstant(0.1);
  record.y = test::simulated(known, record.u, Vector::Ones(3)).array() + 2;
  const StateSpaceModel found = adapted(known, record, record.all(), KnownFrom::other_rows);
  EXPECT_EQ(found.B, known.B);
  EXPECT_NEAR(found.y0(0), known.y0(0) + 2, 1e-6);
}

/// Two currents into a node, what flows out of it, and a model that makes much of their sum.
struct Node {
  StateSpaceModel truth, mistaken;
  Record record;
  Vector balance;  // of the inputs
};

Node node(double imbalance, std::uint64_t seed = 6, double sensor_noise = 0.02, Index held = 1) {
  test::Noise noise(seed);
  const Index rows = 2000;
  Matrix u = noise.normal(rows, 3);
  for (Index k = 1; k < rows; ++k) u.row(k) += 0.95 * u.row(k - 1);
  u.col(2) = u.col(0) + u.col(1);
  Vector slow = noise.normal(rows, 1);
  for (Index k = 1; k < rows; ++k) slow(k) += 0.95 * slow(k - 1);
  Matrix seen = u + sensor_noise * noise.normal(rows, 3);
  seen.col(2) += imbalance * slow;
  for (Index k = 0; k < rows; ++k) seen.row(k) = seen.row(k - k % held).eval();
  Node result{test::random_system(noise, 2, 3, 1), {}, {}, Eigen::Vector3d(1, 1, -1)};
  result.truth.u0.setZero();
  result.truth.B -= result.truth.B * result.balance * result.balance.transpose() / 3;
  result.truth.D -= result.truth.D * result.balance * result.balance.transpose() / 3;
  result.mistaken = result.truth;
  result.mistaken.B += 50 * Vector::Ones(2) * result.balance.transpose();
  result.record = contiguous_record(
      1, seen, test::simulated(result.truth, seen, Vector::Zero(2)) + 0.1 * noise.normal(rows, 1));
  return result;
}

TEST(Adaptation, DropsTheGainOfASumThatShowsNoiseAlone) {
  const Node one = node(0);
  const StateSpaceModel found =
      adapted(one.mistaken, one.record, one.record.all(), KnownFrom::these_rows);
  EXPECT_LT((found.B * one.balance).norm(), 0.01 * (one.mistaken.B * one.balance).norm());
  EXPECT_LT(output_error(found, one.record), 1.1 * output_error(one.truth, one.record));
}

TEST(Adaptation, DropsTheGainOfASumOfNoiseThatIsHeld) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Node one = node(0, seed, 0.02, 4);
    const StateSpaceModel found =
        adapted(one.mistaken, one.record, one.record.all(), KnownFrom::these_rows);
    EXPECT_LT((found.B * one.balance).norm(), 0.01 * (one.mistaken.B * one.balance).norm());
  }
}

TEST(Adaptation, FitsNoGainOfASumThatIsZeroButForRounding) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Node one = node(0, seed, 0);
    for (const KnownFrom from : {KnownFrom::other_rows, KnownFrom::these_rows}) {
      const StateSpaceModel found = adapted(one.truth, one.record, one.record.all(), from);
      EXPECT_LT((found.B - one.truth.B).norm(), one.truth.B.norm());
      EXPECT_LT((found.y0 - one.truth.y0).norm(), 1);
    }
  }
}

TEST(Adaptation, KeepsTheGainOfASumThatOtherSamplesHaveTold) {
  const Node one = node(0);
  const StateSpaceModel found =
      adapted(one.mistaken, one.record, one.record.all(), KnownFrom::other_rows);
  EXPECT_LT(((found.B - one.mistaken.B) * one.balance).norm(),
            0.05 * (one.mistaken.B * one.balance).norm());
}

TEST(Adaptation, FitsTheGainOfASumThatCarriesOnFromSampleToSample) {
  const Node one = node(0.1);
  for (const KnownFrom from : {KnownFrom::other_rows, KnownFrom::these_rows}) {
    const StateSpaceModel found = adapted(one.mistaken, one.record, one.record.all(), from);
    EXPECT_LT(((found.B - one.truth.B) * one.balance).norm(), 0.2 * one.truth.B.norm());
  }
}

/// A model of a fast mode and of one that lasts longer than the rows do, whose errors change slowly
/// as those of a model that is a little wrong.
struct SlowMode {
  explicit SlowMode(std::uint64_t seed) : known(test::random_system(noise, 2, 1, 1)) {
    noise = test::Noise(seed);
    known.A = Eigen::Vector2d(0.9, 0.9995).asDiagonal();
    known.B << 1, 0.01;
    known.C << 1, 1;
    Vector u = noise.normal(rows, 1);
    Vector error = noise.normal(rows, 1);
    for (Index k = 1; k < rows; ++k) u(k) += 0.9 * u(k - 1);
    for (Index k = 1; k < rows; ++k) error(k) += 0.99 * error(k - 1);
    record = contiguous_record(1, u, test::simulated(known, u, Vector::Zero(2)) + 0.1 * error);
  }

  static double static_gain(const StateSpaceModel& model) {
    return (model.C * (Matrix::Identity(2, 2) - model.A).inverse() * model.B + model.D)(0);
  }

  static constexpr Index rows = 800;
  test::Noise noise{7};
  StateSpaceModel known;
  Record record;
};

TEST(Adaptation, LeavesTheGainOfAModeThatIsSlowerThanTheRowsTell) {
  double moved_by_others = 0, moved_by_these = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const SlowMode one(seed);
    const auto moved = [&one](KnownFrom from) {
      return std::abs(
          SlowMode::static_gain(adapted(one.known, one.record, one.record.all(), from)) -
          SlowMode::static_gain(one.known));
    };
    moved_by_others += moved(KnownFrom::other_rows);
    moved_by_these += moved(KnownFrom::these_rows);
  }
  EXPECT_LT(moved_by_others, 0.5 * moved_by_these);
}

TEST(Adaptation, MovesNothingWhereTheRowsAreFewerThanTheUnknowns) {
  const SlowMode one(1);
  const StateSpaceModel found = adapted(one.known, one.record, {0, 5}, KnownFrom::other_rows);
  EXPECT_EQ(found.B, one.known.B);
  EXPECT_EQ(found.D, one.known.D);
}

TEST(Adaptation, FollowsAGainThatTheRowsTellAmongErrorsThatLast) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SlowMode one(seed);
    StateSpaceModel truth = one.known;
    truth.B(0) *= 1.4;
    one.record.y += test::simulated(truth, one.record.u, Vector::Zero(2)) -
                    test::simulated(one.known, one.record.u, Vector::Zero(2));
    const StateSpaceModel found =
        adapted(one.known, one.record, one.record.all(), KnownFrom::other_rows);
    EXPECT_NEAR(found.B(0), truth.B(0), 0.1);
  }
}

TEST(Adaptation, FollowsEachOfTwoOutputsOfOtherScalesAndMovesTheOtherHardlyMoreThanNoiseDoes) {
  constexpr int seeds = 20;
  constexpr double scale = 1e-3;  // of the second output
  double wrong = 0, known_wrong = 0, moved = 0, moved_by_noise = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    test::Noise noise(seed);
    StateSpaceModel known = test::random_system(noise, 3, 2, 2);
    known.C.row(1) *= scale;
    known.D.row(1) *= scale;
    StateSpaceModel truth = known;
    truth.D.row(1) *= 1.5;
    Record record = test::excited(truth, noise, 900, 0);
    Matrix errors = noise.normal(900, 2);
    for (Index i = 0; i < 2; ++i)
      errors.col(i) *= 0.1 * (record.y.col(i).array() - record.y.col(i).mean()).matrix().norm() /
                       std::sqrt(900.0);
    record.y += errors;
    const StateSpaceModel found = adapted(known, record, record.all(), KnownFrom::other_rows);
    const auto off = [&](const StateSpaceModel& model, Index i) {
      return (model.D.row(i) - truth.D.row(i)).norm() / truth.D.row(i).norm();
    };
    wrong += off(found, 1);
    known_wrong += off(known, 1);
    moved += std::pow(off(found, 0), 2);
    Matrix regressors(900, 3);
    regressors << record.u, Vector::Ones(900);
    const Vector fitted = regressors.colPivHouseholderQr().solve(errors.col(0));
    moved_by_noise += std::pow(fitted.head(2).norm() / truth.D.row(0).norm(), 2);
  }
  EXPECT_LT(wrong, 0.5 * known_wrong);
  EXPECT_LT(moved, 2 * moved_by_noise);
}

TEST(Adaptation, LooksAtTheRowsThatItIsGivenAlone) {
  test::Noise noise(4);
  const StateSpaceModel known = test::random_system(noise, 3, 2, 1);
  StateSpaceModel truth = known;
  truth.B *= 0.7;
  const Record record = test::excited(truth, noise, 800, 0);
  Record spoilt = record;
  spoilt.y.bottomRows(300).array() += 5;
  const RowRange rows{0, 500};
  EXPECT_EQ(adapted(known, record, rows, KnownFrom::other_rows).B,
            adapted(known, spoilt, rows, KnownFrom::other_rows).B);
  EXPECT_LT((adapted(known, record, rows, KnownFrom::other_rows).B - truth.B).norm(), 1e-6);
}

}  // namespace
}  // namespace reident::identification::adaptation_test
