#include "service/judgement/gate.hpp"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace reident::gate_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

EquipmentConfig limits() {
  EquipmentConfig config;
  config.max_mrse_percent = 10;
  config.min_fit_percent = 40;
  config.margin_percent = 5;
  return config;
}

/// Passes every condition against a champion of 8 %.
Evidence good() {
  Evidence evidence;
  evidence.well_formed = true;
  evidence.validation_moves = true;
  evidence.spectral_radius = 0.9;
  evidence.mrse_percent = 5;
  evidence.fit_percent = 70;
  evidence.residual_over_span = 0.3;
  evidence.window_end = 1000;
  evidence.mean = {.rows = 500,
                   .mrse_percent = 5,
                   .rival_mrse_percent = 17,
                   .reduction_percent = 70,
                   .sure_percent = 60};
  evidence.champion =
      Evidence::Champion{.version = 3,
                         .window_end = 900,
                         .comparison = Evidence::Comparison{.rows = 500,
                                                            .mrse_percent = 5,
                                                            .rival_mrse_percent = 8,
                                                            .reduction_percent = 37.5,
                                                            .sure_percent = 30},
                         .elsewhere = std::nullopt};
  return evidence;
}

struct Case {
  const char* name;
  std::function<void(Evidence&, EquipmentConfig&)> change;
  Outcome expected;
};

class Gate : public testing::TestWithParam<Case> {};

TEST_P(Gate, Decides) {
  Evidence evidence = good();
  EquipmentConfig config = limits();
  GetParam().change(evidence, config);
  const GateDecision decision = decide(evidence, config);
  EXPECT_EQ(name(decision.outcome), name(GetParam().expected)) << sentences(decision.reasons);
}

// Each reason, and the evidence that just misses it.
const Case of_the_candidate[] = {
    {"Good", [](auto&, auto&) {}, Outcome::approved},
    {"ConstantOffsetThatNobodyVouchesFor",
     [](auto& e, auto&) {
       e.champion->without_offset = e.champion->comparison;
       e.champion->without_offset->sure_percent = 5;
       e.champion->unbound = {"y"};
     },
     Outcome::unvouched},
    {"ConstantOffsetAndMore",
     [](auto& e, auto&) {
       e.champion->without_offset = e.champion->comparison;
       e.champion->unbound = {"y"};
     },
     Outcome::approved},
    {"ConstantOffsetOfSensorsThatARelationBinds",
     [](auto& e, auto&) { e.champion->without_offset = Evidence::Comparison{}; },
     Outcome::approved},
    {"ConstantOffsetThatMayBe",
     [](auto& e, auto& c) {
       e.champion->without_offset = Evidence::Comparison{};
       e.champion->unbound = {"y"};
       c.unvouched = UnvouchedPolicy::approve;
     },
     Outcome::approved},
    {"ByHand", [](auto&, auto& c) { c.approval = ApprovalPolicy::by_hand; }, Outcome::waiting},
    {"ConstantOutput", [](auto& e, auto&) { e.validation_moves = false; },
     Outcome::validation_says_nothing},
    {"Malformed", [](auto& e, auto&) { e.well_formed = false; }, Outcome::not_finite},
    {"ErrorNotFinite", [](auto& e, auto&) { e.mrse_percent = infinity; }, Outcome::not_finite},
    {"ErrorNotANumber", [](auto& e, auto&) { e.mrse_percent = nan; }, Outcome::not_finite},
    {"FitNotANumber", [](auto& e, auto&) { e.fit_percent = nan; }, Outcome::not_finite},
    {"RadiusOfOne", [](auto& e, auto&) { e.spectral_radius = 1; }, Outcome::unstable},
    {"RadiusNotANumber", [](auto& e, auto&) { e.spectral_radius = nan; }, Outcome::unstable},
    {"RadiusJustBelowOne", [](auto& e, auto&) { e.spectral_radius = 0.999999; }, Outcome::approved},
    {"SlowerThanTheWindow", [](auto& e, auto&) { e.slowest_over_window = 1.01; },
     Outcome::slower_than_window},
    {"AsSlowAsTheWindow", [](auto& e, auto&) { e.slowest_over_window = 1; }, Outcome::approved},
    {"ErrorAboveLimit", [](auto& e, auto&) { e.mrse_percent = 10.01; }, Outcome::error_above_limit},
    {"ErrorAtLimit", [](auto& e, auto&) { e.mrse_percent = 10; }, Outcome::approved},
    {"FitBelowLimit", [](auto& e, auto&) { e.fit_percent = 39.9; }, Outcome::fit_below_limit},
    {"FitAtLimit", [](auto& e, auto&) { e.fit_percent = 40; }, Outcome::approved},
    {"FitOfAConstant",
     [](auto& e, auto& c) {
       e.fit_percent = 0;
       c.min_fit_percent = 0;
     },
     Outcome::fit_below_limit},
    {"FitMinusInfinity", [](auto& e, auto&) { e.fit_percent = -infinity; },
     Outcome::fit_below_limit},
    {"ResidualBeyondSpan", [](auto& e, auto&) { e.residual_over_span = 1.01; },
     Outcome::residual_out_of_range},
    {"ResidualAtSpan", [](auto& e, auto&) { e.residual_over_span = 1; }, Outcome::approved},
    {"ResidualNotANumber", [](auto& e, auto&) { e.residual_over_span = nan; },
     Outcome::residual_out_of_range},
    {"PerhapsNoBetterThanTheMean", [](auto& e, auto&) { e.mean.sure_percent = 0; },
     Outcome::fit_below_limit},
    {"SurelyBetterThanTheMean", [](auto& e, auto&) { e.mean.sure_percent = 0.01; },
     Outcome::approved},
    {"TooFewSamplesToBeSureOfTheMean", [](auto& e, auto&) { e.mean.sure_percent.reset(); },
     Outcome::fit_below_limit},
    {"MostlyOutsideTheRange", [](auto& e, auto&) { e.outside_share = 0.51; },
     Outcome::inputs_out_of_range},
    {"HalfOutsideTheRange", [](auto& e, auto&) { e.outside_share = 0.5; }, Outcome::approved},
};

