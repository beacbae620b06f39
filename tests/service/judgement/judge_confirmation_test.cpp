// The decision of one look at a version on probation.
#include <functional>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "service/judgement/confirmation.hpp"
#include "tests/service/reason_codes.hpp"

namespace reident::test::judge_confirmation_test {
namespace {

using storage::DecisionKind;
using Code = ReasonCode;

ConfirmationEvidence sure_of(double percent) {
  ConfirmationEvidence look;
  look.champion = 3;
  look.comparison = {.rows = 500,
                     .mrse_percent = 5,
                     .rival_mrse_percent = 8,
                     .reduction_percent = 37.5,
                     .sure_percent = percent};
  look.after = look.with_window = look.comparison;
  return look;
}

TEST(JudgeProbation, ApprovesOnceTheReductionIsSurelyAThirdOfTheMargin) {
  const ConfirmationEvidence look = sure_of(5.1);
  const auto found = judge_probation(look, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, DecisionKind::approve);
  EXPECT_EQ(found->actor, "gate");
  const auto reasons = reasons_in(found->evidence_json);
  EXPECT_EQ(reasons[0]["code"], name(Code::evaluated));
  EXPECT_EQ(reasons[0]["champion"], 3);
  EXPECT_EQ(reasons[0]["champion_mrse_percent"], 8);
  EXPECT_EQ(reasons[1]["code"], name(Code::confirmed));
  EXPECT_EQ(reasons[1]["sure_reduction_percent"], 5.1);
  EXPECT_EQ(found->reason, sentences({because<Code::evaluated>(5.0, 500, look.until, 3, 8.0),
                                      because<Code::confirmed>(37.5, 99.0, 5.1)}));
  EXPECT_EQ(nlohmann::json::parse(found->evidence_json)["comparison"]["rows"], 500);
}

TEST(JudgeProbation, WaitsForMoreAndRejectsOnceItHasCome) {
  ConfirmationEvidence look = sure_of(5);
  EXPECT_FALSE(judge_probation(look, {}));
  look.stage = ConfirmationEvidence::Stage::due;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::reject);
}

TEST(JudgeProbation, LeavesAChampionThatErrsAsEverUntilAllHasCome) {
  ConfirmationEvidence look = sure_of(40);
  look.champion_validated_mrse_percent = 5.4;  // it errs by 8 now
  EXPECT_FALSE(judge_probation(look, {}));
  look.champion_validated_mrse_percent = 5.3;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
  look.champion_validated_mrse_percent = 8;
  look.stage = ConfirmationEvidence::Stage::due;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
}

TEST(JudgeProbation, WaitsForMoreWhereWhatCameAfterTheWindowIsNotSure) {
  ConfirmationEvidence look = sure_of(40);
  look.after.sure_percent = 0;
  EXPECT_FALSE(judge_probation(look, {}));
  look.stage = ConfirmationEvidence::Stage::due;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
}

TEST(JudgeProbation, WaitsAsLongAgainToBeSurelyBetterThanAChampionThatErrsAsEver) {
  ConfirmationEvidence look = sure_of(40);
  look.champion_validated_mrse_percent = 8;
  look.after.sure_percent = 0;
  look.stage = ConfirmationEvidence::Stage::due;
  EXPECT_FALSE(judge_probation(look, {}));
  look.stage = ConfirmationEvidence::Stage::last;
  const auto found = judge_probation(look, {});
  EXPECT_EQ(found->kind, DecisionKind::reject);
  EXPECT_EQ(code_in(found->evidence_json), name(Code::unconfirmed_after_not_sure));
  look.with_past = sure_of(5).comparison;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::reject);
  ConfirmationEvidence after = look, with_past = look;
  after.after.sure_percent = 0.1;
  with_past.with_past = sure_of(5.1).comparison;
  for (const auto stage : {ConfirmationEvidence::Stage::due, ConfirmationEvidence::Stage::last})
    for (ConfirmationEvidence sure : {after, with_past}) {
      sure.stage = stage;
      EXPECT_EQ(judge_probation(sure, {})->kind, DecisionKind::approve);
    }
}

