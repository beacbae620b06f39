#include "storage/chunks/chunk.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <random>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/chunks/checksum.hpp"
#include "tests/storage/chunks/chunk_fixture.hpp"

namespace reident::storage::test::chunk_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using Chunk = std::vector<std::uint8_t>;

Columns ten_samples() {
  Columns columns = columns_of({20.5, 20.5, 20.6, 20.7, -0.0, 20.8, 20.8, 20.9, 20.9, 21.0});
  columns.quality[4] = Quality::suspect;
  columns.source[7] = 2;
  return columns;
}

Chunk encoded(const Columns& columns) {
  return ChunkEncoder().encode(columns.samples());
}

/// Makes the checksums right again, as one who wants to do harm would.
void seal(Chunk& chunk) {
  const auto put = [&](std::size_t at, std::uint64_t hash) {
    for (std::size_t i = 0; i < 8; ++i) chunk[at + i] = static_cast<std::uint8_t>(hash >> (8 * i));
  };
  put(64, xxh64(std::span(chunk).subspan(ChunkSummary::bytes)));
  put(72, xxh64(std::span(chunk).first(72)));
}

TEST(Checksum, IsXxh64AsItsSpecificationGivesIt) {
  const auto hash = [](std::string_view text) {
    return xxh64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(hash(""), 0xEF46DB3751D8E999U);
  EXPECT_EQ(hash("a"), 0xD24EC4F1A98C6E5BU);
  EXPECT_EQ(hash("abc"), 0x44BC2CF5AD770999U);
  EXPECT_EQ(hash("Nobody inspects the spammish repetition"), 0xFBCEA83C8A378BF1U);
}

TEST(Chunk, GivesEverySampleBack) {
  const Columns columns = ten_samples();
  Columns back;
  ASSERT_FALSE(ChunkDecoder().decode(encoded(columns), back.target()));
  EXPECT_TRUE(same(back, columns));
}

TEST(Chunk, GivesEachQualityBackAndNoOther) {
  Columns columns = columns_of(std::vector<double>(qualities.size() + 1, 28.5));
  const auto decoded = [&] {
    Columns back;
    const auto error = ChunkDecoder().decode(encoded(columns), back.target());
    return error ? error->message : same(back, columns) ? "the same" : "another";
  };
  for (const Quality quality : qualities) {
    columns.quality.assign(columns.time.size(), quality);
    EXPECT_EQ(decoded(), "the same") << name(quality);
  }
  std::copy(qualities.begin(), qualities.end(), columns.quality.begin());
  EXPECT_EQ(decoded(), "the same");
  const auto unknown = static_cast<Quality>(qualities.size());
  columns.quality.back() = unknown;
  EXPECT_EQ(decoded(), "has qualities that cannot be decoded");
  columns.quality.assign(columns.time.size(), unknown);
  EXPECT_EQ(decoded(), "has qualities that cannot be decoded");
}

// Archives hold chunks for as long as a mission flies: this one was written by format 1.
TEST(Chunk, OfFormat1IsReadForEver) {
  const std::string_view written =
      "7263686b010000000a000000470000000000167b0d12d114001a87930f12d1140000000000000080"
      "000000000000354000000000008034400000000000003540e50a140eee2785a975219987b639cf9e"
      "0c040180a8d6b90701000102081b000101000801000001010006069a0301000200010c0100010101"
      "000e04030002010600010001060300040e0403020101060001000106060001";
  Chunk chunk;
  for (std::size_t i = 0; i < written.size(); i += 2)
    chunk.push_back(
        static_cast<std::uint8_t>(std::stoi(std::string(written.substr(i, 2)), nullptr, 16)));
  Columns back;
  ASSERT_FALSE(ChunkDecoder().decode(chunk, back.target()));
  EXPECT_TRUE(same(back, ten_samples()));
}

TEST(Chunk, SaysWhatIsInsideBeforeItIsDecoded) {
  Columns columns = ten_samples();
  columns.value[3] = nan;
  const Chunk chunk = encoded(columns);
  const auto read = read_summary(std::span(chunk).first(ChunkSummary::bytes));
  ASSERT_TRUE(std::holds_alternative<ChunkSummary>(read));
  const auto& summary = std::get<ChunkSummary>(read);
  EXPECT_EQ(summary.count, 10U);
  EXPECT_EQ(summary.first_time, columns.time.front());
  EXPECT_EQ(summary.last_time, columns.time.back());
  EXPECT_EQ(summary.least, 0.0);
  EXPECT_EQ(summary.greatest, 21.0);
  EXPECT_EQ(summary.first_value, 20.5);
  EXPECT_EQ(summary.last_value, 21.0);
}

TEST(Chunk, HasALeastValueAboveTheGreatestWhereAllAreNaN) {
  const Chunk chunk = encoded(columns_of({nan, nan}));
  const auto summary = std::get<ChunkSummary>(read_summary(chunk));
  EXPECT_GT(summary.least, summary.greatest);
}

TEST(Chunk, AppendsToWhatTheTargetHolds) {
  const Columns columns = ten_samples();
  std::vector<double> values{1};
  ASSERT_FALSE(ChunkDecoder().decode(encoded(columns), {.value = &values}));
  ASSERT_EQ(values.size(), 11U);
  EXPECT_EQ(values[0], 1);
  EXPECT_EQ(values[1], 20.5);
}

TEST(Chunk, GivesTheSamplesOfARange) {
  const Columns columns = ten_samples();
  const Chunk chunk = encoded(columns);
  const Time least = std::numeric_limits<Time>::min();
  const Time greatest = std::numeric_limits<Time>::max();
  const Time first = columns.time.front();
  const Time last = columns.time.back();
  const Time second = 1'000'000'000;
  const std::vector<TimeRange> ranges{{least, greatest},
                                      {first, last},
                                      {first + 1, last + 1},
                                      {first + 2 * second, first + 5 * second},
                                      {first + 1, first + second},
                                      {last + 1, greatest},
                                      {least, first},
                                      {last, first}};
  for (const TimeRange& range : ranges) {
    Columns back;
    ASSERT_FALSE(ChunkDecoder().decode(chunk, range, back.target()));
    EXPECT_TRUE(same(back, cut(columns, range))) << range.begin << " to " << range.end;
  }
}

TEST(Chunk, IncludesTheGreatestTimeInARangeThatEndsThere) {
  Columns columns = columns_of({1, 2});
  columns.time = {std::numeric_limits<Time>::min(), std::numeric_limits<Time>::max()};
  Columns back;
  ASSERT_FALSE(ChunkDecoder().decode(encoded(columns), back.target()));
  EXPECT_TRUE(same(back, columns));
}

TEST(DamagedChunk, IsRefusedHoweverShortItIsCut) {
  const Chunk chunk = encoded(ten_samples());
  for (std::size_t size = 0; size < chunk.size(); ++size) {
    Columns back;
    const auto error = ChunkDecoder().decode(std::span(chunk).first(size), back.target());
    ASSERT_TRUE(error) << size;
    EXPECT_EQ(error->kind, ChunkError::Kind::damaged);
    EXPECT_THAT(error->message, ::testing::HasSubstr("cut short"));
    EXPECT_TRUE(back.time.empty());
  }
}

TEST(DamagedChunk, IsRefusedWhicheverBitFlips) {
  Chunk chunk = encoded(ten_samples());
  for (std::size_t bit = 0; bit < 8 * chunk.size(); ++bit) {
    const auto mask = static_cast<std::uint8_t>(1 << (bit % 8));
    chunk[bit / 8] ^= mask;
    Columns back;
    EXPECT_TRUE(ChunkDecoder().decode(chunk, back.target())) << "bit " << bit;
    EXPECT_TRUE(back.time.empty());
    chunk[bit / 8] ^= mask;
  }
}

TEST(DamagedChunk, IsRefusedWithBytesBehindItsEnd) {
  Chunk chunk = encoded(ten_samples());
  chunk.push_back(0);
  Columns back;
  const auto error = ChunkDecoder().decode(chunk, back.target());
  ASSERT_TRUE(error);
  EXPECT_EQ(error->message, "has bytes behind its end");
}

TEST(DamagedChunk, LeavesTheTargetAsItWasWhateverPartIsWrong) {
  Chunk chunk = encoded(columns_of(std::vector<double>(100, 1.0)));
  chunk.back() ^= 1;  // the length of the only run of sources, the last part
  seal(chunk);
  Columns back = ten_samples();
  const auto error = ChunkDecoder().decode(chunk, back.target());
  ASSERT_TRUE(error);
  EXPECT_EQ(error->message, "has sources that cannot be decoded");
  EXPECT_TRUE(same(back, ten_samples()));
}

TEST(DamagedChunk, IsRefusedWhenItClaimsMoreSamplesThanAnyHas) {
  Chunk chunk = encoded(ten_samples());
  chunk[8 + 3] = 0x7F;  // the highest byte of the count
  seal(chunk);
  EXPECT_TRUE(std::holds_alternative<ChunkError>(read_summary(chunk)));
}

TEST(NewerChunk, IsNamedAsOne) {
  Chunk chunk = encoded(ten_samples());
  chunk[4] = 2;
  seal(chunk);
  Columns back;
  const auto error = ChunkDecoder().decode(chunk, back.target());
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind, ChunkError::Kind::newer);
  EXPECT_EQ(error->message, "has format 2 where this program reads 1");
}

