// Fragments: every bit comes back, and damage is reported.
#include "storage/chunks/fragment.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/storage/chunks/chunk_fixture.hpp"

namespace reident::storage::test::fragment_test {
namespace {

constexpr TimeRange always{std::numeric_limits<Time>::min(), std::numeric_limits<Time>::max()};

std::vector<std::uint8_t> encoded(const Columns& columns) {
  std::vector<std::uint8_t> bytes;
  encode_fragment(columns.samples(), bytes);
  return bytes;
}

Columns decoded(const std::vector<std::uint8_t>& bytes, TimeRange range = always) {
  Columns columns;
  const auto error = decode_fragment(bytes, range, columns.target());
  EXPECT_FALSE(error) << error->message;
  return columns;
}

/// With jitter, mixed qualities and sources where `odd` says so.
Columns any_columns(std::mt19937_64& random, std::size_t count, bool odd) {
  Columns columns;
  Time time = static_cast<Time>(random());
  if (time > 0) time = -time;
  for (std::size_t i = 0; i < count; ++i) {
    columns.time.push_back(time);
    time += odd ? 1 + static_cast<Time>(random() % 3'000'000'000) : 1'000'000'000;
    columns.value.push_back(std::bit_cast<double>(random()));
    columns.quality.push_back(odd ? qualities[random() % qualities.size()] : Quality::suspect);
    columns.source.push_back(odd ? static_cast<std::int64_t>(random()) : 7);
  }
  return columns;
}

TEST(Fragment, GivesEveryBitBack) {
  std::mt19937_64 random(20170717);
  for (const std::size_t count : {1U, 2U, 3U, 100U, 5000U})
    for (const bool odd : {false, true}) {
      const Columns columns = any_columns(random, count, odd);
      EXPECT_TRUE(same(decoded(encoded(columns)), columns)) << count << " samples, odd: " << odd;
    }
}

TEST(Fragment, GivesEachQualityBackAndNoOther) {
  Columns columns = columns_of(std::vector<double>(qualities.size(), 28.5));
  std::copy(qualities.begin(), qualities.end(), columns.quality.begin());
  EXPECT_TRUE(same(decoded(encoded(columns)), columns));
  for (const Quality quality : qualities) {
    columns.quality.assign(columns.time.size(), quality);
    EXPECT_TRUE(same(decoded(encoded(columns)), columns)) << name(quality);
  }
  columns.quality.back() = static_cast<Quality>(qualities.size());
  Columns target;
  const auto error = decode_fragment(encoded(columns), always, target.target());
  EXPECT_EQ(error ? error->message : "none", "has a quality that is none");
}

TEST(Fragment, GivesTheSamplesOfARangeAlone) {
  std::mt19937_64 random(7);
  const Columns columns = any_columns(random, 200, true);
  const auto bytes = encoded(columns);
  for (int i = 0; i < 200; ++i) {
    TimeRange range{columns.time[random() % 200], columns.time[random() % 200]};
    EXPECT_TRUE(same(decoded(bytes, range), cut(columns, range)));
  }
}

TEST(Fragment, OfOneSampleIsSmall) {
  Columns columns = columns_of({28.5});
  EXPECT_LE(encoded(columns).size(), 29U);
}

TEST(Fragment, TellsEachDamagedByteAndLeavesTheTargetAsItWas) {
  std::mt19937_64 random(8);
  const Columns columns = any_columns(random, 20, true);
  const auto whole = encoded(columns);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    auto bytes = whole;
    bytes[i] ^= static_cast<std::uint8_t>(1 + random() % 255);
    Columns target = columns_of({1, 2});
    EXPECT_TRUE(decode_fragment(bytes, always, target.target())) << "byte " << i;
    EXPECT_TRUE(same(target, columns_of({1, 2})));
    bytes = whole;
    bytes.resize(i);
    EXPECT_TRUE(decode_fragment(bytes, always, target.target())) << "cut at " << i;
  }
}

}  // namespace
}  // namespace reident::storage::test::fragment_test
