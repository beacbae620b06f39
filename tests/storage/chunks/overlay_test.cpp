// Recent samples over older ones.
#include "storage/chunks/overlay.hpp"

#include <map>
#include <random>

#include <gtest/gtest.h>

namespace reident::storage::test::overlay_test {
namespace {

SampleColumns fragment_of(const std::vector<Time>& times, double value) {
  SampleColumns fragment;
  for (const Time time : times) {
    fragment.time.push_back(time);
    fragment.value.push_back(value);
    fragment.quality.push_back(Quality::good);
    fragment.source.push_back(static_cast<std::int64_t>(value));
  }
  return fragment;
}

std::map<Time, double> as_map(const SampleColumns& samples) {
  std::map<Time, double> map;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(samples.source[i], static_cast<std::int64_t>(samples.value[i]));
    map[samples.time[i]] = samples.value[i];
  }
  EXPECT_EQ(map.size(), samples.size()) << "a time comes twice";
  return map;
}

TEST(Overlay, PutsWhatFollowsBehind) {
  SampleColumns base = fragment_of({1, 2}, 1);
  const SampleColumns first = fragment_of({3}, 2), second = fragment_of({7, 9}, 3);
  overlay(base, {&first, &second});
  EXPECT_EQ(as_map(base), (std::map<Time, double>{{1, 1}, {2, 1}, {3, 2}, {7, 3}, {9, 3}}));
}

TEST(Overlay, OfSeveralSamplesAtOneTimeTheLastLaidOnStays) {
  SampleColumns base = fragment_of({1, 2, 3, 4}, 1);
  const SampleColumns first = fragment_of({0, 2, 3}, 2), second = fragment_of({3, 5}, 3);
  overlay(base, {&first, &second});
  EXPECT_EQ(as_map(base), (std::map<Time, double>{{0, 2}, {1, 1}, {2, 2}, {3, 3}, {4, 1}, {5, 3}}));
}

TEST(Overlay, KeepsColumnsThatAreNotWantedEmpty) {
  SampleColumns base, newer;
  base.time = {1, 5};
  newer.time = {1, 3};
  overlay(base, {&newer});
  EXPECT_EQ(base.time, (std::vector<Time>{1, 3, 5}));
  EXPECT_TRUE(base.value.empty() && base.quality.empty() && base.source.empty());
}

TEST(Overlay, IsWhatAMapWouldHold) {
  std::mt19937 random(20170717);
  for (int round = 0; round < 500; ++round) {
    std::map<Time, double> expected;
    std::vector<SampleColumns> fragments;
    const std::size_t count = 1 + random() % 5;
    for (std::size_t r = 0; r < count; ++r) {
      std::vector<Time> times;
      const Time begin = static_cast<Time>(random() % 40);
      for (Time t = begin; t < begin + 20; ++t)
        if (random() % 3 != 0) times.push_back(t);
      fragments.push_back(fragment_of(times, static_cast<double>(r)));
      for (const Time time : times) expected[time] = static_cast<double>(r);
    }
    std::vector<const SampleColumns*> newer;
    for (std::size_t r = 1; r < count; ++r) newer.push_back(&fragments[r]);
    SampleColumns base = fragments[0];
    overlay(base, newer);
    ASSERT_EQ(as_map(base), expected) << "round " << round;
  }
}

}  // namespace
}  // namespace reident::storage::test::overlay_test
