// Whatever goes into a chunk comes out of it, to the last bit.
#include <algorithm>
#include <iterator>
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "storage/chunks/integer_codec.hpp"
#include "storage/chunks/value_steps.hpp"
#include "tests/storage/chunks/chunk_fixture.hpp"

namespace reident::storage::test::chunk_property_test {
namespace {

constexpr Time second = 1'000'000'000;
constexpr Time least_time = std::numeric_limits<Time>::min();
constexpr Time greatest_time = std::numeric_limits<Time>::max();

rc::Gen<double> any_bits() {
  return rc::gen::map(rc::gen::arbitrary<std::uint64_t>(),
                      [](std::uint64_t bits) { return std::bit_cast<double>(bits); });
}

rc::Gen<double> special() {
  using Limits = std::numeric_limits<double>;
  return rc::gen::element(0.0, -0.0, Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(),
                          -Limits::quiet_NaN(), std::bit_cast<double>(0x7FF0000000000001),
                          std::bit_cast<double>(0xFFFFFFFFFFFFFFFF), Limits::max(),
                          Limits::lowest(), Limits::min(), Limits::denorm_min(), 0.1, 1.0);
}

/// k / 10^d, offset + step * k, or a walk of such steps: what calibrations and text give.
rc::Gen<double> stepped() {
  const int decimals = *rc::gen::inRange(0, 8);
  const double offset = *rc::gen::element(0.0, -40.0, 0.125, 1e-3);
  const double step = *rc::gen::element(125.0 / 65535, 0.1, -7.0 / 4095, 1e-9, 3e12);
  const int range = *rc::gen::element(2, 100, 70000);
  return rc::gen::oneOf(
      rc::gen::map(rc::gen::inRange(-range, range),
                   [=](int k) { return decimal_value(k, power_of_ten(decimals)); }),
      rc::gen::map(rc::gen::inRange(-range, range),
                   [=](int k) { return affine_value(k, offset, step); }));
}

/// Values of one kind, each held for a while; some with specials between.
std::vector<double> any_values(std::size_t count) {
  const auto kind = *rc::gen::inRange(0, 4);
  const rc::Gen<double> ordinary = kind == 0 ? any_bits() : stepped();
  const rc::Gen<double> each =
      kind == 1 ? rc::gen::weightedOneOf<double>({{20, ordinary}, {1, special()}}) : ordinary;
  const int hold = *rc::gen::element(1, 1, 3, 50);
  std::vector<double> values;
  while (values.size() < count) {
    const double value = kind == 2 ? *special() : *each;
    const int times = *rc::gen::inRange(1, hold + 1);
    values.insert(values.end(), static_cast<std::size_t>(times), value);
  }
  values.resize(count);
  return values;
}

/// Ascending: regular, with jitter, with gaps, or any at all.
std::vector<Time> any_times(std::size_t count) {
  const auto kind = *rc::gen::inRange(0, 4);
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  if (kind == 3) {
    std::set<Time> times{least_time, greatest_time};
    while (times.size() < count + 1) times.insert(static_cast<Time>(random()));
    const auto first = std::next(times.begin(), *rc::gen::inRange(0, 2));
    return {first, std::next(first, static_cast<std::ptrdiff_t>(count))};
  }
  std::vector<Time> times{1'500'000'000 * second};
  while (times.size() < count) {
    Time step = second;
    if (kind >= 1) step += static_cast<Time>(random() % 1'000'000);
    if (kind == 2 && random() % 10 == 0) step += static_cast<Time>(random() % 10'000) * second;
    times.push_back(times.back() + step);
  }
  return times;
}

Columns any_columns() {
  const auto count = *rc::gen::inRange<std::size_t>(1, 400);
  Columns columns;
  columns.time = any_times(count);
  columns.value = any_values(count);
  columns.quality = *rc::gen::container<std::vector<Quality>>(count, rc::gen::elementOf(qualities));
  columns.source = *rc::gen::container<std::vector<std::int64_t>>(
      count, *rc::gen::element(rc::gen::just<std::int64_t>(7), rc::gen::inRange<std::int64_t>(1, 4),
                               rc::gen::arbitrary<std::int64_t>()));
  return columns;
}

RC_GTEST_PROP(ChunkProperty, EverySampleComesBackToTheLastBit, ()) {
  const Columns columns = any_columns();
  ChunkEncoder encoder(*rc::gen::element(1, 6, 19));
  const auto chunk = encoder.encode(columns.samples());
  Columns back;
  RC_ASSERT(!ChunkDecoder().decode(chunk, back.target()));
  RC_ASSERT(same(back, columns));
  const auto summary = std::get<ChunkSummary>(read_summary(chunk));
  RC_ASSERT(summary.count == columns.time.size());
  for (const double value : columns.value) RC_ASSERT(!(value < summary.least));
  for (const double value : columns.value) RC_ASSERT(!(value > summary.greatest));
}

RC_GTEST_PROP(ChunkProperty, ARangeGivesTheSamplesInIt, ()) {
  const Columns columns = any_columns();
  const auto chunk = ChunkEncoder().encode(columns.samples());
  const auto any_index = rc::gen::inRange<std::size_t>(0, columns.time.size());
  const TimeRange range{columns.time[*any_index], columns.time[*any_index]};
  // The end of a range at the greatest time includes it; cut() knows half-open ranges alone.
  RC_PRE(range.end != greatest_time);
  Columns back;
  RC_ASSERT(!ChunkDecoder().decode(chunk, range, back.target()));
  RC_ASSERT(same(back, cut(columns, range)));
}

RC_GTEST_PROP(ChunkProperty, OneEncoderAndDecoderServeManyChunks, ()) {
  ChunkEncoder encoder;
  ChunkDecoder decoder;
  Columns all, back;
  for (int i = 0; i < 3; ++i) {
    const Columns columns = any_columns();
    const auto chunk = encoder.encode(columns.samples());
    RC_ASSERT(chunk == ChunkEncoder().encode(columns.samples()));
    RC_ASSERT(!decoder.decode(chunk, back.target()));
    all.time.insert(all.time.end(), columns.time.begin(), columns.time.end());
    all.value.insert(all.value.end(), columns.value.begin(), columns.value.end());
    all.quality.insert(all.quality.end(), columns.quality.begin(), columns.quality.end());
    all.source.insert(all.source.end(), columns.source.begin(), columns.source.end());
  }
  RC_ASSERT(same(back, all));
}

RC_GTEST_PROP(ChunkProperty, AChangedByteIsFound, ()) {
  const Columns columns = any_columns();
  auto chunk = ChunkEncoder().encode(columns.samples());
  chunk[*rc::gen::inRange<std::size_t>(0, chunk.size())] ^= *rc::gen::inRange<std::uint8_t>(1, 255);
  Columns back;
  RC_ASSERT(ChunkDecoder().decode(chunk, back.target()));
  RC_ASSERT(same(back, Columns{}));
}

RC_GTEST_PROP(IntegerCodecProperty, EverySequenceComesBackWholeAndInPart, ()) {
  const auto unit = *rc::gen::element<std::int64_t>(1, 10, 1'000'000'000, -3);
  const auto each =
      *rc::gen::element(rc::gen::arbitrary<std::int64_t>(), rc::gen::inRange<std::int64_t>(-3, 3),
                        rc::gen::element(std::numeric_limits<std::int64_t>::min(), std::int64_t{0},
                                         std::numeric_limits<std::int64_t>::max()));
  auto numbers = *rc::gen::nonEmpty(rc::gen::container<std::vector<std::int64_t>>(each));
  for (std::int64_t& number : numbers)
    number = static_cast<std::int64_t>(static_cast<std::uint64_t>(number) *
                                       static_cast<std::uint64_t>(unit));
  if (*rc::gen::arbitrary<bool>()) std::sort(numbers.begin(), numbers.end());
  std::vector<std::uint8_t> bytes;
  IntegerEncoder(6).put(numbers, bytes);
  const auto first = *rc::gen::inRange<std::size_t>(0, numbers.size());
  std::vector<std::int64_t> back(*rc::gen::inRange<std::size_t>(0, numbers.size() - first + 1));
  ByteReader in(bytes);
  RC_ASSERT(IntegerDecoder().get(in, numbers.size(), first, back));
  RC_ASSERT(in.at_end() && !in.failed());
  RC_ASSERT(
      std::equal(back.begin(), back.end(), numbers.begin() + static_cast<std::ptrdiff_t>(first)));
}

RC_GTEST_PROP(ValueStepsProperty, AFormulaThatIsFoundGivesTheValuesToTheLastBit, ()) {
  auto values = *rc::gen::container<std::vector<double>>(stepped());
  std::erase_if(values, [](double value) { return !is_countable(value); });
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (const auto decimal = find_decimal_steps(values))
    for (std::size_t i = 0; i < values.size(); ++i)
      RC_ASSERT(decimal_value(decimal->numbers[i], power_of_ten(decimal->decimals)) == values[i]);
  if (const auto near = find_near_steps(values))
    if (const auto affine = find_affine_steps(values, *near))
      for (std::size_t i = 0; i < values.size(); ++i)
        RC_ASSERT(affine_value(affine->numbers[i], affine->offset, affine->step) == values[i]);
}

}  // namespace
}  // namespace reident::storage::test::chunk_property_test