// Better by the margin, not surely, and telemetry after the window may be waited for.
const Case not_surely_better[] = {
    {"BetterAndNotSurelyWhereMoreTelemetryMayTell",
     [](auto& e, auto& c) {
       e.champion->comparison->sure_percent = 5;
       c.confirmation = 100;
     },
     Outcome::on_probation},
    {"BetterByLittleBesideTheNoise",
     [](auto& e, auto&) { e.champion->comparison->noise_percent = 2.2; },
     Outcome::not_better_than_champion},
    {"BetterByEnoughBesideTheNoise",
     [](auto& e, auto&) { e.champion->comparison->noise_percent = 2.1; }, Outcome::approved},
    {"BetterByLittleBesideTheNoiseWhereMoreTelemetryMayTell",
     [](auto& e, auto& c) {
       e.champion->comparison->noise_percent = 2.2;
       c.confirmation = 100;
     },
     Outcome::on_probation},
    {"BetterNotPlainlyBesideTheNoiseWhereMoreTelemetryMayTell",
     [](auto& e, auto& c) {
       e.champion->comparison->noise_percent = 1.6;
       c.confirmation = 100;
     },
     Outcome::on_probation},
    {"BetterPlainlyBesideTheNoise",
     [](auto& e, auto& c) {
       e.champion->comparison->noise_percent = 1.5;
       c.confirmation = 100;
     },
     Outcome::approved},
    {"NotBetterByTheMarginWhateverMoreTelemetryTells",
     [](auto& e, auto& c) {
       e.champion->comparison->sure_percent = 0;
       e.champion->comparison->reduction_percent = 5;
       c.confirmation = 100;
     },
     Outcome::not_better_than_champion},
    {"NotSurelyBetterAndOtherwiseWrong",
     [](auto& e, auto& c) {
       e.champion->comparison->sure_percent = 5;
       e.champion->elsewhere = {100, 10.1, 10.1, 9, 5};
       c.confirmation = 100;
     },
     Outcome::not_better_than_champion},
    {"NotSurelyBetterButForAnOffsetThatNobodyVouchesFor",
     [](auto& e, auto& c) {
       e.champion->comparison->sure_percent = 5;
       e.champion->without_offset = e.champion->comparison;
       e.champion->without_offset->reduction_percent = 4;
       e.champion->unbound = {"y"};
       c.confirmation = 100;
     },
     Outcome::not_better_than_champion},
    {"NotSurelyBetterAndHeld",
     [](auto& e, auto& c) {
       e.champion->comparison->sure_percent = 5;
       e.hold = {"ana", "eclipse season"};
       c.confirmation = 100;
     },
     Outcome::not_better_than_champion},
    {"NotSurelyBetterAndByHand",
     [](auto& e, auto& c) {
       e.champion->comparison->sure_percent = 5;
       c.approval = ApprovalPolicy::by_hand;
       c.confirmation = 100;
     },
     Outcome::not_better_than_champion},
};

