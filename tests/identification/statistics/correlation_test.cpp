#include "identification/statistics/correlation.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::correlation_test {
namespace {

/// First-order noise of deviation 1.
Vector coloured(test::Noise& noise, Index rows, double phi) {
  Vector result(rows);
  double value = noise.normal();
  for (double& entry : result) {
    entry = value;
    value = phi * value + std::sqrt(1 - phi * phi) * noise.normal();
  }
  return result;
}

Series whole(Vector values) {
  const Index rows = values.size();
  return {std::move(values), {{0, rows}}};
}

TEST(Series, HasTheAutocorrelationOfItsDefinition) {
  test::Noise noise(1);
  const Vector x = coloured(noise, 100, 0.5);
  const std::vector<RowRange> segments{{0, 40}, {40, 47}, {47, 100}};
  Series series(x, segments);
  const Vector centred = x.array() - x.mean();
  for (Index lag = 0; lag < 60; ++lag) {
    double product = 0;
    for (const RowRange& segment : segments)
      for (Index t = segment.begin + lag; t < segment.end; ++t)
        product += centred(t - lag) * centred(t);
    EXPECT_NEAR(series.autocorrelation(lag), product / centred.squaredNorm(), 1e-14) << lag;
  }
  EXPECT_EQ(series.pairs(3), 37 + 4 + 50);
}

TEST(Series, SegmentsDoNotSpeakToEachOther) {
  // Each segment is one pulse; only across the gap are two pulses one row apart.
  Vector x = Vector::Zero(20);
  x(9) = x(10) = 1;
  Series joined = whole(x), parted(x, {{0, 10}, {10, 20}});
  EXPECT_GT(joined.autocorrelation(1), 0.4);
  EXPECT_LT(parted.autocorrelation(1), 0);
  EXPECT_EQ(parted.pairs(1), 18);
  EXPECT_EQ(parted.longest_segment(), 10);
}

TEST(Series, AConstantHasNoCorrelation) {
  Series constant = whole(Vector::Constant(30, 0.1));
  EXPECT_EQ(constant.autocorrelation(0), 0);
  EXPECT_EQ(constant.autocorrelation(5), 0);
}

TEST(Correlogram, HasAsManyLagsAsTheRowsAllow) {
  test::Noise noise(2);
  const auto lags = [&noise](std::vector<RowRange> segments) {
    const Vector values = noise.normal(segments.back().end, 1);
    Series series(values, std::move(segments));
    const Correlogram both = cross_correlogram(series, series, 25);
    const Index count = autocorrelogram(series, 25).r.size();
    EXPECT_EQ(both.r.size(), count == 0 ? 0 : 2 * count + 1);
    EXPECT_EQ(both.first_lag, -count);
    return count;
  };
  EXPECT_EQ(lags({{0, 200}}), 25);
  EXPECT_EQ(lags({{0, 40}}), 10);  // a quarter
  EXPECT_EQ(lags({{0, 10}, {10, 30}, {30, 50}, {50, 100}, {100, 200}, {200, 220}}), 25);
  EXPECT_EQ(lags({{0, 10}, {10, 25}, {25, 40}, {40, 60}, {60, 80}}), 19);
  EXPECT_EQ(lags({{0, 1}}), 0);
}

TEST(Correlogram, OfNoLagsSaysNothing) {
  Series single = whole(Vector::Ones(1));
  const Correlogram correlogram = autocorrelogram(single, 25);
  EXPECT_EQ(summary(correlogram).lags, 0);
  EXPECT_FALSE(summary(correlogram).significant());
  EXPECT_TRUE(portmanteau(single, correlogram).white());
}

TEST(Correlogram, OfAWhiteSeriesStaysWithinItsBoundAtNineteenOfTwentyLags) {
  test::Noise noise(3);
  double outside = 0;
  int not_white = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Series series(noise.normal(400, 1), {{0, 100}, {100, 160}, {160, 400}});
    const Correlogram correlogram = autocorrelogram(series, 25);
    outside += summary(correlogram).share_outside / 200;
    not_white += !portmanteau(series, correlogram).white();
  }
  EXPECT_NEAR(outside, 0.05, 0.01);
  EXPECT_NEAR(not_white / 200.0, 0.05, 0.03);
}

TEST(Correlogram, OfACorrelatedSeriesShowsThePowersOfItsCoefficient) {
  test::Noise noise(4);
  Series series = whole(coloured(noise, 20000, 0.7));
  const Correlogram correlogram = autocorrelogram(series, 25);
  for (Index i = 0; i < 5; ++i) EXPECT_NEAR(correlogram.r(i), std::pow(0.7, double(i + 1)), 0.03);
  const CorrelationSummary found = summary(correlogram);
  EXPECT_EQ(found.lags, 25);
  EXPECT_EQ(found.lag, 1);
  EXPECT_TRUE(found.significant());
  EXPECT_FALSE(portmanteau(series, correlogram).white());
}

TEST(CrossCorrelogram, IsLargestAtTheDelay) {
  test::Noise noise(5);
  const Vector u = noise.normal(1000, 1);
  for (const Index delay : {7, 0, -4}) {
    Vector e = noise.normal(1000, 1);
    for (Index t = 25; t < 975; ++t) e(t) += 0.5 * u(t - delay);
    Series input = whole(u), residual = whole(e);
    const CorrelationSummary found = summary(cross_correlogram(input, residual, 25));
    EXPECT_EQ(found.lag, delay);
    EXPECT_NEAR(found.largest, 0.5 / std::sqrt(1.25), 0.06);
    EXPECT_TRUE(found.significant());
  }
}

TEST(CrossCorrelogram, BoundsAccountForTheColourOfBoth) {
  // Independent, but slow: bounds for white signals would be broken at most lags.
  test::Noise noise(6);
  double outside = 0, broken = 0;
  int significant = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Series input = whole(coloured(noise, 2000, 0.9)), residual = whole(coloured(noise, 2000, 0.9));
    const Correlogram correlogram = cross_correlogram(input, residual, 25);
    outside += summary(correlogram).share_outside / 200;
    significant += summary(correlogram).significant();
    broken += double((correlogram.r.array().abs() > 1.96 / std::sqrt(2000.0)).count()) / 51 / 200;
  }
  EXPECT_NEAR(outside, 0.05, 0.03);
  EXPECT_LT(significant / 200.0, 0.08);
  EXPECT_GT(broken, 0.3);
}

TEST(BartlettFactor, IsTheSumOfTheProducts) {
  test::Noise noise(7);
  Series a = whole(coloured(noise, 20000, 0.9)), b = whole(coloured(noise, 20000, 0.8));
  Series white = whole(noise.normal(20000, 1));
  const double product = 0.9 * 0.8;
  EXPECT_NEAR(bartlett_factor(a, b) / ((1 + product) / (1 - product)), 1, 0.1);
  EXPECT_NEAR(bartlett_factor(a, white), 1, 0.1);
  EXPECT_NEAR(correlated_rows(a) / 19, 1, 0.2);
}

TEST(CorrelationSummary, ANumberThatIsNoneIsSignificant) {
  Series series = whole(Vector::Constant(30, std::numeric_limits<double>::quiet_NaN()));
  const Correlogram correlogram = autocorrelogram(series, 5);
  EXPECT_TRUE(summary(correlogram).significant());
  EXPECT_FALSE(portmanteau(series, correlogram).white());
}

}  // namespace
}  // namespace reident::identification::correlation_test