// What kinds of telemetry cost, with generous bounds: a change that loses a scheme breaks one.
struct Kind {
  const char* name;
  std::function<double(int i, std::mt19937& random)> value;
  ValueScheme scheme;
  double most_bytes;  // a value
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

class ValueKinds : public ::testing::TestWithParam<Kind> {};

TEST_P(ValueKinds, ComeBackFromTheSchemeThatFits) {
  const Kind& kind = GetParam();
  std::mt19937 random(20);
  std::vector<double> values;
  for (int i = 0; i < 4096; ++i) values.push_back(kind.value(i, random));
  const Columns columns = columns_of(values);
  ChunkEncoder encoder;
  const Chunk chunk = encoder.encode(columns.samples());
  EXPECT_EQ(encoder.sizes().scheme, kind.scheme);
  EXPECT_LE(static_cast<double>(encoder.sizes().value) / 4096, kind.most_bytes);
  Columns back;
  ASSERT_FALSE(ChunkDecoder().decode(chunk, back.target()));
  EXPECT_TRUE(same(back, columns));
}

double below(std::mt19937& random, unsigned bound) {
  return static_cast<double>(random() % bound);
}

double noisy_step(int i, std::mt19937& random, int middle) {
  return std::floor(middle + 100 * std::sin(i / 300.0) + below(random, 4));
}

INSTANTIATE_TEST_SUITE_P(
    Chunk, ValueKinds,
    ::testing::Values(
        Kind{"constant", [](int, std::mt19937&) { return 28.05; }, ValueScheme::decimal, 0.01},
        Kind{"counter", [](int i, std::mt19937&) { return i + 7.0; }, ValueScheme::decimal, 0.02},
        Kind{"switch", [](int i, std::mt19937&) { return i / 500 % 2; }, ValueScheme::decimal,
             0.02},
        Kind{"decimal_text",
             [](int i, std::mt19937& random) { return (1620 + i / 64 + below(random, 2)) / 100.0; },
             ValueScheme::decimal, 0.3},
        Kind{"converter_of_12_bits",
             [](int i, std::mt19937& random) {
               return -20 + 120.0 / 4095 * noisy_step(i, random, 1800);
             },
             ValueScheme::table, 0.6},
        Kind{"converter_of_16_bits",
             [](int, std::mt19937& random) { return -40 + 125.0 / 65535 * below(random, 65536); },
             ValueScheme::affine, 2.2},
        Kind{"calibration_by_a_polynomial",
             [](int i, std::mt19937& random) {
               const double x = noisy_step(i, random, 500);
               return 0.1 + 0.02 * x - 1.7e-6 * x * x;
             },
             ValueScheme::table, 1.2},
        Kind{"single_precision",
             [](int i, std::mt19937&) { return static_cast<float>(std::sin(i / 100.0)); },
             ValueScheme::bits, 4.1},
        Kind{"random_bits",
             [](int, std::mt19937& random) {
               return std::bit_cast<double>(std::uint64_t{random()} << 32 | random());
             },
             ValueScheme::bits, 8.01},
        Kind{"gaps_of_nan",
             [](int i, std::mt19937&) { return i % 100 < 3 ? nan : (i / 10) / 10.0; },
             ValueScheme::decimal, 0.3},
        Kind{"values_without_a_formula",
             [](int i, std::mt19937&) {
               return std::array{nan, -nan, infinity, -0.0}[static_cast<std::size_t>(i % 4)];
             },
             ValueScheme::bits, 0.1}),
    [](const auto& kind) { return std::string(kind.param.name); });

}  // namespace
}  // namespace reident::storage::test::chunk_test