void is_off_by_a_constant(Evidence& e, double sure_percent) {
  e.champion->without_offset = e.champion->comparison;
  e.champion->without_offset->sure_percent = sure_percent;
}

// Better by the margin, surely; of the champion without its mean error that is less sure.
const Case of_an_offset[] = {
    {"ConstantOffsetThatMoreTelemetryMayBearOut",
     [](auto& e, auto& c) {
       is_off_by_a_constant(e, 1.66);
       c.confirmation = 100;
     },
     Outcome::on_probation},
    {"ConstantOffsetOnTooFewSamples",
     [](auto& e, auto& c) {
       is_off_by_a_constant(e, 0);
       e.champion->without_offset->sure_percent.reset();
       c.confirmation = 100;
     },
     Outcome::on_probation},
    {"ConstantOffsetAndSurelyMore",
     [](auto& e, auto& c) {
       is_off_by_a_constant(e, 1.67);
       c.confirmation = 100;
     },
     Outcome::approved},
    {"ConstantOffsetWithoutProbation", [](auto& e, auto&) { is_off_by_a_constant(e, -10); },
     Outcome::approved},
    {"ConstantOffsetAndByHand",
     [](auto& e, auto& c) {
       is_off_by_a_constant(e, -10);
       c.approval = ApprovalPolicy::by_hand;
       c.confirmation = 100;
     },
     Outcome::waiting},
    {"ConstantOffsetThatNobodyVouchesForIsNotWaitedFor",
     [](auto& e, auto& c) {
       is_off_by_a_constant(e, -10);
       e.champion->unbound = {"y"};
       c.confirmation = 100;
     },
     Outcome::unvouched},
};

const Case of_the_operation[] = {
    {"UnusualOperationThatMoreTelemetryMayEnd",
     [](auto& e, auto& c) {
       e.champion->movement = 0.52;
       c.confirmation = 100;
     },
     Outcome::on_probation},
    {"OperationThatIsUsual",
     [](auto& e, auto& c) {
       e.champion->movement = 0.54;
       c.confirmation = 100;
     },
     Outcome::approved},
    {"InputThatStandsStillAllOverTheWindow",
     [](auto& e, auto& c) {
       e.champion->still = "u";
       c.confirmation = 100;
     },
     Outcome::on_probation},
    {"UnusualOperationWithoutProbation", [](auto& e, auto&) { e.champion->movement = 0; },
     Outcome::approved},
};

void errs_as_where_validated(Evidence& e, double sure_percent_there) {
  e.champion->validated_mrse_percent = 8;
  e.champion->where_validated = Evidence::Comparison{300, 5, 8, 37.5, sure_percent_there};
}

const Case without_a_change[] = {
    {"ChampionErrsAsWhereItWasValidated",
     [](auto& e, auto& c) {
       e.champion->validated_mrse_percent = 5.34;  // two thirds of its error now, and a little more
       c.confirmation = 100;
     },
     Outcome::on_probation},
    {"ChampionErrsAsWhereItWasValidatedAndSurelyMoreThere",
     [](auto& e, auto& c) {
       errs_as_where_validated(e, 5.1);
       c.confirmation = 100;
     },
     Outcome::approved},
    {"ChampionErrsAsWhereItWasValidatedAndNotSurelyMoreThere",
     [](auto& e, auto& c) {
       errs_as_where_validated(e, 5);
       c.confirmation = 100;
     },
     Outcome::on_probation},
    {"ChampionErrsHalfAsMuchAgain",
     [](auto& e, auto& c) {
       e.champion->validated_mrse_percent = 5.33;
       c.confirmation = 100;
     },
     Outcome::approved},
    {"FewerSamplesThanASlowModeLasts",
     [](auto& e, auto& c) {
       e.champion->slowest_rows = 500.1;
       c.confirmation = 100;
     },
     Outcome::on_probation},
    {"AsManySamplesAsASlowModeLasts",
     [](auto& e, auto& c) {
       e.champion->slowest_rows = 500;
       c.confirmation = 100;
     },
     Outcome::approved},
    {"FewerSamplesThanASlowModeLastsWithoutProbation",
     [](auto& e, auto&) { e.champion->slowest_rows = 500.1; }, Outcome::approved},
    {"ChampionErrsAsWhereItWasValidatedWithoutProbation",
     [](auto& e, auto&) { e.champion->validated_mrse_percent = 8; }, Outcome::approved},
};

