#include "storage/chunks/sample_gaps.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace reident::storage::sample_gaps_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr Time second = 1'000'000'000;
constexpr Time start = 1'700'000'000 * second;
constexpr std::size_t chunk = 8192;

using Random = std::mt19937_64;

Time seconds(double value) {
  return std::llround(value * static_cast<double>(second));
}

/// `count` times; the difference before each but the first is `step()`.
std::vector<Time> times_with(std::size_t count, const std::function<Time()>& step) {
  std::vector<Time> times = {start};
  while (times.size() < count) times.push_back(times.back() + step());
  return times;
}

std::vector<Time> regular(std::size_t count, Time step = second) {
  return times_with(count, [step] { return step; });
}

Sampling measure(const std::vector<Time>& times) {
  return SamplingMeter().measure(times);
}

std::vector<SampleGap> gaps_in(const std::vector<Time>& times) {
  std::vector<SampleGap> gaps;
  append_gaps(times, measure(times), gaps);
  return gaps;
}

TEST(SampleGaps, FewerThanTwoSamplesHaveNoStepAndNoLimit) {
  EXPECT_EQ(measure({}), (Sampling{0, 0}));
  EXPECT_EQ(measure({start}), (Sampling{0, 0}));
  EXPECT_THAT(gaps_in({start}), IsEmpty());
}

TEST(SampleGaps, TwoSamplesGiveAStepAndNoGap) {
  const std::vector<Time> two = {start, start + 10 * second};
  EXPECT_EQ(measure(two), (Sampling{10 * second, 15 * second}));
  EXPECT_THAT(gaps_in(two), IsEmpty());
}

TEST(SampleGaps, TheStepIsTheLowerMedian) {
  EXPECT_EQ(measure({0, 1, 4}).step, 1);
  EXPECT_EQ(measure({0, 5, 6, 10}).step, 4);
}

TEST(SampleGaps, ARegularRangeHasNone) {
  EXPECT_EQ(measure(regular(chunk)), (Sampling{second, second * 3 / 2}));
  EXPECT_THAT(gaps_in(regular(chunk)), IsEmpty());
}

TEST(SampleGaps, ARegularRangeShowsEachMissingSampleHoweverShort) {
  for (const std::size_t count : {std::size_t{10}, std::size_t{100}, chunk}) {
    std::vector<Time> times = regular(count);
    const auto missing = times.begin() + static_cast<std::ptrdiff_t>(count / 2);
    const SampleGap gap{*missing - second, *missing + second};
    times.erase(missing);
    EXPECT_THAT(gaps_in(times), ElementsAre(gap)) << count;
  }
}

TEST(SampleGaps, JitterIsNoGapAndHidesNone) {
  for (const double jitter : {0.001, 0.01, 0.1}) {  // of each time [s]
    Random random(7);
    std::normal_distribution<double> noise(0, jitter);
    std::vector<Time> times = regular(chunk);
    for (Time& time : times) time += seconds(noise(random));
    EXPECT_THAT(gaps_in(times), IsEmpty()) << jitter;
    times.erase(times.begin() + 4000);
    EXPECT_THAT(gaps_in(times), ElementsAre(SampleGap{times[3999], times[4000]})) << jitter;
  }
}

TEST(SampleGaps, OneSampleInTenMissingShowsEveryGap) {
  Random random(11);
  std::bernoulli_distribution drop(0.1);
  std::vector<SampleGap> expected;
  std::vector<Time> times = {start};
  for (const Time time : regular(chunk)) {
    if (time == start || drop(random)) continue;
    if (time - times.back() > second) expected.push_back({times.back(), time});
    times.push_back(time);
  }
  EXPECT_GT(expected.size(), chunk / 12);
  EXPECT_EQ(gaps_in(times), expected);
}

TEST(SampleGaps, LossesOfContactAreTheOnlyGapsOfPasses) {
  std::size_t sent = 0;
  const auto times = times_with(chunk, [&] { return ++sent % 600 == 0 ? 5400 * second : second; });
  const auto gaps = gaps_in(times);
  EXPECT_THAT(gaps, SizeIs((chunk - 1) / 600));
  for (const SampleGap& gap : gaps) EXPECT_EQ(gap.end - gap.begin, 5400 * second);
}

TEST(SampleGaps, WhatComesAtRandomHasGapsOnlyInItsRareLongPauses) {
  Random random(13);
  std::exponential_distribution<double> pause(1);
  const auto times = times_with(chunk, [&] { return 1 + seconds(pause(random)); });
  // Above 1.5 times the 95th percentile, 4.5 times the mean, lie 1.1 % of the pauses.
  const auto gaps = gaps_in(times);
  EXPECT_GT(gaps.size(), chunk / 200);
  EXPECT_LT(gaps.size(), chunk / 60);
  for (const SampleGap& gap : gaps) EXPECT_GT(gap.end - gap.begin, 4 * second);
}

TEST(SampleGaps, AChangeOfRateIsNoGap) {
  for (const std::size_t slow : {std::size_t{100}, chunk / 10, chunk / 2 - 1, chunk - 100}) {
    for (const bool slow_first : {false, true}) {
      std::size_t sent = 0;
      const auto times = times_with(chunk, [&] {
        const bool is_slow = slow_first ? sent < slow : sent >= chunk - 1 - slow;
        ++sent;
        return (is_slow ? 10 : 1) * second;
      });
      // A rate that few samples have may pass for gaps only where it is below 5 % of the range.
      EXPECT_LE(gaps_in(times).size(), slow < chunk / 20 ? slow : 0) << slow << slow_first;
      const auto& sampling = measure(times);
      EXPECT_EQ(sampling.step, (slow < chunk / 2 ? 1 : 10) * second) << slow;
    }
  }
}

TEST(SampleGaps, TwoRatesThatAlternateAreNoGaps) {
  std::size_t sent = 0;
  const auto times = times_with(chunk, [&] { return (++sent % 2 == 0 ? 1 : 2) * second; });
  EXPECT_THAT(gaps_in(times), IsEmpty());
}

TEST(SampleGaps, TheGreatestDistancesDoNotOverflow) {
  using Limits = std::numeric_limits<Time>;
  EXPECT_EQ(measure({Limits::min(), Limits::max()}), (Sampling{Limits::max(), Limits::max()}));
  EXPECT_THAT(gaps_in({Limits::min(), 0, 1, 2, 3, 4, 5, 6, Limits::max()}), SizeIs(2));
}

TEST(SampleGaps, BetweenTwoRangesTheLargerLimitCounts) {
  const Sampling fast = measure(regular(100)), slow = measure(regular(100, 10 * second)), none{};
  const auto across = [](Time distance, const Sampling& before, const Sampling& after) {
    return gap_between(start, before, start + distance, after).has_value();
  };
  EXPECT_FALSE(across(second, fast, fast));
  EXPECT_TRUE(across(2 * second, fast, fast));
  EXPECT_FALSE(across(10 * second, fast, slow));
  EXPECT_FALSE(across(10 * second, slow, fast));
  EXPECT_TRUE(across(20 * second, slow, fast));
  EXPECT_TRUE(across(2 * second, none, fast)) << "a single sample takes over the other's limit";
  EXPECT_FALSE(across(1000 * second, none, none)) << "two single samples have no limit";
  EXPECT_EQ(gap_between(start, fast, start + 5 * second, fast),
            (SampleGap{start, start + 5 * second}));
}

}  // namespace
}  // namespace reident::storage::sample_gaps_test
