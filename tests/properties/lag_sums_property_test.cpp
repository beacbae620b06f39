// Sums of samples do not depend on how they came about: which windows were asked for before, in
// which order the samples arrived, what was forgotten in between.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "identification/search/identify.hpp"
#include "identification/subspace/hankel.hpp"
#include "identification/subspace/lag_sums.hpp"
#include "tests/properties/any_record.hpp"
#include "tests/support/same_bits.hpp"

namespace reident::identification::lag_sums_property_test {
namespace {

using test::same_bits;

/// White channels about operating points of very different size, with gaps.
Record any_record(int max_rows) {
  test::Noise noise(*rc::gen::arbitrary<std::uint32_t>());
  const int rows = test::any_of(2, max_rows);
  const int m = test::any_of(0, 4), p = test::any_of(1, 3);
  Record record = contiguous_record(1, noise.normal(rows, m), noise.normal(rows, p));
  for (Index c = 0; c < m; ++c) record.u.col(c).array() += std::pow(10, 3 * c);
  test::cut(record, 8);
  return record;
}

TickRange ticks_of(const Record& record) {
  return {record.segments.front().first_tick,
          record.segments.back().first_tick + record.segments.back().size()};
}

/// A window in the record or a little around it; not empty.
TickRange any_range(const Record& record) {
  const TickRange whole = ticks_of(record);
  const std::int64_t begin = test::any_of(whole.begin - 50, whole.end);
  return {begin, test::any_of(begin + 1, whole.end + 50)};
}

LagSums::Shape any_shape(const Record& record) {
  return {record.u.cols() + record.y.cols(), test::any_of<Index>(1, 20),
          test::any_of<Index>(1, 130)};
}

RC_GTEST_PROP(LagSums, AWindowHasTheSameBitsWhateverWasKeptAndForgottenBefore, ()) {
  const Record record = any_record(900);
  const LagSums::Shape shape = any_shape(record);
  LagSums kept(shape);
  for (int step = test::any_of(1, 12); step > 0; --step) {
    if (test::any_of(0, 4) == 0)
      kept.forget(any_range(record));
    else
      kept.keep_over(any_range(record), record);
  }
  const TickRange window = any_range(record);
  const RangeSums fresh = LagSums(shape).over(window, record);
  RC_ASSERT(same_bits(kept.over(window, record), fresh));
  RC_ASSERT(same_bits(kept.keep_over(window, record), fresh));
  RC_ASSERT(same_bits(kept.keep_over(window, record), fresh));
}

RC_GTEST_PROP(LagSums, AWindowThatSlidesHasTheBitsOfOneFromScratch, ()) {
  const Record record = any_record(900);
  const LagSums::Shape shape = any_shape(record);
  LagSums kept(shape);
  TickRange window = any_range(record);
  for (int windows = 0; windows < 20; ++windows) {
    RC_ASSERT(same_bits(kept.keep_over(window, record), LagSums(shape).over(window, record)));
    const std::int64_t step = test::any_of(1, 200);
    window = {window.begin + step, window.end + step};
  }
}

RC_GTEST_PROP(LagSums, SamplesThatArriveInAnyOrderGiveTheSameBits, ()) {
  const Record record = any_record(900);
  const LagSums::Shape shape = any_shape(record);
  LagSums kept(shape);
  std::vector<TickRange> late;
  for (int i = test::any_of(1, 6); i > 0; --i) late.push_back(any_range(record));
  // The ranges come one by one, the last one first; each marks what it touches.
  while (!late.empty()) {
    const Record arrived = test::rows_where(record, [&late](std::int64_t tick) {
      return std::none_of(late.begin(), late.end(),
                          [tick](TickRange r) { return r.begin <= tick && tick < r.end; });
    });
    kept.keep_over(any_range(record), arrived);
    kept.forget(late.back());
    late.pop_back();
  }
  const TickRange window = any_range(record);
  RC_ASSERT(same_bits(kept.keep_over(window, record), LagSums(shape).over(window, record)));
}

RC_GTEST_PROP(LagSums, NothingIsReadBeyondWhatIsMissing, ()) {
  const Record record = any_record(900);
  const LagSums::Shape shape = any_shape(record);
  LagSums kept(shape);
  for (int step = test::any_of(0, 5); step > 0; --step) {
    kept.keep_over(any_range(record), record);
    if (*rc::gen::arbitrary<bool>()) kept.forget(any_range(record));
  }
  const TickRange window = any_range(record);
  const std::vector<TickRange> missing = kept.missing(window);
  for (std::size_t i = 0; i < missing.size(); ++i) {
    RC_ASSERT(window.begin <= missing[i].begin && missing[i].begin < missing[i].end);
    RC_ASSERT(missing[i].end <= window.end);
    if (i > 0) RC_ASSERT(missing[i - 1].end < missing[i].begin);
  }
  const Record read = test::rows_where(record, [&missing](std::int64_t tick) {
    return std::any_of(missing.begin(), missing.end(),
                       [tick](TickRange r) { return r.begin <= tick && tick < r.end; });
  });
  RC_ASSERT(same_bits(kept.keep_over(window, read), LagSums(shape).over(window, record)));
}

RC_GTEST_PROP(LagSums, ChunksFollowTimeAndNotTheRecord, ()) {
  // What lies around the window moves no boundary in it.
  const Record record = any_record(900);
  const LagSums::Shape shape = any_shape(record);
  const TickRange window = any_range(record), around = any_range(record);
  const Record less = test::rows_where(record, [&](std::int64_t tick) {
    return (window.begin <= tick && tick < window.end) ||
           (around.begin <= tick && tick < around.end);
  });
  RC_ASSERT(same_bits(LagSums(shape).over(window, less), LagSums(shape).over(window, record)));
}

RC_GTEST_PROP(LagSums, AddUpToTheProductsOfTheSamples, ()) {
  const Record record = any_record(400);
  const LagSums::Shape shape = any_shape(record);
  const TickRange window = any_range(record);
  const RangeSums sums = LagSums(shape).over(window, record);
  const Record inside = test::rows_where(
      record, [window](std::int64_t tick) { return window.begin <= tick && tick < window.end; });
  RC_ASSERT(sums.segments.size() == inside.segments.size());
  const Index w = shape.channels;
  for (std::size_t i = 0; i < sums.segments.size(); ++i) {
    SegmentSums summed = sums.segments[i];
    const Segment& segment = inside.segments[i];
    RC_ASSERT(summed.ticks().begin == segment.first_tick);
    RC_ASSERT(summed.count() == segment.size());
    Matrix z(w, segment.size());
    z << inside.u.middleRows(segment.begin, segment.size()).transpose(),
        inside.y.middleRows(segment.begin, segment.size()).transpose();
    summed.refer_to(z.rowwise().mean());
    const Matrix centred = z.colwise() - Vector(z.rowwise().mean());
    for (Index tau = 0; tau < shape.block_rows; ++tau) {
      const Index pairs = std::max<Index>(0, z.cols() - tau);
      const Matrix F = centred.rightCols(pairs) * centred.leftCols(pairs).transpose();
      // Operating points up to 1e6 leave ten digits of the samples themselves.
      RC_ASSERT((summed.products().middleRows(tau * w, w) - F).norm() <= 1e-8 * double(z.cols()));
    }
  }
}

RC_GTEST_PROP(LagSums, GiveTheFactorThatTheRowsGive, ()) {
  test::Setting s = test::any_setting({4, 4, 3});
  Record record = test::excited(s.truth, s.noise, 700, 0.3);
  test::cut(record, 6);
  const Index horizon = test::any_of(2, 8), m = record.u.cols();
  const LagSums::Shape shape{m + record.y.cols(), 2 * horizon + test::any_of(0, 9),
                             test::any_of<Index>(1, 130)};
  const RangeSums sums = LagSums(shape).over(ticks_of(record), record);
  const Normalisation normalisation = normalisation_of(sums, m);
  const Record work = normalised(record, record.all(), normalisation);
  const auto of_sums = factor_of_sums(sums, normalisation, horizon);
  RC_PRE(hankel_columns(record.segments, 2 * horizon) > 2 * (1 + 2 * horizon * shape.channels));
  RC_ASSERT(of_sums.has_value());
  const HankelFactor of_rows = factor_of_rows(work, work.segments, horizon);
  RC_ASSERT(of_sums->columns == of_rows.columns);
  const Matrix gram = of_rows.L * of_rows.L.transpose();
  RC_ASSERT((of_sums->L * of_sums->L.transpose() - gram).norm() < 1e-11 * gram.norm());
}

RC_GTEST_PROP(Identify, GivesTheSameBitsWhateverItsSumsWentThrough, ()) {
  test::Setting s = test::any_setting({4, 3, 2});
  Record record = test::excited(s.truth, s.noise, 1200, 0.1);
  test::cut(record, 3);
  IdentifyOptions options;
  options.order = test::any_of(1, 4);
  options.horizon = 6;
  const LagSums::Shape shape{record.u.cols() + record.y.cols(),
                             block_rows_needed(options) + test::any_of(0, 5),
                             test::any_of<Index>(20, 200)};
  const Index begin = test::any_of(0, 400), end = test::any_of(begin + 500, Index{1200});
  LagSums fresh(shape), used(shape);
  for (int step = test::any_of(1, 5); step > 0; --step) {
    used.keep_over(any_range(record), record);
    if (*rc::gen::arbitrary<bool>()) used.forget(any_range(record));
  }
  const IdentifyResult first = identify(record, {begin, end}, options, &fresh);
  RC_ASSERT(same_bits(identify(record, {begin, end}, options, &used), first));
  RC_ASSERT(same_bits(identify(record, {begin, end}, options, &fresh), first));
}

}  // namespace
}  // namespace reident::identification::lag_sums_property_test
