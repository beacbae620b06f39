#include "service/judgement/league.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "tests/service/judgement/league_records.hpp"

namespace reident::test::league {
namespace {

TEST(League, FirstVersionNeedsAWholeCycleOfTelemetryThatItWasNotFittedTo) {
  EXPECT_EQ(Records(blocks_of_cycle).challenger(white(0.01), 1).obstacle(), Code::too_few_blocks);
  EXPECT_EQ(Records(blocks_of_cycle).challenger(white(0.01), 0).obstacle(), std::nullopt);
}

TEST(League, FirstVersionIsBetterThanTheMeanAndTheSimulator) {
  Records records(8);
  records.challenger(white(1.1), 0);
  EXPECT_EQ(records.obstacle(), Code::not_better_than_mean);
  Records beside(120);
  beside.challenger(white(0.01), 0);
  for (Block& block : beside.league().blocks) block.baseline_square = {0.005};
  EXPECT_EQ(beside.obstacle(), Code::not_better_than_simulator);
  for (Block& block : beside.league().blocks) block.baseline_square = {0.02};
  EXPECT_EQ(beside.obstacle(), std::nullopt);
  Records configured(8);
  configured.challenger(white(0.01), 0).limits().baseline_mrse_percent = 0.5;
  EXPECT_EQ(configured.obstacle(), Code::not_better_than_simulator);
  configured.limits().baseline_mrse_percent = 2;
  EXPECT_EQ(configured.obstacle(), std::nullopt);
}

TEST(League, VersionOfWhichTheErrorIsAboveTheLimitOrNotFiniteIsNotAdmissible) {
  Records records(80);
  records.champion(white(1)).challenger(white(0.04), 40).limits().max_mrse_percent = 1;
  EXPECT_EQ(records.obstacle(), Code::error_above_limit);
  EXPECT_EQ(Records(80)
                .champion(white(0.5))
                .challenger(white(std::numeric_limits<double>::infinity()), 40)
                .obstacle(),
            Code::not_finite);
}

TEST(League, VersionThatErrsHalfAsMuchReplacesTheChampionWithinAFewCycles) {
  int needed = 0;
  for (int blocks = 40; blocks <= 120; ++blocks)
    if (!Records(blocks).champion(varying(0.04)).challenger(varying(0.01), 40).obstacle()) {
      needed = blocks - 40;
      break;
    }
  EXPECT_GT(needed, 2 * blocks_of_cycle);
  EXPECT_LT(needed, 12 * blocks_of_cycle);
}

TEST(League, VersionThatIsEquallyGoodNeverReplacesTheChampion) {
  const Errors one = [](int block) { return Error{0, block % 2 == 0 ? 0.01 : 0.04}; };
  const Errors other = [](int block) { return Error{0, block % 2 == 0 ? 0.04 : 0.01}; };
  EXPECT_EQ(Records(400).champion(one).challenger(other, 40).obstacle(), Code::not_better);
}

TEST(League, VersionThatIsBetterByLessThanTheMarginWaits) {
  Records records(400);
  records.champion(white(0.01)).challenger(white(0.0092), 40);
  EXPECT_EQ(records.obstacle(), Code::within_margin);
  records.limits().margin_percent = 2;
  EXPECT_EQ(records.obstacle(), std::nullopt);
}

TEST(League, VersionThatHasNotMetAnOperatingRegimeOfTheChampionIsNotCovered) {
  Records records(160);
  records.swings(20, 60);
  records.champion(varying(0.02)).challenger(varying(0.01), 80);
  EXPECT_EQ(records.obstacle(), Code::not_covered);
  EXPECT_NEAR(records.findings()[0].uncovered_share, 43.0 / 160, 1e-9)
      << "three blocks behind them are of a cycle with them";
}

TEST(League, VersionThatIsSurelyWorseInARegimeStaysOut) {
  Records records(1000);
  const auto is_unusual = [](int block) { return block % 40 < 8; };
  for (std::size_t i = 0; i < 1000; i += 40) records.swings(i, i + 8);
  records.champion(white(0.1))
      .challenger(
          [&](int block) {
            return Error{0, is_unusual(block) ? 0.3 : 0.001};
          },
          20);
  EXPECT_EQ(records.obstacle(), Code::worse_in_regime);
}

TEST(League, NewVersionIsToRunOnTheLastCyclesOfARegimeFromBeforeItsWindow) {
  Records records(100);
  records.swings(20, 60);
  records.champion(varying(0.02)).challenger(varying(0.01), 96, 4 * cycle);
  ASSERT_EQ(records.earlier_blocks().size(), cycles_before * blocks_of_cycle);
  EXPECT_EQ(records.earlier_blocks().front(), (63 - 16) * length)
      << "three blocks behind are of a cycle with them";
  EXPECT_EQ(records.earlier_blocks().back(), 62 * length);
}

TEST(League, NewVersionIsToRunOnTheRegimesThatItsWindowHasAndItsRecordDoesNot) {
  Records records(100);
  records.swings(70, 80);
  records.champion(varying(0.02)).challenger(varying(0.01), 92, 8 * cycle);
  ASSERT_FALSE(records.earlier_blocks().empty());
  EXPECT_EQ(records.earlier_blocks().front(), 70 * length);
  EXPECT_EQ(records.earlier_blocks().back(), 82 * length);
  records.league().champion.reset();
  EXPECT_EQ(records.earlier_blocks().size(), 32) << "a first version, on all of its window";
}

TEST(League, RegimesOfTheChampionsOwnWindowCount) {
  // The champion was fitted to a regime that has not come again, in which the version would err.
  for (const auto& [before, obstacle] :
       {std::pair(0.01, std::optional<Code>()), {0.5, Code::worse_over_regimes}}) {
    Records records(160);
    records.swings(0, 20);
    records.champion(varying(0.02), 20).challenger(varying(0.01), 90);
    records.ran_before(*records.league().champion, varying(0.01), 4, 20);
    records.ran_before(records.league().challengers[0], varying(before), 4, 20);
    EXPECT_EQ(records.obstacle(), obstacle) << before;
  }
}

TEST(League, VersionReturnsByWhatFollowsItsReplacement) {
  // The champion was better for the cycles by which it was chosen, and fails in another regime.
  const auto one = [](double before, double after) {
    return [=](int block) { return Error{0, varying(block < 64 ? before : after)(block).square}; };
  };
  for (const auto& [is_return, obstacle] :
       {std::pair(true, std::optional<Code>()), {false, Code::not_better}}) {
    Records records(100);
    records.swings(64, 100);
    records.champion(one(0.001, 0.5), 20).challenger(one(0.05, 0.02), 20);
    if (is_return) {
      records.league().replaced = 2;
      records.league().replaced_at = 64 * length;
    }
    EXPECT_EQ(records.obstacle(), obstacle);
  }
}

TEST(League, VersionThatWasReplacedHasTheSameShareWhereverItsWindowBegins) {
  for (const Time window : {2 * cycle, 12 * cycle}) {
    Records records(100);
    records.champion(varying(0.02), 40).challenger(varying(0.02), 30, window);
    records.league().replaced = 2;
    records.league().replaced_at = 40 * length;
    EXPECT_NEAR(records.findings()[0].log_threshold, std::log(16 / 0.05), 1e-9);
  }
}

TEST(League, VersionIsCoveredThatRanOnARegimeFromBeforeItsWindow) {
  // Half of the champion's time was in a regime in which it errs far less than the version would.
  const auto champion = [](int block) { return Error{0, block < 80 ? 0.02 : 0.2}; };
  for (const auto& [before, obstacle] : {std::pair(0.01, std::optional<Code>()),
                                         {0.1, std::nullopt},
                                         {0.5, Code::worse_over_regimes}}) {
    Records records(160);
    records.swings(0, 77);
    records.champion(champion).challenger(varying(0.02), 90);
    records.ran_before(records.league().challengers[0], varying(before), 64, 80);
    EXPECT_EQ(records.obstacle(), obstacle) << before;
  }
}

TEST(League, RegimesOfTheChampionBeforeCountUntilTheEquipmentChanges) {
  // The champion's window begins behind a regime in which the version errs more.
  for (const auto& [changed, obstacle] :
       {std::pair(Time{INT64_MIN}, std::optional(Code::worse_over_regimes)),
        {62 * length, std::nullopt}}) {
    Records records(160);
    records.swings(0, 60);
    records.champion(varying(0.04), 90).challenger(varying(0.02), 110);
    records.ran_before(*records.league().champion, varying(0.02), 44, 60);
    records.ran_before(records.league().challengers[0], varying(0.12), 44, 60);
    records.league().changed = changed;
    EXPECT_EQ(records.obstacle(), obstacle);
  }
}

// A change is as large from either side of it. Versions that learnt one set point fit what follows
// a change, and err by far more at the others.
TEST(League, VersionErrsBeforeAChangeByNoMoreThanTwiceWhatItDidToTheChampion) {
  for (const auto& [own, champion, obstacle] : {std::tuple(0.14, 0.001, std::optional<Code>()),
                                                {0.5, 0.001, Code::worse_before_change},
                                                {0.5, 0.15, std::nullopt}}) {
    Records records(160);
    records.champion(varying(0.04), 70).challenger(varying(0.02), 110);
    records.ran_before(*records.league().champion, white(champion), 44, 60);
    records.ran_before(records.league().challengers[0], white(own), 44, 60);
    records.league().changed = 62 * length;
    EXPECT_EQ(records.obstacle(), obstacle) << own << ", " << champion;
    EXPECT_NEAR(records.findings()[0].before_change_mrse_percent.first, 100 * std::sqrt(own / 101),
                1e-9);
  }
}

// A mode of operation that no window had: the version knows it alone, another one both.
TEST(League, VersionThatMissesBeforeAChangeWhatAnotherExplainsOnBothSidesStaysOut) {
  for (const auto& [before, since, obstacle] :
       {std::tuple(0.001, 0.02, std::optional(Code::worse_before_change)),
        {0.04, 0.02, std::nullopt},
        {0.001, 0.2, std::nullopt}}) {
    Records records(160);
    records.champion(varying(0.3), 70)
        .challenger(varying(0.02), 110)
        .challenger(varying(since), 156);
    records.ran_before(*records.league().champion, white(0.001), 44, 60);
    records.ran_before(records.league().challengers[0], white(0.3), 44, 60);
    records.ran_before(records.league().challengers[1], white(before), 44, 60);
    records.league().changed = 62 * length;
    EXPECT_EQ(records.obstacle(), obstacle) << before << ", " << since;
  }
}

TEST(League, NewVersionIsToRunOnTheLastCyclesOfEachRegimeFromBeforeTheChange) {
  Records records(100);
  records.swings(20, 40);
  records.champion(varying(0.02)).challenger(varying(0.01), 80);
  records.league().changed = 62 * length;
  const auto begins = records.earlier_blocks();
  ASSERT_EQ(begins.size(), 2 * cycles_before * blocks_of_cycle);
  EXPECT_EQ(begins.front(), (43 - 16) * length) << "three blocks behind are of a cycle with them";
  EXPECT_EQ(begins.back(), 61 * length);
}

// Two days of swapped parameters, say: no model is of use there, or the champion was fitted to
// them.
TEST(League, ARegimeInWhichErrorsAreHugeDecidesForItsTimeAlone) {
  for (const auto& [there, obstacle] :
       {std::pair(1e13, std::optional<Code>()), {0.02, Code::worse_over_regimes}}) {
    Records records(160);
    records.swings(0, 72);
    records.champion([there = there](int block) {
             return Error{0, block < 75 ? there : 0.5};
           })
        .challenger(varying(0.01), 90);
    records.ran_before(records.league().challengers[0], white(1e14), 59, 75);
    EXPECT_EQ(records.obstacle(), obstacle) << there;
  }
}

// As of a drive that seldom rewinds: what is saved often does not outweigh what is lost then.
TEST(League, ALossInARareRegimeOutweighsSmallGains) {
  Records records(160);
  records.swings(0, 27);
  records.champion([](int block) {
           return Error{0, block < 30 ? 0.02 : 0.04};
         })
      .challenger(varying(0.003), 90);
  records.ran_before(records.league().challengers[0], white(0.8), 14, 30);
  EXPECT_EQ(records.obstacle(), Code::worse_over_regimes);
}

TEST(League, VersionsAreTheLeastIntervalApart) {
  Records records(200);
  records.champion(white(0.04), 40).challenger(white(0.01), 42).limits().min_interval = cycle;
  EXPECT_EQ(records.obstacle(), Code::too_soon);
  records.limits().min_interval = 0;
  EXPECT_EQ(records.obstacle(), std::nullopt);
}

TEST(League, ARegimeThatEndedWhereTheWindowBeginsIsNotMet) {
  Records records(160);
  records.swings(20, 72);
  // The window begins at block 72: cycles with these ranges that end in it begin before it.
  records.champion(varying(0.02)).challenger(varying(0.01), 80);
  EXPECT_EQ(records.obstacle(), Code::not_covered);
}

TEST(League, VersionWithTheGreaterErrorsOnAWholeStaysOut) {
  // It errs less on nine of ten blocks, and far more on the tenth.
  const auto errors = [](double usual, double rare) {
    return [=](int block) { return Error{0, block % 10 == 0 ? rare : usual}; };
  };
  Records records(400);
  records.champion(errors(0.002, 0.02)).challenger(errors(0.0005, 0.05), 40);
  const Finding found = records.findings().at(0);
  EXPECT_GT(found.log_wealth, found.log_threshold);
  EXPECT_EQ(records.obstacle(), Code::within_margin);
}

TEST(League, VersionWithLessThanHalfOfTheErrorIsNotWithinTheMargin) {
  // Both err as little as the sensor shows, but on one block of ten.
  const auto errors = [](double rare) {
    return [=](int block) { return Error{0, block % 10 == 0 ? rare : 0.001}; };
  };
  Records records(800);
  records.champion(errors(0.1)).challenger(errors(0.015), 40);
  const Finding found = records.findings().at(0);
  EXPECT_LT(found.mean_score, 0.16) << "what 15 % less error on each block gives";
  EXPECT_LT(found.mrse_percent, 0.5 * found.champion_mrse_percent);
  EXPECT_EQ(records.obstacle(), std::nullopt);
}

TEST(League, AFullLeagueKeepsHalfItsPlacesForVersionsThatWaitForAnOperator) {
  // Two that only an offset of the champion lets look better, and three that are not proved yet.
  Records records(160);
  records.unbound().champion([](int) { return Error{0.2, 0.001}; });
  records.challenger(white(0.001), 40).challenger(white(0.0009), 44);
  for (const int from : {154, 155, 156}) records.challenger(white(0.0001), from);
  const auto findings = records.findings();
  ASSERT_EQ(findings[0].obstacle->code, Code::bias_unverified);
  ASSERT_FALSE(is_proved(findings[4]));
  EXPECT_LT(findings[0].mean_score, findings[4].mean_score);
  EXPECT_GE(weakest(findings).version, 4);
}

TEST(League, SuccessorIsTheOneWithTheBestRecordOfLate) {
  Records records(160);
  records.champion(white(0.04))
      .challenger(white(0.01), 40)
      .challenger(white(0.004), 60)
      .challenger(white(0.02), 150);
  const auto found = successor(records.findings());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->version, 3);
  EXPECT_EQ(weakest(records.findings()).version, 4);
}

TEST(League, ALongRecordKeepsNoPlaceFromABetterVersion) {
  Records records(160);
  records.champion(white(0.04)).challenger(white(0.02), 40).challenger(white(0.004), 150);
  const auto findings = records.findings();
  EXPECT_GT(findings[0].log_wealth, findings[1].log_wealth);
  EXPECT_EQ(weakest(findings).version, 2);
}

TEST(League, NothingIsDecidedOnBlocksOfWhichLittleIsBelieved) {
  Records records(160);
  records.champion(white(0.04)).challenger(white(0.01), 40);
  for (Block& block : records.league().blocks) block.believed = 0.4;
  EXPECT_EQ(records.obstacle(), Code::not_compared);
  EXPECT_EQ(records.findings()[0].blocks, 0);
}

TEST(League, AChampionFailsThatErrsMoreThanTheMeanOrTheSimulator) {
  Records good(80);
  EXPECT_FALSE(Judge(good.limits()).failure(good.champion(varying(0.3)).league()));
  Records bad(80);
  const auto failure = Judge(bad.limits()).failure(bad.champion(varying(4)).league());
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->code, Code::champion_failed);
  Records beside(80);
  beside.champion(varying(0.3));
  for (Block& block : beside.league().blocks) block.baseline_square = {0.05};
  EXPECT_TRUE(Judge(beside.limits()).failure(beside.league()));
}

