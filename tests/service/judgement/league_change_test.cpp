// The change of the equipment in the records of a league.
#include <cmath>

#include <gtest/gtest.h>

#include "service/judgement/league.hpp"
#include "tests/service/judgement/league_records.hpp"

namespace reident::test::league {
namespace {

TEST(LeagueChange, RecordsCountFromTheChangeOfTheEquipmentOn) {
  // Of old the champion was better; since block 100 it errs ten times as much.
  Records records(140);
  records.champion([](int block) {
           return Error{0, block < 100 ? 0.01 : 0.5};
         })
      .challenger(
          [](int block) {
            return Error{0, block < 100 ? 0.1 : 0.02};
          },
          20);
  const auto change = Judge(records.limits()).change(records.league());
  ASSERT_TRUE(change);
  EXPECT_NEAR(static_cast<double>(change->since / length), 100, 2);
  EXPECT_LT(change->found, (100 + 2 * blocks_of_cycle) * length);
  EXPECT_LT(records.findings()[0].blocks, 45);
  EXPECT_GT(records.findings()[0].mean_score, 0.8);
}

TEST(LeagueChange, AChampionWhoseErrorsVaryAsEverHasNotChanged) {
  Records records(400);
  records.champion([](int block) { return Error{0, block % 4 == 0 ? 0.3 : 0.01}; });
  EXPECT_FALSE(Judge(records.limits()).change(records.league()));
}

TEST(LeagueChange, AnotherRegimeIsNoChange) {
  // The champion errs five times as much while the input goes far, twice for twelve cycles.
  Records records(400);
  const auto is_far = [](int block) {
    return (block >= 100 && block < 148) || (block >= 250 && block < 298);
  };
  records.swings(100, 148);
  records.swings(250, 298);
  const auto usual = varying(0.01);
  records.champion([=](int block) {
    return Error{0, usual(block).square * (is_far(block) ? 25 : 1)};
  });
  EXPECT_FALSE(Judge(records.limits()).change(records.league()));
  records.champion([=](int block) {
    return Error{0, usual(block).square * (is_far(block) || block > 350 ? 25 : 1)};
  });
  const auto change = Judge(records.limits()).change(records.league());
  ASSERT_TRUE(change);
  EXPECT_NEAR(static_cast<double>(change->since / length), 350, 2);
}

TEST(LeagueChange, AChangeShowsInTheRecordOfTheVersionThatTheChampionReplaced) {
  // Since block 100; the champion's window ends behind it.
  Records records(140);
  records.champion(varying(0.05), 104)
      .challenger(
          [](int block) {
            return Error{0, block < 100 ? 0.01 : 0.25};
          },
          20)
      .challenger(varying(0.01), 106);
  records.league().changed = 0;
  EXPECT_EQ(records.findings()[1].changed, 0);
  records.league().replaced = 2;
  const Finding found = records.findings()[1];
  EXPECT_NEAR(static_cast<double>(found.changed / length), 100, 2);
  EXPECT_EQ(found.blocks, 34) << "the champion's record counts whole";
  EXPECT_FALSE(Judge(records.limits()).change(records.league())) << "it is no news";
}

TEST(LeagueChange, ScoresWanderBehindAChangeAsTheyDidBefore) {
  // The two err more in turn, for ten cycles each; at the change the champion errs more for good.
  const auto wandering = [](int sign) {
    return [sign](int block) {
      const double now = block < 320 ? 1 : 9;
      return Error{0, now * 0.01 * std::exp(sign * 0.7 * std::sin(block / 6.0))};
    };
  };
  Records records(345);
  records.champion(wandering(1)).challenger(wandering(-1), 0).challenger(white(0.02), 330);
  const auto dependence = records.findings().at(1).dependence;
  EXPECT_GT(dependence, 6);
  Records alone(345);
  alone.champion(wandering(1)).challenger(white(0.02), 330);
  EXPECT_LT(alone.findings().at(0).dependence, 0.7 * dependence);
}

TEST(LeagueChange, APhaseOfTheCycleThatTheReferenceLacksIsNoChange) {
  // The last quarter of each cycle begins to count at block 100; errors are above 1.
  Records records(200);
  records.champion(varying(400));
  for (int i = 0; i < 100; ++i)
    if (i % blocks_of_cycle == 3) records.league().blocks[static_cast<std::size_t>(i)].believed = 0;
  EXPECT_FALSE(Judge(records.limits()).change(records.league()));
}

}  // namespace
}  // namespace reident::test::league