TEST(JudgeProbation, RejectsWhatIsSurelyBetterByLessThanTheMargin) {
  ConfirmationEvidence look = sure_of(10);
  look.comparison.reduction_percent = 15;
  look.stage = ConfirmationEvidence::Stage::due;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::reject);
}

TEST(JudgeProbation, AsksForMoreThanAnOffsetWhereNoSensorVouchesForIt) {
  ConfirmationEvidence look = sure_of(40);
  look.without_offset = sure_of(4).comparison;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
  look.needs_vouching = true;
  EXPECT_FALSE(judge_probation(look, {}));
  look.without_offset = sure_of(6).comparison;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
  look.without_offset.sure_percent.reset();
  EXPECT_FALSE(judge_probation(look, {}));
  look.without_offset.rival_mrse_percent = 5.2;
  look.stage = ConfirmationEvidence::Stage::last;
  const auto evaluated = reasons_in(judge_probation(look, {})->evidence_json)[0];
  EXPECT_EQ(evaluated["code"], name(Code::evaluated_beside_offset));
  EXPECT_EQ(evaluated["without_offset_percent"], 5.2);
}

/// A constant of twice what the champion ever erred, over two time constants and a half.
ConfirmationEvidence of_a_slow_mode() {
  ConfirmationEvidence look = sure_of(40);
  look.stage = ConfirmationEvidence::Stage::last;
  look.champion_validated_mrse_percent = 4;
  look.slowest_rows = 200;
  look.without_offset.sure_percent = 5;
  look.over_tenure = look.comparison;
  look.over_tenure->rows = 600;
  look.over_tenure->sure_percent = 5.1;
  return look;
}

TEST(JudgeProbation, AsksTheTenureWhetherAConstantIsAnExcursionOfASlowMode) {
  EXPECT_EQ(judge_probation(of_a_slow_mode(), {})->kind, DecisionKind::approve);
  const std::vector<std::function<void(ConfirmationEvidence&)>> against = {
      [](ConfirmationEvidence& look) { look.over_tenure->sure_percent = 5; },
      [](ConfirmationEvidence& look) { look.over_tenure->rows = 599; }};
  const std::vector<std::function<void(ConfirmationEvidence&)>> no_excursion = {
      [](ConfirmationEvidence& look) { look.without_offset.sure_percent = 5.1; },
      [](ConfirmationEvidence& look) { look.slowest_rows = 500.0 / 3; },
      [](ConfirmationEvidence& look) { look.champion_validated_mrse_percent = 8.0 / 3; }};
  for (const auto& speak : against) {
    ConfirmationEvidence look = of_a_slow_mode();
    speak(look);
    const auto found = judge_probation(look, {});
    EXPECT_EQ(found->kind, DecisionKind::reject);
    EXPECT_EQ(code_in(found->evidence_json), name(Code::unconfirmed_excursion));
    for (const auto& change : no_excursion) {
      ConfirmationEvidence other = look;
      change(other);
      EXPECT_EQ(judge_probation(other, {})->kind, DecisionKind::approve);
    }
  }
}

TEST(JudgeProbation, TakesNoSmallGainBesideTheNoiseForLastingWhereASlowModeMayReturn) {
  ConfirmationEvidence look = of_a_slow_mode();
  look.comparison.noise_percent = 2.5;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::reject);
  look.slowest_rows = 100;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
}

TEST(JudgeProbation, SaysThatAnErrorMayBeAnExcursionWhereItHasNotBeenSoLarge) {
  ConfirmationEvidence look = of_a_slow_mode();
  look.champion_worst_mrse_percent = 4;  // half of what it is now
  look.over_tenure->reduction_percent = look.over_tenure->sure_percent.emplace(3);
  EXPECT_EQ(code_in(judge_probation(look, {})->evidence_json), name(Code::unconfirmed_excursion));
  look.champion_worst_mrse_percent = 6;
  EXPECT_EQ(code_in(judge_probation(look, {})->evidence_json),
            name(Code::unconfirmed_as_in_tenure));
}

