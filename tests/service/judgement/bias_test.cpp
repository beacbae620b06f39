// Condition R3: a version that is better by what a sensor's offset explains waits.
#include <cmath>

#include <gmock/gmock.h>

#include "service/judgement/league.hpp"
#include "tests/service/judgement/league_records.hpp"

namespace reident::test::league {
namespace {

/// From block 100 on the champion errs by a constant more.
Records better_by_a_constant() {
  Records records(200);
  records.champion([](int block) {
           return block < 100 ? Error{0, 0.01} : Error{0.3, 0.01};
         })
      .challenger(varying(0.01), 100)
      .unbound();
  return records;
}

TEST(Bias, VersionThatIsBetterByAConstantAloneWaitsWhereASensorMayBeBiased) {
  Records records = better_by_a_constant();
  EXPECT_EQ(records.obstacle(), Code::bias_unverified);
  records.limits().bias = BiasPolicy::approve;
  EXPECT_EQ(records.obstacle(), std::nullopt);
  records.limits().bias = BiasPolicy::wait;
  records.league().unbound.clear();
  EXPECT_EQ(records.obstacle(), std::nullopt);
}

TEST(Bias, VersionIsNoBiasWhereTwoOutputsErrTogether) {
  Records records = better_by_a_constant();
  const auto twice = [](std::vector<double>& values) { values.push_back(values[0]); };
  for (Block& block : records.league().blocks) {
    twice(block.output_mean);
    twice(block.output_square);
  }
  for (Member* member : {&*records.league().champion, &records.league().challengers[0]})
    for (BlockScore& score : member->scores)
      for (auto* values : {&score.mean, &score.square, &score.noise}) twice(*values);
  records.league().outputs = {"y", "z"};
  records.league().unbound = {"y", "z"};
  EXPECT_EQ(records.obstacle(), std::nullopt);
  // The other output errs as little as before.
  for (BlockScore& score : records.league().champion->scores)
    score.mean[1] = 0, score.square[1] = 0.01;
  EXPECT_EQ(records.obstacle(), Code::bias_unverified);
}

TEST(Bias, OffsetOfAnOutputThatARelationBindsIsNoBias) {
  Records records = better_by_a_constant();
  records.league().unbound = {"v"};
  records.league().biases = {{"v"}};
  for (BlockScore& score : records.league().champion->scores)
    score.bias_effects = {5 + 0.1 * std::sin(double(score.begin)), 0.25, -0.5 * score.mean[0]};
  EXPECT_EQ(records.obstacle(), std::nullopt) << "v reads as always";
}

/// Errors of 0.5 in the rms from block 100 on, of which `explained` are the effect of an offset by
/// 1 of a sensor, whose mean moves by `moved`.
Records sensor_of_an_input(double explained, double moved) {
  Records records(200);
  records.champion([](int block) {
           return Error{0, block < 100 ? 0.01 : 0.26};
         })
      .challenger(varying(0.01), 100)
      .unbound();
  records.league().unbound = {"v"};
  records.league().biases = {{"v"}};
  int block = 0;
  for (BlockScore& score : records.league().champion->scores) {
    const double mean = 5 + 0.1 * std::sin(block);
    score.bias_effects = {mean + (block < 100 ? 0 : moved), 0.25, block < 100 ? 0 : -explained};
    ++block;
  }
  return records;
}

TEST(Bias, VersionThatIsBetterByASensorsEffectAloneWaits) {
  EXPECT_EQ(sensor_of_an_input(0.25, 1).obstacle(), Code::bias_unverified);
  EXPECT_EQ(sensor_of_an_input(0.05, 1).obstacle(), std::nullopt) << "it explains the least part";
}

TEST(Bias, TheQuestionSaysHowFarTheSensorWouldBeOff) {
  for (auto [records, said] : {std::pair(better_by_a_constant(), "y (0.3 too high)"),
                               {sensor_of_an_input(0.25, 1), "v (1 too high)"},
                               {sensor_of_an_input(-0.25, -1), "v (1 too low)"}})
    EXPECT_THAT(sentence(*records.findings().at(0).obstacle), ::testing::HasSubstr(said));
}

TEST(Bias, VersionIsNoBiasOfASensorThatReadsAsBefore) {
  EXPECT_EQ(sensor_of_an_input(0.25, 0).obstacle(), std::nullopt);
}

TEST(Bias, VersionIsNoBiasOfASensorThatARelationBinds) {
  Records records = sensor_of_an_input(0.25, 1);
  records.league().biases = {{"bound"}, {"v"}};
  for (BlockScore& score : records.league().champion->scores)
    score.bias_effects.insert(score.bias_effects.end(), {30, 0, 0});
  EXPECT_EQ(records.obstacle(), std::nullopt) << "the first sensor is bound, and its effect is it";
  records.league().biases = {{"v"}, {"bound"}};
  EXPECT_EQ(records.obstacle(), Code::bias_unverified);
}

// As a root has it, an offset of 2 upwards makes the errors, and none downwards does.
TEST(Bias, EachDirectionOfABiasIsLookedAtByItself) {
  Records records = sensor_of_an_input(0.25, 2);
  for (BlockScore& score : records.league().champion->scores) {
    const double mean = score.bias_effects[0], product = score.bias_effects[2] / 2;
    score.bias_effects = {mean, 0.25, 0, mean, 0.0625, product};
  }
  for (const auto& [first, obstacle] :
       {std::pair(-1, std::optional(Code::bias_unverified)), {1, std::nullopt}}) {
    records.league().biases = {{"v", first}, {"v", -first}};
    EXPECT_EQ(records.obstacle(), obstacle) << first;
    if (!obstacle) continue;
    EXPECT_THAT(sentence(*records.findings().at(0).obstacle),
                ::testing::HasSubstr("of v (2 too high) would"));
  }
  records.league().biases = {{"v", 1}};
  EXPECT_EQ(records.obstacle(), std::nullopt) << "rows of other biases say nothing";
}

TEST(Bias, VersionThatIsBetterByAConstantMostOfAllWaits) {
  // A constant of the champion's errors explains all but log(1.4) of the gain, which is log(10); or
  // all but log(2.8).
  for (const auto& [square, obstacle] :
       {std::pair(0.02, std::optional(Code::bias_unverified)), {0.08, std::nullopt}}) {
    Records records(200);
    records
        .champion([left = square](int block) {
          return block < 100 ? Error{0, 0.01} : Error{1, left};
        })
        .challenger(varying(0.01), 100)
        .unbound();
    EXPECT_EQ(records.obstacle(), obstacle) << square;
    const Finding found = records.findings().at(0);
    EXPECT_GT(found.wealth_without_offset, found.log_threshold);
  }
}

// An offset that was another in each cycle would explain whatever a poor model errs.
TEST(Bias, VersionThatRanBeforeReturnsAlsoWhereTheChampionErrsByAConstant) {
  Records records = better_by_a_constant();
  ASSERT_EQ(records.obstacle(), Code::bias_unverified);
  records.league().replaced = records.league().challengers[0].version;
  EXPECT_EQ(records.obstacle(), std::nullopt);
}

TEST(Bias, ErrorsThatWanderAreNoOffset) {
  EXPECT_EQ(Records(400)
                .champion([](int block) {
                  return block < 100 ? Error{0, 0.01} : Error{std::sin(block / 20.0), 0.01};
                })
                .challenger(varying(0.01), 100)
                .unbound()
                .obstacle(),
            std::nullopt);
}

TEST(Bias, VersionThatIsBetterWithoutTheConstantTooIsNoBias) {
  EXPECT_EQ(Records(200)
                .champion([](int block) {
                  return block < 100 ? Error{0, 0.01} : Error{0.3, 0.1};
                })
                .challenger(varying(0.01), 100)
                .unbound()
                .obstacle(),
            std::nullopt);
}

}  // namespace
}  // namespace reident::test::league
