#include "identification/subspace/projection.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "identification/subspace/shift_invariance.hpp"
#include "tests/identification/subspace/plain_compression.hpp"
#include "tests/support/naive_n4sid.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::projection_test {
namespace {

constexpr Weighting weightings[] = {Weighting::n4sid, Weighting::moesp, Weighting::cva};

StateSpaceModel with(const Dynamics& dynamics) {
  const Index n = dynamics.A.rows(), p = dynamics.C.rows();
  return {dynamics.A, Matrix(n, 0), dynamics.C, Matrix(p, 0), {}, Vector(0), Vector::Zero(p), 1};
}

Dynamics identified(const Record& record, Index order, Index horizon, Weighting weighting) {
  return shift_invariant(
      Projection(test::compressed(record, horizon)).observability(weighting).gamma, record.y.cols(),
      order);
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
      const auto observability =
          Projection(test::compressed(record, c.horizon)).observability(weighting);
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

TEST(Subspace, InputInnovationsShowWhereAnInputIsForetold) {
  const Index rows = 500;
  test::Noise noise(5);
  Matrix u(rows, 2);
  for (Index k = 0; k < rows; ++k) u.row(k) << std::sin(0.3 * double(k)), noise.normal();
  const Record record = contiguous_record(1, u, noise.normal(rows, 1));
  const Matrix innovations = Projection(test::compressed(record, 6)).input_innovations();
  EXPECT_GT(innovations(1, 0), 1e-3);
  EXPECT_LT(innovations(2, 0), 1e-10) << "a sine follows from two samples";
  EXPECT_NEAR(innovations(5, 1), 1, 0.2);
}

}  // namespace
}  // namespace reident::identification::projection_test
