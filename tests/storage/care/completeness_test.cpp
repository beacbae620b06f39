#include "storage/care/completeness.hpp"

#include <limits>
#include <random>

#include "tests/storage/fixture.hpp"

namespace reident::storage::test::completeness_test {
namespace {

constexpr Time second = 1'000'000'000;
constexpr Time hour = 3600 * second;
constexpr Time day = 24 * hour;
constexpr Time start = 1'700'006'400 * second;  // 2023-11-15T00:00:00Z

class CompletenessTest : public ArchiveTest {
 protected:
  void send(const std::vector<Time>& times) {
    std::vector<TelemetryFrame> frames;
    for (const Time time : times)
      frames.push_back(frame(++sequence_, time, {{1, Quality::good, 1}}));
    append(frames);
  }
  static std::vector<Time> regular(Time begin, Time end, Time step = second) {
    std::vector<Time> times;
    for (Time time = begin; time < end; time += step) times.push_back(time);
    return times;
  }
  std::vector<BinCounts> counts(const TimeBins& bins, std::optional<Time> until = {}) {
    const SeriesInfo series = all_series(database).at(0);
    return completeness(database, series, bins, until.value_or(series.last));
  }

 private:
  std::uint64_t sequence_ = 0;
};

TEST_F(CompletenessTest, ACompleteDayHasAllThatIsExpectedInEachHour) {
  send(regular(start, start + day));
  for (const bool compacted : {false, true}) {
    if (compacted) archive.compact();
    for (const BinCounts& hours : counts(TimeBins({start, start + day}, hour))) {
      EXPECT_EQ(hours.came, 3600U);
      EXPECT_EQ(hours.missing, 0U);
      EXPECT_EQ(hours.gaps, 0U);
    }
  }
}

TEST_F(CompletenessTest, WhatIsMissingCountsWhereItWouldStand) {
  std::vector<Time> times = regular(start, start + 6 * hour);
  const auto lose = [&](Time begin, Time end) {
    std::erase_if(times, [&](Time time) { return begin <= time && time < end; });
  };
  lose(start + 600 * second, start + 601 * second);  // one sample
  lose(start + 90 * 60 * second,
       start + 4 * hour + 15 * second);  // half of hour 1, 2, 3, a bit of 4
  send(times);
  for (const bool compacted : {false, true}) {
    SCOPED_TRACE(compacted);
    if (compacted) archive.compact();
    const auto hours = counts(TimeBins({start, start + 6 * hour}, hour));
    const std::vector<std::uint64_t> missing = {1, 1800, 3600, 3600, 15, 0};
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(hours[i].missing, missing[i]) << i;
      EXPECT_EQ(hours[i].came, 3600 - missing[i]) << i;
      EXPECT_EQ(hours[i].gaps, i < 2 ? 1U : 0U) << i;
    }
    EXPECT_EQ(hours[1].longest_gap, 4 * hour + 15 * second - (90 * 60 - 1) * second);
  }
}

TEST_F(CompletenessTest, GapsAreNamedByTheSamplesBesideThemAndTheLastReachesTheEnd) {
  std::vector<Time> times = regular(start, start + 6 * hour);
  std::erase_if(times, [](Time time) { return start + hour <= time && time < start + 2 * hour; });
  send(times);
  const std::vector<TimeRange> all = {{start + hour - second, start + 2 * hour},
                                      {start + 6 * hour - second, start + 7 * hour}};
  for (const bool compacted : {false, true}) {
    SCOPED_TRACE(compacted);
    if (compacted) archive.compact();
    const SeriesInfo series = all_series(database).at(0);
    EXPECT_EQ(gaps(database, series, {start, start + day}, start + 7 * hour), all);
    EXPECT_EQ(gaps(database, series, {start, start + day}, series.last), std::vector{all[0]});
    EXPECT_EQ(gaps(database, series, {start + 3 * hour, start + 4 * hour}, series.last),
              std::vector<TimeRange>());
  }
}

TEST_F(CompletenessTest, LateSamplesThatAreStillRecentFillTheirGap) {
  send(regular(start, start + 2 * hour));
  send(regular(start + 4 * hour, start + 6 * hour));
  archive.compact();
  const TimeBins bins({start, start + 6 * hour}, hour);
  EXPECT_EQ(counts(bins)[2].missing, 3600U);
  send(regular(start + 2 * hour, start + 4 * hour));
  for (const bool compacted : {false, true}) {
    if (compacted) archive.compact();
    for (const BinCounts& hours : counts(bins)) {
      EXPECT_EQ(hours.came, 3600U) << compacted;
      EXPECT_EQ(hours.missing, 0U) << compacted;
    }
  }
}

TEST_F(CompletenessTest, ASeriesThatEndedIsMissingFromThenOn) {
  send(regular(start, start + hour));
  archive.compact();
  const auto hours = counts(TimeBins({start, start + 3 * hour}, hour), start + 3 * hour - second);
  EXPECT_EQ(hours[1].missing, 3600U);
  EXPECT_EQ(hours[2].missing, 3599U) << "at the end itself another series has its last sample";
  EXPECT_EQ(hours[0].gaps, 1U);
}

TEST_F(CompletenessTest, APartOfAnHourIsCountedExactly) {
  send(regular(start, start + 3 * hour));
  archive.compact();
  const auto parts = counts(TimeBins({start + 30 * second, start + hour + 10 * second}, hour));
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].came, 3570U);
  EXPECT_EQ(parts[1].came, 10U);
}