const Case where_the_champion_was_validated[] = {
    {"DisagreesElsewhere",
     [](auto& e, auto&) {
       e.champion->elsewhere = {100, 10.1, 10.1, 8.1, 5};
     },
     Outcome::disagrees_with_champion},
    {"DisagreesElsewhereAsAChangeExplains",
     [](auto& e, auto&) {
       e.champion->elsewhere = {100, 10.1, 10.1, 8, 5};  // the champion's error now
     },
     Outcome::approved},
    {"DisagreesElsewhereAndGainsAConstantAlone",
     [](auto& e, auto&) {
       e.champion->elsewhere = {100, 10.1, 10.1, 8, 5};
       e.champion->without_offset = Evidence::Comparison{500, 5, 5.2, 3.8, 1.66};
     },
     Outcome::disagrees_with_champion},
    {"DisagreesElsewhereByTheConstantThatItGains",
     [](auto& e, auto& c) {
       e.champion->elsewhere = {100, 50, 10, 8.1, 5};
       e.champion->without_offset = Evidence::Comparison{500, 5, 5.2, 3.8, 1.66};
       c.confirmation = 100;
     },
     Outcome::on_probation},
    {"DisagreesElsewhereByTheConstantThatItGainsWithoutProbation",
     [](auto& e, auto&) {
       e.champion->elsewhere = {100, 50, 10, 8.1, 5};
       e.champion->without_offset = Evidence::Comparison{500, 5, 5.2, 3.8, 1.66};
     },
     Outcome::disagrees_with_champion},
    {"AgreesElsewhere",
     [](auto& e, auto&) {
       e.champion->elsewhere = {100, 10, 20, 6, 5};
     },
     Outcome::approved},
    {"DisagreesElsewhereAndIsRight",
     [](auto& e, auto&) {
       e.champion->elsewhere = {100, 50, 50, 4.9, 5};
     },
     Outcome::approved},
};

const Case beside_its_rivals[] = {
    {"BetterByTheMarginAndNotSurely",
     [](auto& e, auto&) { e.champion->comparison->sure_percent = 5; },
     Outcome::not_better_than_champion},
    {"SurelyBetterByMoreThanTheMargin",
     [](auto& e, auto&) { e.champion->comparison->sure_percent = 5.01; }, Outcome::approved},
    {"FaultsOfSensorsAllOver", [](auto& e, auto&) { e.fault_share = 0.0026; },
     Outcome::telemetry_in_doubt},
    {"AFewFaultsOfSensors", [](auto& e, auto&) { e.fault_share = 0.0025; }, Outcome::approved},
    {"FirstAmongFaultsOfSensors",
     [](auto& e, auto&) {
       e.champion.reset();
       e.fault_share = 0.1;
     },
     Outcome::approved},
    {"TooFewSamplesToCompare", [](auto& e, auto&) { e.champion->comparison->sure_percent.reset(); },
     Outcome::comparison_says_nothing},
    {"ChampionWentAstray",
     [](auto& e, auto&) {
       e.champion->comparison->rival_mrse_percent = infinity;
       e.champion->comparison->sure_percent.reset();
     },
     Outcome::approved},
    {"ChampionCannotRun", [](auto& e, auto&) { e.champion->comparison.reset(); },
     Outcome::approved},
    {"TooSoonAfterTheChampion", [](auto&, auto& c) { c.min_interval = 101; }, Outcome::too_soon},
    {"LateEnoughAfterTheChampion", [](auto&, auto& c) { c.min_interval = 100; }, Outcome::approved},
    {"Held",
     [](auto& e, auto&) {
       e.hold = {"ana", "eclipse season"};
     },
     Outcome::held},
    {"HeldAndNotGoodEnough",
     [](auto& e, auto&) {
       e.hold = {"ana", "eclipse season"};
       e.fit_percent = 1;
     },
     Outcome::fit_below_limit},
    {"OlderThanChampion", [](auto& e, auto&) { e.window_end = 899; }, Outcome::older_than_champion},
    {"SameWindowAsChampion", [](auto& e, auto&) { e.window_end = 900; }, Outcome::approved},
    {"FirstAndWorseThanBaseline",
     [](auto& e, auto& c) {
       e.champion.reset();
       c.baseline_mrse_percent = 5;
     },
     Outcome::not_better_than_baseline},
    {"FirstAndBetterThanBaseline",
     [](auto& e, auto& c) {
       e.champion.reset();
       c.baseline_mrse_percent = 5.01;
     },
     Outcome::approved},
    {"FirstAndNotSurelyBetterThanTheSimulatorByTheMargin",
     [](auto& e, auto& c) {
       e.champion.reset();
       e.baseline = {500, 5, 6, 16.7, 5.0};
       c.baseline_mrse_percent = 100;
     },
     Outcome::not_better_than_baseline},
    {"FirstAndSurelyBetterThanTheSimulatorByTheMargin",
     [](auto& e, auto& c) {
       e.champion.reset();
       e.baseline = {500, 5, 6, 16.7, 5.1};
       c.baseline_mrse_percent = 1;
     },
     Outcome::approved},
    {"FirstWithoutBaseline", [](auto& e, auto&) { e.champion.reset(); }, Outcome::approved},
    {"ChampionCannotRunAndTheBaselineIsBetter",
     [](auto& e, auto&) {
       e.champion->comparison.reset();
       e.baseline = {500, 5, 4, -25, -30.0};
     },
     Outcome::not_better_than_baseline},
    {"BaselineNoLongerCountsOnceThereIsAChampionThatRuns",
     [](auto&, auto& c) { c.baseline_mrse_percent = 1; }, Outcome::approved},
};

