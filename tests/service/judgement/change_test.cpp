#include "service/judgement/change.hpp"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::test::change_test {
namespace {

constexpr storage::Time length = 25 * 60 * 1'000'000'000LL;

/// Equipment that works in a share of its blocks, with outputs of all sizes; elsewhere its sensor's
/// noise alone is seen. What a run errs is a share of the output.
class Equipment {
 public:
  Equipment(std::uint64_t seed, double works) : noise_(seed), works_(works) {}

  /// The next block; returns whether a change is found with it.
  bool next(ChangeFinder& finder, double share, int regime = 0, int mode = 0) {
    constexpr double sigma = 0.05;
    const bool at_work = noise_.uniform() < works_;
    const double output = at_work ? std::exp(1.5 + noise_.normal()) : 0;
    const double error = output * share * std::exp(0.3 * noise_.normal());
    const double square = 1.3 * sigma * sigma;  // of the noise, with its rounding
    const storage::Block block{{at_, at_ + length},        375, 1,  {output},
                               {output * output + square}, {},  {}, {}};
    storage::BlockScore score;
    score.square = {error * error + square};
    score.noise = {sigma * sigma};
    at_ += length;
    const auto before = finder.last();
    finder.add(block, score, regime, mode);
    return finder.last() && (!before || before->found != finder.last()->found);
  }

 private:
  Noise noise_;
  double works_;
  storage::Time at_ = 0;
};

struct Case {
  const char* name;
  double works;
  int within;  // blocks, of 90 records in 100
};

class ErrorsThatTreble : public testing::TestWithParam<Case> {};

TEST_P(ErrorsThatTreble, AreFoundAndHardlyAnyOthers) {
  int found = 0, false_alarms = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Equipment equipment(seed, GetParam().works);
    ChangeFinder finder;
    for (int block = 0; block < 400; ++block) false_alarms += equipment.next(finder, 0.02);
    int block = 0;
    while (block < GetParam().within && !equipment.next(finder, 0.06)) ++block;
    found += block < GetParam().within;
  }
  EXPECT_GE(found, 90);
  EXPECT_LE(false_alarms, 4);
}

INSTANTIATE_TEST_SUITE_P(Equipment, ErrorsThatTreble,
                         testing::Values(Case{"always_at_work", 1, 12},
                                         Case{"at_work_in_half_of_its_blocks", 0.5, 24},
                                         Case{"at_work_in_a_fifth", 0.2, 75}),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(ChangeFinder, FindsAChangeWithAnotherRegimeWhereTheModelFailsThere) {
  // Worn bearings move the range of a wheel's torque, so that it looks like another regime.
  int found = 0, early = 0, harder = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Equipment equipment(seed, 1);
    ChangeFinder finder;
    for (int block = 0; block < 100; ++block) equipment.next(finder, 0.02);
    ChangeFinder other = finder;
    Equipment same = equipment;
    for (int block = 0; block < 60; ++block) harder += same.next(other, 0.06, 1);
    int block = 0;
    while (block < 8 && !equipment.next(finder, 10, 1)) ++block;
    if (block == 8) continue;
    ++found;
    early += finder.last()->since < 92 * length;
  }
  EXPECT_GE(found, 90);
  EXPECT_LE(early, 4);
  EXPECT_LE(harder, 4);
}

TEST(ChangeFinder, TakesNoOtherModeForAChange) {
  // Other loads run in a safe mode, and a model that has never seen one is of no use in it.
  int others = 0, found = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Equipment equipment(seed, 1);
    ChangeFinder finder;
    for (int block = 0; block < 100; ++block) equipment.next(finder, 0.02);
    for (int block = 0; block < 60; ++block) others += equipment.next(finder, 10, 1, 1);
    int block = 0;
    while (block < 8 && !equipment.next(finder, 10)) ++block;
    found += block < 8;
  }
  EXPECT_LE(others, 4);
  EXPECT_GE(found, 90) << "in the mode of before";
}

TEST(ChangeFinder, FindsAChangeThatGrowsInAnotherRegime) {
  // A battery that loses cells runs down for days before the model is of no use any more.
  int found = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Equipment equipment(seed, 1);
    ChangeFinder finder;
    for (int block = 0; block < 100; ++block) equipment.next(finder, 0.02);
    for (int block = 0; block < 20; ++block) equipment.next(finder, 0.06, 1);
    int block = 0;
    while (block < 8 && !equipment.next(finder, 10, 1)) ++block;
    found += block < 8;
  }
  EXPECT_GE(found, 90);
}

TEST(ChangeFinder, LearnsNothingFromOutputsThatAreNoise) {
  Equipment equipment(1, 0);
  ChangeFinder finder;
  for (int block = 0; block < 2000; ++block) EXPECT_FALSE(equipment.next(finder, 0.02));
}

}  // namespace
}  // namespace reident::test::change_test