TEST_F(CompletenessTest, WhatComesAtRandomIsNotCalledIncomplete) {
  std::mt19937_64 random(3);
  std::exponential_distribution<double> pause(1.0 / 60);
  std::vector<Time> times = {start};
  while (times.back() < start + 10 * day)
    times.push_back(times.back() + 1 + static_cast<Time>(pause(random) * 1e9));
  send(times);
  archive.compact();
  BinCounts all;
  for (const BinCounts& one : counts(TimeBins({start, times.back() + 1}, day))) all += one;
  EXPECT_EQ(all.came, times.size());
  EXPECT_LT(static_cast<double>(all.missing), 0.1 * static_cast<double>(all.came));
}

TEST_F(CompletenessTest, CountsAreThoseOfReadingEverything) {
  std::mt19937_64 random(11);
  std::vector<Time> times = regular(start, start + 20 * hour, 10 * second);
  std::erase_if(times, [&](Time) { return random() % 50 == 0; });
  std::vector<Time> late;
  for (std::size_t i = 0; i < times.size(); i += 97) late.push_back(times[i]);
  std::erase_if(times,
                [&](Time time) { return std::binary_search(late.begin(), late.end(), time); });
  Archive small(database, {.chunk_samples = 64, .recent_samples = 500, .recent_batches = 4});
  const auto send_small = [&](const std::vector<Time>& some) {
    for (std::size_t i = 0; i < some.size(); i += 300) {
      std::vector<TelemetryFrame> frames;
      for (std::size_t k = i; k < std::min(i + 300, some.size()); ++k)
        frames.push_back(frame(k, some[k], {{1, Quality::good, 1}}));
      small.append(frames);
    }
  };
  send_small(times);
  send_small(late);
  const TimeBins bins({start + 17 * second, start + 19 * hour}, hour / 2);
  const auto counted = counts(bins);
  for (std::size_t bin = 0; bin < bins.count(); ++bin) {
    const Series held = archive.read("CB4", Origin::real, 1, bins.at(bin));
    EXPECT_EQ(counted[bin].came, held.time.size()) << bin;
    const Time length = bins.at(bin).end - bins.at(bin).begin;
    EXPECT_NEAR(static_cast<double>(counted[bin].expected()),
                static_cast<double>(length / (10 * second)), 1.0)
        << bin;
  }
}

TEST_F(CompletenessTest, AGapThatIsLongerThanATimeHoldsIsAsLongAsThat) {
  constexpr Time least = std::numeric_limits<Time>::min(), most = std::numeric_limits<Time>::max();
  send(regular(least, least + 10 * second));
  EXPECT_EQ(counts(TimeBins({least, most}, 100 * 365 * day), most).at(0).longest_gap, most);
}

TEST_F(CompletenessTest, ADamagedNumberOfABatchIsNamedAndNotCountedUpTo) {
  send(regular(start, start + 10 * second));
  send(regular(start + 10 * second, start + 20 * second));
  rows(path, "UPDATE recent SET batch = 9000000000000000000 WHERE batch = 2");
  EXPECT_THAT(error_of([&] {
                counts(TimeBins({start, start + hour}, hour));
              }),
              ::testing::StartsWith("corrupt: "));
}

TEST(TimeBins, BeginAtMultiplesOfTheirLengthBefore1970Too) {
  const TimeBins bins({-day - hour, day + 1}, day);
  ASSERT_EQ(bins.count(), 4U);
  EXPECT_EQ(bins.at(0), (TimeRange{-day - hour, -day}));
  EXPECT_EQ(bins.at(1), (TimeRange{-day, 0}));
  EXPECT_EQ(bins.at(3), (TimeRange{day, day + 1}));
  EXPECT_EQ(bins.of(-1), 1U);
  EXPECT_EQ(bins.of(day), 3U);
}

}  // namespace
}  // namespace reident::storage::test::completeness_test
