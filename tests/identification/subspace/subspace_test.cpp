#include "identification/subspace/subspace.hpp"

#include <gtest/gtest.h>

#include "identification/search/model_search.hpp"
#include "identification/subspace/kalman.hpp"
#include "tests/support/naive_n4sid.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::subspace_test {
namespace {

constexpr Weighting weightings[] = {Weighting::n4sid, Weighting::moesp, Weighting::cva};

StateSpaceModel with(const Dynamics& dynamics) {
  const Index n = dynamics.A.rows(), p = dynamics.C.rows();
  return {dynamics.A, Matrix(n, 0), dynamics.C, Matrix(p, 0), {}, Vector(0), Vector::Zero(p), 1};
}

/// Channels as they are.
Normalisation no_normalisation(const Record& record) {
  const Index m = record.u.cols(), p = record.y.cols();
  Normalisation result{Vector::Zero(m), Vector::Ones(m), Vector::Zero(p), Vector::Ones(p), {}, {}};
  for (Index i = 0; i < m; ++i) result.inputs.push_back(i);
  for (Index q = 0; q < p; ++q) result.outputs.push_back(q);
  return result;
}

HankelFactor compressed(const Record& record, Index horizon) {
  const TickRange all{INT64_MIN, INT64_MAX};
  return compress(sums_of_rows(record, all, 2 * horizon), no_normalisation(record), record,
                  record.segments, horizon);
}

Dynamics identified(const Record& record, Index order, Index horizon, Weighting weighting) {
  return shift_invariant(Projection(compressed(record, horizon)).observability(weighting).gamma,
                         record.y.cols(), order);
}

TEST(Compression, SegmentsShorterThanTheBlockRowsGiveNothing) {
  EXPECT_EQ(hankel_columns({{0, 5, 0}, {5, 8, 9}, {8, 20, 30}}, 6), 7);
  EXPECT_EQ(hankel_columns({{0, 5, 0}}, 6), 0);
}

TEST(Subspace, AgreesWithTheExplicitHankelMatrices) {
  test::Noise noise(2);
  struct {
    Index order, inputs, outputs, horizon;
  } const cases[] = {{2, 1, 1, 5}, {3, 2, 1, 6}, {4, 1, 2, 5}, {3, 3, 2, 4}};
  for (const auto& c : cases) {
    const StateSpaceModel truth = test::random_system(noise, c.order, c.inputs, c.outputs);
    const Record record = test::with_gap(test::excited(truth, noise, 400, 0.1), 150, 170);
    for (const Weighting weighting : weightings) {
      const auto naive = test::naive_n4sid(record, c.order, c.horizon, weighting);
      const auto observability = Projection(compressed(record, c.horizon)).observability(weighting);
      const Index count = observability.singular_values.size();
      EXPECT_LT((observability.singular_values - naive.singular_values.head(count)).norm(),
                1e-7 * naive.singular_values.norm());
      const auto fast = with(identified(record, c.order, c.horizon, weighting));
      EXPECT_LT(test::pole_distance(fast, naive.model), 1e-6)
          << name(weighting) << " of order " << c.order;
    }
  }
}

TEST(Subspace, WithoutNoiseThePolesAreExact) {
  test::Noise noise(3);
  for (Index n = 1; n <= 6; ++n) {
    const StateSpaceModel truth = test::random_system(noise, n, 2, 1 + n % 2);
    const Record record = test::excited(truth, noise, 600, 0);
    for (const Weighting weighting : {Weighting::n4sid, Weighting::moesp})
      EXPECT_LT(test::pole_distance(with(identified(record, n, 10, weighting)), truth), 1e-6)
          << name(weighting) << " of order " << n;
  }
}

TEST(Subspace, FindsTheKalmanGainOfAnInnovationsForm) {
  test::Noise noise(4);
  StateSpaceModel truth = test::random_system(noise, 2, 1, 1, 0.8);
  truth.K = kalman_gain(truth.A, truth.C, Matrix::Identity(3, 3)).value();
  const Index rows = 40000;
  Record record = contiguous_record(1, noise.normal(rows, 1), Matrix(rows, 1));
  Vector x = Vector::Zero(2);
  for (Index k = 0; k < rows; ++k) {
    const double e = 0.5 * noise.normal();
    record.y(k, 0) = (truth.C * x + truth.D * record.u.row(k).transpose())(0) + e;
    x = truth.A * x + truth.B * record.u.row(k).transpose() + truth.K * e;
  }
  const Projection projection(compressed(record, 15));
  const Matrix W = projection.noise_covariance(truth);
  EXPECT_NEAR(W(2, 2), 0.25, 0.02) << "the innovation's variance";
  const auto K = kalman_gain(truth.A, truth.C, W);
  ASSERT_TRUE(K);
  EXPECT_LT((*K - truth.K).norm(), 0.05);
}

TEST(Subspace, InputInnovationsShowWhereAnInputIsForetold) {
  const Index rows = 500;
  test::Noise noise(5);
  Matrix u(rows, 2);
  for (Index k = 0; k < rows; ++k) u.row(k) << std::sin(0.3 * double(k)), noise.normal();
  const Record record = contiguous_record(1, u, noise.normal(rows, 1));
  const Matrix innovations = Projection(compressed(record, 6)).input_innovations();
  EXPECT_GT(innovations(1, 0), 1e-3);
  EXPECT_LT(innovations(2, 0), 1e-10) << "a sine follows from two samples";
  EXPECT_NEAR(innovations(5, 1), 1, 0.2);
}

}  // namespace
}  // namespace reident::identification::subspace_test