TEST(JudgeProbation, AsksForAllOfTheMarginWhereTheVersionDoesNotKeepUp) {
  ConfirmationEvidence look = sure_of(15);
  look.stage = ConfirmationEvidence::Stage::last;
  look.validated_mrse_percent = 2.6;  // it errs by 5 after its window
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
  look.validated_mrse_percent = 2.5;
  const auto found = judge_probation(look, {});
  EXPECT_EQ(found->kind, DecisionKind::reject);
  const auto reason = reasons_in(found->evidence_json)[1];
  EXPECT_EQ(reason["code"], name(Code::unconfirmed_not_keeping_up));
  EXPECT_EQ(reason["needed_percent"], 15);
  look.comparison.sure_percent = 15.1;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
}

TEST(JudgeProbation, ApprovesNothingThatErrsMoreAfterItsWindow) {
  // An unusual stretch in the validation part still outweighs what came after it.
  ConfirmationEvidence look = sure_of(40);
  look.after = {.rows = 100,
                .mrse_percent = 6,
                .rival_mrse_percent = 5,
                .reduction_percent = -20,
                .sure_percent = {}};
  EXPECT_FALSE(judge_probation(look, {}));
  look.stage = ConfirmationEvidence::Stage::due;
  const auto found = judge_probation(look, {});
  EXPECT_EQ(found->kind, DecisionKind::reject);
  EXPECT_EQ(code_in(found->evidence_json), name(Code::unconfirmed_worse_after));
}

TEST(JudgeProbation, ApprovesNothingThatErrsMoreOverItsWindowToo) {
  ConfirmationEvidence look = sure_of(40);
  look.with_window = {.rows = 900,
                      .mrse_percent = 8,
                      .rival_mrse_percent = 8,
                      .reduction_percent = 0,
                      .sure_percent = {}};
  EXPECT_FALSE(judge_probation(look, {}));
  look.stage = ConfirmationEvidence::Stage::due;
  const auto found = judge_probation(look, {});
  EXPECT_EQ(found->kind, DecisionKind::reject);
  EXPECT_EQ(code_in(found->evidence_json), name(Code::unconfirmed_worse_with_window));
  EXPECT_EQ(nlohmann::json::parse(found->evidence_json)["with_window"]["rows"], 900);
}

TEST(JudgeProbation, OfAnOperationThatShowsLessThanTheChampionsNeedsTheMarginOverBoth) {
  ConfirmationEvidence look = sure_of(40);
  look.stage = ConfirmationEvidence::Stage::due;
  look.champion_validated_mrse_percent = 20;
  look.with_past = {.rows = 100,
                    .mrse_percent = 20,
                    .rival_mrse_percent = 20,
                    .reduction_percent = 0,
                    .sure_percent = {}};
  const auto found = judge_probation(look, {});
  EXPECT_EQ(found->kind, DecisionKind::reject);
  EXPECT_EQ(code_in(found->evidence_json), name(Code::unconfirmed_no_change));
  EXPECT_EQ(nlohmann::json::parse(found->evidence_json)["with_past"]["rows"], 100);
  look.with_past->reduction_percent = 15.1;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
}

TEST(JudgeProbation, ApprovesNothingAboveTheLimitOfTheError) {
  ConfirmationEvidence look = sure_of(40);
  look.comparison.mrse_percent = 20.1;
  EXPECT_FALSE(judge_probation(look, {}));
  look.stage = ConfirmationEvidence::Stage::due;
  EXPECT_EQ(code_in(judge_probation(look, {})->evidence_json), name(Code::unconfirmed_above_limit));
}

TEST(JudgeProbation, ApprovesNothingThatErrsMoreOverTheChampionsTenure) {
  ConfirmationEvidence look = sure_of(30);
  look.stage = ConfirmationEvidence::Stage::last;
  look.champion_worst_mrse_percent = 6;
  look.over_tenure = look.comparison;
  look.over_tenure->reduction_percent = 5.1;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
  look.over_tenure->reduction_percent = 5;
  const auto found = judge_probation(look, {});
  EXPECT_EQ(found->kind, DecisionKind::reject);
  EXPECT_EQ(code_in(found->evidence_json), name(Code::unconfirmed_as_in_tenure));
  EXPECT_EQ(nlohmann::json::parse(found->evidence_json)["over_tenure"]["rows"], 500);
}

