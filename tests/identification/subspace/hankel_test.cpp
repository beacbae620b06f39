#include "identification/subspace/hankel.hpp"

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::hankel_test {
namespace {

constexpr TickRange all_ticks{INT64_MIN, INT64_MAX};

/// The Hankel matrix in full, its rows in the factor's order.
Matrix explicit_hankel(const Record& record, Index s) {
  const Index m = record.u.cols(), p = record.y.cols();
  Matrix H(1 + 2 * s * (m + p), 0);
  for (const Segment& segment : record.segments)
    for (Index t = segment.begin; t + 2 * s <= segment.end; ++t) {
      Vector column(H.rows());
      column(0) = 1;
      Index at = 1;
      const auto put = [&](const Matrix& channels, Index begin) {
        for (Index k = begin; k < begin + s; ++k)
          for (Index c = 0; c < channels.cols(); ++c) column(at++) = channels(k, c);
      };
      put(record.u, t + s);
      put(record.u, t);
      put(record.y, t);
      put(record.y, t + s);
      H.conservativeResize(Eigen::NoChange, H.cols() + 1);
      H.rightCols(1) = column;
    }
  return H;
}

Record gapped(test::Noise& noise) {
  return test::with_gap(contiguous_record(1, noise.normal(300, 2), noise.normal(300, 1)), 100, 104);
}

TEST(Compression, SegmentsShorterThanTheBlockRowsGiveNothing) {
  EXPECT_EQ(hankel_columns({{0, 5, 0}, {5, 8, 9}, {8, 20, 30}}, 6), 7);
  EXPECT_EQ(hankel_columns({{0, 5, 0}}, 6), 0);
}

TEST(Hankel, FactorsKeepEveryInnerProductOfTheRows) {
  test::Noise noise(1);
  const Record record = gapped(noise);
  const Index s = 4;
  const RangeSums sums = sums_of_rows(record, all_ticks, 2 * s);
  const Normalisation normalisation = normalisation_of(sums, 2);
  const Record work = normalised(record, record.all(), normalisation);
  const Matrix H = explicit_hankel(work, s), gram = H * H.transpose();
  const auto from_sums = factor_of_sums(sums, normalisation, s);
  ASSERT_TRUE(from_sums);
  for (const HankelFactor& factor : {*from_sums, factor_of_rows(work, work.segments, s)}) {
    EXPECT_EQ(factor.columns, H.cols());
    // Sums are centred by the mean and the row of ones shows only what is left of it.
    EXPECT_LT((factor.L * factor.L.transpose() - gram).norm(), 1e-12 * gram.norm());
    EXPECT_TRUE(factor.L.isLowerTriangular());
  }
}

TEST(Hankel, SumsOfMoreBlockRowsServeAShorterHorizon) {
  test::Noise noise(2);
  const Record record = gapped(noise);
  const RangeSums sums = sums_of_rows(record, all_ticks, 24);
  const Normalisation normalisation = normalisation_of(sums, 2);
  const auto longer = factor_of_sums(sums, normalisation, 4);
  const auto exact = factor_of_sums(sums_of_rows(record, all_ticks, 8), normalisation, 4);
  ASSERT_TRUE(longer && exact);
  EXPECT_EQ(longer->columns, exact->columns);
  EXPECT_LT((longer->L - exact->L).norm(), 1e-10 * exact->L.norm());
}

TEST(Hankel, AnOperatingPointAMillionTimesTheSignalCostsNoDigits) {
  test::Noise noise(3);
  const Record small = gapped(noise);
  Record large = small;
  large.u.array() += 1e6;
  large.y.array() -= 3e6;
  const Index s = 4;
  const auto factor = [&](const Record& record) {
    const RangeSums sums = sums_of_rows(record, all_ticks, 2 * s);
    return factor_of_sums(sums, normalisation_of(sums, 2), s).value().L;
  };
  // The samples themselves are rounded to 1e-10 of the signal.
  EXPECT_LT((factor(large) - factor(small)).norm(), 1e-8 * factor(small).norm());
}

TEST(Hankel, SumsThatLostTooMuchAreRefused) {
  test::Noise noise(4);
  Record record = gapped(noise);
  record.u.col(1) = record.u.col(0) + 1e-7 * record.u.col(1);
  const RangeSums sums = sums_of_rows(record, all_ticks, 8);
  EXPECT_FALSE(factor_of_sums(sums, normalisation_of(sums, 2), 4));
}

TEST(Hankel, SegmentsShorterThanTheBlockRowsGiveNoColumns) {
  EXPECT_EQ(hankel_columns({{0, 5, 0}, {5, 8, 9}, {8, 20, 30}}, 6), 7);
  EXPECT_EQ(hankel_columns({{0, 5, 0}}, 6), 0);
}

}  // namespace
}  // namespace reident::identification::hankel_test
