#include "identification/screening/order_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::order_statistics_test {
namespace {

std::vector<double> sorted(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values;
}

/// Values of several kinds: what a sample of them says of a rank can be far off.
std::vector<std::vector<double>> kinds(std::size_t count) {
  test::Noise noise(count);
  std::vector<double> normal, steps, alternating, constant, rising, rare;
  for (std::size_t i = 0; i < count; ++i) {
    normal.push_back(noise.normal());
    steps.push_back(std::round(noise.normal()));
    alternating.push_back(i % 8 == 0 ? 1 : noise.normal());
    constant.push_back(3);
    rising.push_back(double(i));
    rare.push_back(i % 1000 == 999 ? 1e9 * noise.normal() : 0);
  }
  return {normal, steps, alternating, constant, rising, rare};
}

TEST(OrderStatistics, AreThoseOfTheSortedValues) {
  for (const std::size_t count : {1U, 2U, 7U, 1024U, 1025U, 4096U, 25'600U})
    for (const std::vector<double>& values : kinds(count)) {
      const std::vector<double> ascending = sorted(values);
      for (const double share : {0.0, 0.01, 0.25, 0.5, 0.75, 0.99, 0.9999, 1.0}) {
        const auto rank = static_cast<std::size_t>(share * double(count - 1));
        EXPECT_EQ(nth_smallest(values, rank), ascending[rank]) << count << " " << share;
        EXPECT_EQ(quantile(values, share), ascending[rank]);
      }
    }
}

}  // namespace
}  // namespace reident::identification::order_statistics_test
