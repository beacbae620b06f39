#include "identification/subspace/lag_sums.hpp"

#include <gmock/gmock.h>

#include "tests/support/same_bits.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::lag_sums_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr Index L = 6;

Matrix channels(const Record& record) {
  Matrix z(record.rows(), record.u.cols() + record.y.cols());
  z << record.u, record.y;
  return z.transpose();
}

Record noise_record(Index rows, double offset = 0) {
  test::Noise noise(1);
  return contiguous_record(1, noise.normal(rows, 2).array() + offset,
                           noise.normal(rows, 1).array() - offset);
}

/// The definition: sums of z[t+tau] z[t]' over a segment, z less its mean.
Matrix lag_products(const Matrix& z) {
  const Matrix centred = z.colwise() - Vector(z.rowwise().mean());
  Matrix F = Matrix::Zero(L * z.rows(), z.rows());
  for (Index tau = 0; tau < L; ++tau)
    for (Index t = 0; t + tau < z.cols(); ++t)
      F.middleRows(tau * z.rows(), z.rows()) += centred.col(t + tau) * centred.col(t).transpose();
  return F;
}

/// Relative to products of samples of deviation 1.
double distance(SegmentSums a, const Matrix& z) {
  a.refer_to(z.rowwise().mean());
  return (a.products() - lag_products(z)).norm() / double(z.cols());
}

TEST(SegmentSums, AreTheLagProductsOfTheCentredSamples) {
  for (const Index rows : {1, 3, 5, 6, 7, 100}) {
    const Matrix z = channels(noise_record(rows));
    EXPECT_LT(distance(SegmentSums(z, 0, L), z), 1e-13) << rows;
  }
}

TEST(SegmentSums, OfAdjacentSegmentsAddUpHoweverShortTheyAre) {
  const Matrix z = channels(noise_record(40));
  for (const Index cut : {1, 2, 4, 5, 6, 20, 36, 39}) {
    SegmentSums sums(z.leftCols(cut), 7, L);
    sums.append(SegmentSums(z.rightCols(40 - cut), 7 + cut, L));
    EXPECT_EQ(sums.ticks(), (TickRange{7, 47}));
    EXPECT_LT(distance(sums, z), 1e-13) << "cut at " << cut;
    EXPECT_LT((sums.first().colwise() + sums.reference() - z.leftCols(L - 1)).norm(), 1e-13);
    EXPECT_LT((sums.last().colwise() + sums.reference() - z.rightCols(L - 1)).norm(), 1e-13);
  }
  SegmentSums one_by_one(z.col(0), 0, L);
  for (Index t = 1; t < 40; ++t) one_by_one.append(SegmentSums(z.col(t), t, L));
  EXPECT_LT(distance(one_by_one, z), 1e-13);
}

TEST(SegmentSums, KeepTheirDigitsBesideAnOperatingPointAMillionTimesTheSignal) {
  const Matrix z = channels(noise_record(300, 1e6));
  SegmentSums sums(z.leftCols(100), 0, L);
  sums.append(SegmentSums(z.rightCols(200), 100, L));
  EXPECT_LT(distance(sums, z), 1e-13);
}

TEST(LagSums, AWindowIsTheSameToTheLastBitHoweverItsSumsCameAbout) {
  const Record record = test::with_gap(noise_record(900, 5), 333, 340);
  const LagSums::Shape shape{3, L, 50};
  LagSums kept(shape);
  const TickRange window{117, 861};
  for (std::int64_t end = 200; end < 900; end += 50) kept.keep_over({end - 200, end}, record);
  EXPECT_TRUE(test::same_bits(kept.keep_over(window, record), LagSums(shape).over(window, record)));
  kept.forget({400, 401});
  EXPECT_TRUE(test::same_bits(kept.over(window, record), LagSums(shape).over(window, record)));
}

TEST(LagSums, AgreeWithOneSumOverTheWindow) {
  const Record record = noise_record(500);
  const RangeSums sums = LagSums({3, L, 32}).over({10, 490}, record);
  ASSERT_EQ(sums.segments.size(), 1u);
  EXPECT_LT(distance(sums.segments[0], channels(record).middleCols(10, 480)), 1e-13);
}

TEST(LagSums, SplitAtGaps) {
  const Record record = test::with_gap(noise_record(200), 90, 95);
  const RangeSums sums = LagSums({3, L, 32}).over({0, 200}, record);
  ASSERT_EQ(sums.segments.size(), 2u);
  EXPECT_EQ(sums.segments[0].ticks(), (TickRange{0, 90}));
  EXPECT_EQ(sums.segments[1].ticks(), (TickRange{95, 200}));
  EXPECT_EQ(sums.rows(), 195);
}

TEST(LagSums, SayWhichSamplesTheyStillNeed) {
  const Record record = noise_record(400);
  LagSums kept({3, L, 50});
  EXPECT_THAT(kept.missing({20, 280}), ElementsAre(TickRange{20, 280}));
  kept.keep_over({0, 200}, record);
  EXPECT_THAT(kept.missing({50, 200}), IsEmpty());
  EXPECT_THAT(kept.missing({40, 310}), ElementsAre(TickRange{40, 50}, TickRange{200, 310}));
  kept.forget({120, 121});
  EXPECT_THAT(kept.missing({50, 200}), ElementsAre(TickRange{100, 150}));
}

TEST(LagSums, CostWhatTheSamplesCostHoweverLongTheGaps) {
  Record record = noise_record(400);
  constexpr std::int64_t far = 1'000'000'000'000;
  record.segments = {{0, 200, 0}, {200, 400, far}};
  LagSums kept({3, L, 50});
  const RangeSums sums = kept.keep_over({0, far + 200}, record);
  ASSERT_EQ(sums.segments.size(), 2u);
  EXPECT_EQ(sums.rows(), 400);
  EXPECT_LT(kept.kept_nodes(), 200u);
  EXPECT_TRUE(test::same_bits(kept.keep_over({0, far + 200}, record), sums));
}

TEST(LagSums, WindowsBeforeTheEpochAreCutLikeOthers) {
  Record record = noise_record(300);
  record.segments[0].first_tick = -130;
  const RangeSums sums = LagSums({3, L, 50}).over({-130, 170}, record);
  ASSERT_EQ(sums.segments.size(), 1u);
  EXPECT_LT(distance(sums.segments[0], channels(record)), 1e-13);
}

}  // namespace
}  // namespace reident::identification::lag_sums_test