const auto name_of = [](const auto& one) { return one.param.name; };
INSTANTIATE_TEST_SUITE_P(OfTheCandidate, Gate, testing::ValuesIn(of_the_candidate), name_of);
INSTANTIATE_TEST_SUITE_P(NotSurelyBetter, Gate, testing::ValuesIn(not_surely_better), name_of);
INSTANTIATE_TEST_SUITE_P(OfAnOffset, Gate, testing::ValuesIn(of_an_offset), name_of);
INSTANTIATE_TEST_SUITE_P(OfTheOperation, Gate, testing::ValuesIn(of_the_operation), name_of);
INSTANTIATE_TEST_SUITE_P(WithoutAChange, Gate, testing::ValuesIn(without_a_change), name_of);
INSTANTIATE_TEST_SUITE_P(WhereTheChampionWasValidated, Gate,
                         testing::ValuesIn(where_the_champion_was_validated), name_of);
INSTANTIATE_TEST_SUITE_P(BesideItsRivals, Gate, testing::ValuesIn(beside_its_rivals), name_of);

TEST(GateReason, NamesTheFiguresThatDecided) {
  Evidence evidence = good();
  evidence.champion->comparison = Evidence::Comparison{500, 5, 5.5, 9.09, 3.2};
  EXPECT_EQ(decide(evidence, limits()).reasons,
            std::vector{because<ReasonCode::not_surely_better>(5.0, 3, 5.5, 5.0, 9.09, 3.2, 99.0)});
}

TEST(GateReason, OfALittleGainNamesTheNoise) {
  Evidence evidence = good();
  evidence.champion->comparison->noise_percent = 3;
  EXPECT_EQ(decide(evidence, limits()).reasons,
            std::vector{because<ReasonCode::gain_within_noise>(5.0, 3, 8.0, 3.0)});
}

TEST(GateReason, OfAHoldNamesWhoHoldsAndWhy) {
  Evidence evidence = good();
  evidence.hold = {"ana", "eclipse season"};
  EXPECT_EQ(decide(evidence, limits()).reasons,
            (std::vector{because<ReasonCode::better_than_champion>(5.0, 3, 8.0),
                         because<ReasonCode::held>("ana", "eclipse season")}));
}

TEST(GateReason, OfAWaitNamesWhatTelemetryIsToTell) {
  Evidence evidence = good();
  evidence.champion->movement = 0.5;
  EquipmentConfig waiting = limits();
  waiting.confirmation = 60;
  EXPECT_EQ(decide(evidence, waiting).reasons,
            (std::vector{because<ReasonCode::better_than_champion>(5.0, 3, 8.0),
                         because<ReasonCode::operation_unusual>(50.0),
                         because<ReasonCode::waits_for_telemetry>(60)}));
}

}  // namespace
}  // namespace reident::gate_test