TEST(League, AChampionFailsWhereTheOutputStandsStillAndTheModelDoesNot) {
  Records records(80);
  records.champion(varying(4));
  for (Block& block : records.league().blocks) {
    block.output_mean = {0.1};  // and a mean square as sums round
    block.output_square = {0.1 * 0.1 - 1e-18};
  }
  const auto failure = Judge(records.limits()).failure(records.league());
  ASSERT_TRUE(failure);
  EXPECT_THAT(sentence(*failure), testing::Not(testing::HasSubstr("nan")));
}

TEST(League, AChampionFailsWhoseGreatErrorsAreFew) {
  // It errs less than the mean on three blocks of five, and more than twice as much in all.
  const auto errors = [](int block) { return Error{0, block % 20 < 12 ? 0.2 : 12}; };
  for (const auto& [blocks, fails] : {std::pair(30, false), {80, true}}) {
    Records records(blocks);
    records.champion(errors);
    EXPECT_EQ(Judge(records.limits()).failure(records.league()).has_value(), fails) << blocks;
  }
}

TEST(League, AJudgeThatIsAskedAtEachBlockFindsWhatOneFindsThatIsAskedOnce) {
  Records records(160);
  records.swings(55, 63);
  records.swings(100, 103);
  records.champion([](int block) {
           return Error{0.1, block < 90 ? 0.01 : 0.5};
         })
      .challenger(varying(0.02), 40)
      .challenger(varying(0.01), 100)
      .challenger(
          [](int block) {
            return Error{0, block < 120 ? 0.01 : 0.5};
          },
          30)
      .unbound();
  records.league().replaced = 4;
  const League all = records.league();
  League grown = all;
  Judge judge(records.limits());
  for (std::size_t blocks = 1; blocks <= all.blocks.size(); ++blocks) {
    grown.blocks.assign(all.blocks.begin(), all.blocks.begin() + std::ptrdiff_t(blocks));
    const auto until = grown.blocks.back().range.begin;
    const auto cut = [until](const Member& from, Member& to) {
      to.scores = from.scores;
      std::erase_if(to.scores, [until](const auto& score) { return score.begin > until; });
    };
    cut(*all.champion, *grown.champion);
    for (std::size_t i = 0; i < all.challengers.size(); ++i)
      cut(all.challengers[i], grown.challengers[i]);
    const auto found = judge.findings(grown), expected = Judge(records.limits()).findings(grown);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].blocks, expected[i].blocks) << blocks;
      EXPECT_EQ(found[i].log_wealth, expected[i].log_wealth) << blocks;
      EXPECT_EQ(found[i].lower_score, expected[i].lower_score) << blocks;
      EXPECT_EQ(found[i].dependence, expected[i].dependence) << blocks;
      EXPECT_EQ(found[i].uncovered_share, expected[i].uncovered_share) << blocks;
      EXPECT_EQ(found[i].changed, expected[i].changed) << blocks;
      EXPECT_EQ(found[i].mrse_percent, expected[i].mrse_percent) << blocks;
    }
    EXPECT_EQ(judge.failure(grown).has_value(), Judge(records.limits()).failure(grown).has_value());
  }
  EXPECT_TRUE(judge.change(grown));
}

}  // namespace
}  // namespace reident::test::league