TEST(JudgeProbation, ApprovesNothingThatGainsLittleBesideTheNoise) {
  ConfirmationEvidence look = sure_of(30);
  look.stage = ConfirmationEvidence::Stage::last;
  look.with_window.sure_percent = 15;
  look.comparison.noise_percent = 2.1;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
  look.comparison.noise_percent = 2.2;
  const auto found = judge_probation(look, {});
  EXPECT_EQ(found->kind, DecisionKind::reject);
  EXPECT_EQ(code_in(found->evidence_json), name(Code::unconfirmed_within_noise));
}

TEST(JudgeProbation, AsksForLessBesideTheNoiseOfWhatGainsSurelyAllOverItsWindowAndAfterIt) {
  ConfirmationEvidence look = sure_of(30);
  look.stage = ConfirmationEvidence::Stage::last;
  look.with_window.sure_percent = 15.1;
  look.after.sure_percent = 0.1;
  look.comparison.noise_percent = 3.7;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
  look.after.sure_percent = 0;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::reject);
  look.after.sure_percent = 0.1;
  look.comparison.noise_percent = 3.8;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::reject);
}

TEST(JudgeProbation, ApprovesWhatGainsNotPlainlyBesideTheNoiseAtTheLastLookAlone) {
  using Stage = ConfirmationEvidence::Stage;
  ConfirmationEvidence look = sure_of(30);
  look.comparison.noise_percent = 1.6;
  for (const Stage stage : {Stage::early, Stage::due}) {
    look.stage = stage;
    EXPECT_FALSE(judge_probation(look, {}));
  }
  look.stage = Stage::last;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
  look.stage = Stage::early;
  look.comparison.noise_percent = 1.5;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
}

TEST(JudgeProbation, ApprovesNothingAmongManyFaultsOfSensors) {
  ConfirmationEvidence look = sure_of(40);
  look.fault_share = 0.0025;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
  look.fault_share = 0.0026;
  EXPECT_FALSE(judge_probation(look, {}));
  look.stage = ConfirmationEvidence::Stage::due;
  const auto found = judge_probation(look, {});
  EXPECT_EQ(found->kind, DecisionKind::reject);
  EXPECT_EQ(code_in(found->evidence_json), name(Code::unconfirmed_in_doubt));
}

TEST(JudgeProbation, ApprovesNothingWhileAnInputStandsStill) {
  ConfirmationEvidence look = sure_of(40);
  look.still = "V_BUS";
  EXPECT_FALSE(judge_probation(look, {}));
  look.stage = ConfirmationEvidence::Stage::due;
  const auto found = judge_probation(look, {});
  EXPECT_EQ(found->kind, DecisionKind::reject);
  EXPECT_EQ(reasons_in(found->evidence_json)[1],
            nlohmann::json({{"code", name(Code::unconfirmed_input_still)}, {"input", "V_BUS"}}));
}

TEST(JudgeProbation, LeavesAChampionOfWhoseTenureHardlyAnythingIsBelievedUnlessItIsLeftBehind) {
  ConfirmationEvidence look = sure_of(40);
  look.stage = ConfirmationEvidence::Stage::last;
  look.champion_validated_mrse_percent = 8;
  look.tenure_believed = 0.5;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
  look.tenure_believed = 0.49;
  const auto found = judge_probation(look, {});
  EXPECT_EQ(found->kind, DecisionKind::reject);
  EXPECT_EQ(code_in(found->evidence_json), name(Code::unconfirmed_tenure_excluded));
  look.champion_validated_mrse_percent = 5;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
}

TEST(JudgeProbation, ApprovesNothingInAnUnusualOperation) {
  ConfirmationEvidence look = sure_of(40);
  look.movement = 0.54;
  EXPECT_EQ(judge_probation(look, {})->kind, DecisionKind::approve);
  look.movement = 0.52;
  EXPECT_FALSE(judge_probation(look, {}));
  look.stage = ConfirmationEvidence::Stage::due;
  const auto found = judge_probation(look, {});
  EXPECT_EQ(found->kind, DecisionKind::reject);
  EXPECT_EQ(code_in(found->evidence_json), name(Code::unconfirmed_unusual));
}

}  // namespace
}  // namespace reident::test::judge_confirmation_test
