#include "service/history/summary.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "storage/archive/archive.hpp"
#include "storage/archive/holdings.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::history {
namespace {

using storage::Quality;
using storage::Time;

constexpr Time second = storage::second_ns;

class Summary : public ::testing::Test {
 protected:
  storage::test::TemporaryFolder folder;
  storage::Database database{folder / "archive.db", storage::Database::Mode::read_write};
  storage::Archive archive{database, {.chunk_samples = 128}};
  PieceMemory memory;

  void store(Time time, double value, Quality quality = Quality::good) {
    frames_.push_back(storage::test::frame(++sequence_, time, {{1, quality, value}}));
  }
  void commit() {
    archive.append(frames_);
    frames_.clear();
  }
  storage::SeriesInfo series() const { return storage::all_series(database).front(); }

  /// Against a naive summary of each bin.
  void expect_right(const storage::TimeBins& bins) {
    const storage::Series all =
        archive.read("CB4", storage::Origin::real, 1, {bins.range().begin, bins.range().end});
    std::vector<BinSummary> expected;
    for (std::size_t i = 0; i < all.time.size(); ++i) {
      const Time time = all.time[i];
      const double value = all.value[i];
      const storage::TimeRange bin = bins.at(bins.of(time));
      if (expected.empty() || expected.back().bin != bin) {
        expected.emplace_back().bin = bin;
        expected.back().first = time;
      }
      BinSummary& one = expected.back();
      one.last = time;
      ++one.samples;
      one.numbers += !std::isnan(value);
      if (value < one.least) {
        one.least = value;
        one.least_time = time;
      }
      if (value > one.greatest) {
        one.greatest = value;
        one.greatest_time = time;
      }
      if (storage::is_better(one.worst, all.quality[i])) one.worst = all.quality[i];
    }
    const SeriesSummary found = summarise(database, series(), bins, memory);
    ASSERT_EQ(found.bins.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const BinSummary &is = found.bins[i], &should = expected[i];
      ASSERT_EQ(is.bin, should.bin) << i;
      ASSERT_EQ(
          (std::tuple(is.first, is.last, is.samples, is.numbers, is.worst)),
          (std::tuple(should.first, should.last, should.samples, should.numbers, should.worst)))
          << i;
      ASSERT_EQ(
          (std::tuple(is.least, is.greatest, is.least_time, is.greatest_time)),
          (std::tuple(should.least, should.greatest, should.least_time, should.greatest_time)))
          << i;
    }
  }

 private:
  std::vector<storage::TelemetryFrame> frames_;
  std::uint64_t sequence_ = 0;
};

TEST_F(Summary, HasTheExtremesOfEachBinAtTheirTimesWhateverIsKeptInChunksAndInMemory) {
  std::mt19937 random(20261126);
  std::normal_distribution<> values(3, 1);
  Time time = 0;
  for (int i = 0; i < 5000; ++i) {
    time += 10 * second * (1 + (random() % 50 == 0 ? 40 : 0));
    if (random() % 90 == 0)
      store(time, NAN, Quality::invalid);
    else
      store(time, std::round(values(random) * 10) / 10,
            random() % 100 == 0 ? Quality::suspect : Quality::good);
  }
  commit();
  const auto expect_all_right = [&] {
    for (const Time length : {37, 700, 2000, 30'000, 1'000'000})
      for (const Time begin : {-5, 1005, 20'000}) {
        expect_right({{begin * second + 5, time - 300 * second}, length * second});
        if (HasFatalFailure()) FAIL() << length << " " << begin;
      }
  };
  expect_all_right();  // recent samples alone
  archive.compact();
  expect_all_right();
  expect_all_right();  // from memory
  for (int i = 0; i < 300; ++i)
    store(1 + static_cast<Time>(random() % 50'000) * second, values(random) * 3);
  commit();
  expect_all_right();  // late ones over chunks
  archive.compact();
  expect_all_right();
  PieceMemory small(3);
  const storage::TimeBins bins({0, time}, 2000 * second);
  EXPECT_EQ(summarise(database, series(), bins, small).bins.size(),
            summarise(database, series(), bins, memory).bins.size());
}

TEST_F(Summary, NamesTheGapsThatAreNotShorterThanABin) {
  for (Time at = 0; at < 1000; ++at)
    if ((at < 300 || at >= 400) && (at < 600 || at >= 605)) store(at * second, 1);
  commit();
  const auto expect_one_gap = [&](Time length) {
    const auto gaps =
        summarise(database, series(), {{0, 1000 * second}, length * second}, memory).gaps;
    ASSERT_EQ(gaps.size(), 1U) << length;
    EXPECT_EQ(gaps[0], (storage::TimeRange{299 * second, 400 * second}));
  };
  for (const Time length : {10, 70, 90}) expect_one_gap(length);
  archive.compact();
  for (const Time length : {10, 70, 90, 90}) expect_one_gap(length);
}

TEST_F(Summary, OfNothingIsEmpty) {
  store(1000 * second, 1);
  commit();
  const SeriesSummary summary = summarise(database, series(), {{0, 100}, 10}, memory);
  EXPECT_TRUE(summary.bins.empty());
  EXPECT_TRUE(summary.gaps.empty());
}

}  // namespace
}  // namespace reident::history
