// The kernels against the equations that they run, for every size that has a code of its own and
// for larger ones.
#include "identification/numerics/kernels.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace reident::identification::kernels_test {
namespace {

constexpr Index steps = 50;

Matrix random_matrix(Index rows, Index columns, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Matrix::NullaryExpr(rows, columns, [&] { return uniform(random); });
}

TEST(Kernels, RunTheStateSpaceEquationsOfAnySize) {
  std::mt19937 random(1);
  for (Index n = 0; n <= 14; ++n)
    for (const Index m : {0, 1, 3, 40})
      for (const Index p : {1, 2}) {
        Matrix M = random_matrix(n + p, n + m, random);
        M.topLeftCorner(n, n) /= double(n) + 1;
        const Matrix v = random_matrix(m, steps, random);
        Vector x = random_matrix(n, 1, random), state = x, work(n + p);
        Matrix expected(p, steps), y(p, steps);
        for (Index k = 0; k < steps; ++k) {
          expected.col(k) = M.bottomLeftCorner(p, n) * x + M.bottomRightCorner(p, m) * v.col(k);
          x = (M.topLeftCorner(n, n) * x + M.topRightCorner(n, m) * v.col(k)).eval();
        }
        // In two calls: the state is carried on.
        run_state_space(M.data(), n, m, p, v.data(), 20, state.data(), work.data(), y.data());
        run_state_space(M.data(), n, m, p, v.data() + 20 * m, steps - 20, state.data(), work.data(),
                        y.data() + 20 * p);
        EXPECT_LT((y - expected).norm(), 1e-12 * (1 + expected.norm()))
            << n << ' ' << m << ' ' << p;
        EXPECT_LT((state - x).norm(), 1e-12 * (1 + x.norm())) << n << ' ' << m << ' ' << p;
      }
}

TEST(Kernels, RunTheDualFiltersOfAnySize) {
  std::mt19937 random(2);
  for (Index n = 0; n <= 14; ++n)
    for (const Index inputs : {1, 4, 16, 35}) {
      const Matrix At = random_matrix(n, n, random) / (double(n) + 1);
      const Vector c = random_matrix(n, 1, random);
      const Matrix v = random_matrix(inputs, steps, random);
      Matrix X = random_matrix(n, inputs, random), states = X;
      const Index stride = n * inputs + 3;  // what lies between is left alone
      Matrix expected = Matrix::Constant(stride, steps, 7), out = expected;
      for (Index k = 0; k < steps; ++k) {
        expected.col(k).head(n * inputs) = X.reshaped();
        X = (At * X + c * v.col(k).transpose()).eval();
      }
      run_dual_filters(At.data(), c.data(), n, inputs, v.data(), 20, states.data(), out.data(),
                       stride);
      run_dual_filters(At.data(), c.data(), n, inputs, v.data() + 20 * inputs, steps - 20,
                       states.data(), out.data() + 20 * stride, stride);
      EXPECT_LT((out - expected).norm(), 1e-12 * (1 + expected.norm())) << n << ' ' << inputs;
      EXPECT_LT((states - X).norm(), 1e-12 * (1 + X.norm())) << n << ' ' << inputs;
    }
}

/// To the last bit, since the sums have the order of the rows whatever the processor.
TEST(Kernels, SumOuterProductsOfAnySize) {
  std::mt19937 random(3);
  for (Index height = 1; height <= 52; ++height)
    for (Index width = 1; width <= 13; ++width) {
      const Matrix a = random_matrix(height, steps, random),
                   b = random_matrix(width, steps, random);
      Matrix sums = Matrix::Zero(height, width);
      for (Index k = 0; k < steps; ++k)
        for (Index j = 0; j < width; ++j)
          for (Index i = 0; i < height; ++i) sums(i, j) += a(i, k) * b(j, k);
      const Matrix before = random_matrix(height, width, random), expected = before + sums;
      Matrix S = before;
      add_outer_products({a.data(), height, height}, {b.data(), width, width}, steps,
                         Triangle::full, S.data());
      EXPECT_EQ(S, expected) << height << ' ' << width;
      S = before;
      add_outer_products({a.data(), height, height}, {b.data(), width, width}, steps,
                         Triangle::lower, S.data());
      for (Index j = 0; j < std::min(height, width); ++j)
        EXPECT_EQ(S.col(j).tail(height - j), expected.col(j).tail(height - j))
            << height << ' ' << width << ' ' << j;
    }
}

}  // namespace
}  // namespace reident::identification::kernels_test
