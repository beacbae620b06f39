#include "identification/statistics/quantiles.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace reident::identification::quantiles_test {
namespace {

TEST(NormalQuantile, InvertsTheDistribution) {
  for (const double p : {1e-12, 1e-4, 0.025, 0.3, 0.5, 0.6, 0.975, 0.9999})
    EXPECT_NEAR(0.5 * std::erfc(-normal_quantile(p) / std::numbers::sqrt2), p, 1e-13 + 1e-9 * p);
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
}

TEST(ChiSquaredQuantile, IsThatOfTheTables) {
  const double tables[][2] = {{1, 3.841}, {10, 18.307}, {25, 37.652}, {100, 124.342}};
  for (const auto& [degrees, quantile] : tables)
    EXPECT_NEAR(chi_squared_quantile(0.95, degrees) / quantile, 1, degrees < 10 ? 0.025 : 0.001);
}

TEST(ChiSquaredLimit, IsThatOfTheTables) {
  const double tables[][3] = {{1, 0.05, 3.8415}, {1, 1e-6, 23.928},  {2, 1e-9, 41.446},
                              {4, 1e-6, 33.377}, {10, 0.05, 18.307}, {100, 0.05, 124.342}};
  for (const auto& [degrees, probability, limit] : tables)
    EXPECT_NEAR(chi_squared_limit(probability, int(degrees)) / limit, 1, 1e-4) << degrees;
  // With two degrees the distribution is exponential.
  EXPECT_NEAR(chi_squared_limit(1e-300, 2), 600 * std::log(10), 1e-9);
}

TEST(StudentQuantile, IsThatOfTheTables) {
  const double tables[][2] = {{5, 2.5706}, {9, 2.2622}, {20, 2.0860}, {249, 1.9695}};
  for (const auto& [degrees, quantile] : tables)
    EXPECT_NEAR(student_quantile(0.975, degrees) / quantile, 1, 0.0015) << degrees;
}

}  // namespace
}  // namespace reident::identification::quantiles_test
