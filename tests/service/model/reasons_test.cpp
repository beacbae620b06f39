// The wording of every reason: other tests look at codes and figures.
#include "service/model/reasons.hpp"

#include <map>
#include <stdexcept>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace reident::test::reasons_test {
namespace {

using Code = ReasonCode;
using storage::DecisionKind;

constexpr std::int64_t hour = 3'600'000'000'000;

struct Example {
  Reason reason;
  const char* sentence;
};

const Example without_candidate[] = {
    {because<Code::unknown_parameter>("V_BUS"),
     "Parameter V_BUS has not been described by telemetry yet; check its name in the configuration "
     "or wait for its descriptor."},
    {because<Code::telemetry_damaged>("601 samples of V_BUS are damaged"),
     "601 samples of V_BUS are damaged"},
    {because<Code::low_coverage>(41.66, 90.0, "S_SAFE", 43.21),
     "Only 41.7 % of the window has every parameter valid; 90 % are needed. S_SAFE alone has a "
     "value in 43.2 %."},
    {because<Code::low_coverage_with_derived>(41.66, 92.5, "S_SAFE", 43.21),
     "Only 41.7 % of the window has every parameter valid and every derived input finite; 92.5 % "
     "are needed. S_SAFE alone has a value in 43.2 %."},
    {because<Code::implausible>("V_BUS is stuck", 41.66, 90.0),
     "Telemetry is not believed: V_BUS is stuck. 41.7 % of the window is left, 90 % are needed."},
    {because<Code::no_model>("No output moves."), "No output moves."},
};

const Example of_admissibility[] = {
    {because<Code::not_finite>(), "The model or its run holds numbers that are not finite."},
    {because<Code::still_validation>(std::string("I_SA")),
     "I_SA does not move in the validation part, which says nothing about the model then."},
    {because<Code::unstable>(1.25), "The model is unstable: its spectral radius is 1.250000."},
    {because<Code::slower_than_window>(12.345),
     "Its slowest time constant is 12.3 times the window's length, which cannot tell it: a long "
     "run would drift away."},
    {because<Code::error_above_limit>(10.0101, 10.0),
     "MRSE 10.010 % on telemetry that it was not fitted to is above the limit of 10 %."},
    {because<Code::not_better_than_mean>(-3.217),
     "Fit -3.22 % on telemetry that it was not fitted to: an output's error is not below that of a "
     "constant at its mean (0 %)."},
    {because<Code::not_better_than_simulator>(5.0, 4.9),
     "MRSE 5.000 % is not shown to be below that of the simulator's own model (4.900 %)."},
    {because<Code::challenger>(5.0),
     "A challenger with MRSE 5.000 % on its validation part: that and the telemetry after its "
     "window decide."},
    {because<Code::not_better_where_validated>(5.0, 3, 4.5),
     "MRSE 5.000 % on its validation part, where champion 3 has 4.500 %."},
};

const Example of_a_member[] = {
    {because<Code::too_few_blocks>(3, 4),
     "3 blocks of telemetry that it was not fitted to; a first version needs a whole cycle, 4."},
    {because<Code::first_version>(5.0, 70.0, 12),
     "The first version: MRSE 5.000 %, fit 70.0 % on 12 blocks of telemetry that it was not fitted "
     "to."},
    {because<Code::better>(5.0, 40, 3, 8.0, 0.4384, 0.2, 95.0),
     "MRSE 5.000 % on 40 blocks of telemetry that it was not fitted to; champion 3 has 8.000 % "
     "there. The mean score is 0.438, and at least 0.200 with a confidence of 95 %."},
    {because<Code::not_better>(3, 5.0, 5.5, 40, 1.234, 5.678),
     "Not shown to be better than champion 3: MRSE 5.000 % and 5.500 % on 40 blocks, log of the "
     "evidence 1.23 of 5.68."},
    {because<Code::within_margin>(3, 15.0, 5.0, 5.5, 40),
     "Does not err less than champion 3 by the margin of 15 %: MRSE 5.000 % and 5.500 % on 40 "
     "blocks."},
    {because<Code::not_compared>(3),
     "Not compared with champion 3 yet: no block since the last change of the equipment has an "
     "error of both."},
    {because<Code::not_covered>(3, 24.6),
     "Cannot replace champion 3 yet: it has not met the operating regimes of 25 % of the time "
     "since the last change of the equipment."},
    {because<Code::worse_in_regime>(3),
     "Worse than champion 3, with confidence, in an operating regime that this one has served."},
    {because<Code::worse_over_regimes>(3, 5.0, 4.5),
     "Over the operating regimes since the last change of the equipment, each with its share of "
     "the time, it errs no less than champion 3: MRSE 5.000 % and 4.500 %."},
    {because<Code::worse_before_change>(5.0, 3, 1.5),
     "Before the last change of the equipment it errs 5.000 %, more than twice what champion 3 "
     "errs there or since, or another version there and since together: 1.500 %."},
    {because<Code::bias_unverified>(3, "V_BUS (0.3 too high), I_BUS (2 too low)"),
     "Better than champion 3 but for what a biased sensor of V_BUS (0.3 too high), I_BUS (2 too "
     "low) would show too; no relation binds it. Waits for an operator's approval."},
    {because<Code::too_soon>(hour, 3, 36 * hour),
     "The window ends 1h after that of champion 3; versions are at least 36h apart."},
    {because<Code::held>("ana", "eclipse season"),
     "Better; waits: ana holds the equipment (eclipse season)."},
    {because<Code::waits_for_operator>(5.0, 40),
     "Better, with MRSE 5.000 % on 40 blocks that it was not fitted to. Waits for an operator's "
     "approval."},
    {because<Code::league_full>(12),
     "The league has 12 challengers that score better or wait for an operator."},
    {because<Code::champion_failed>(3, 25.0, 40, "a constant at the mean", 20.0),
     "Champion 3 has MRSE 25.000 % on 40 blocks, where a constant at the mean has less: 20.000 "
     "%."},
};

TEST(Reasons, EachHasItsSentence) {
  std::map<Code, int> examples;
  const auto expect_worded = [&](const auto& these) {
    for (const Example& example : these) {
      ++examples[example.reason.code];
      EXPECT_EQ(sentence(example.reason), example.sentence) << name(example.reason.code);
    }
  };
  expect_worded(without_candidate);
  expect_worded(of_admissibility);
  expect_worded(of_a_member);
  for (const ReasonRow& row : Catalogue::reasons) EXPECT_EQ(examples[row.code], 1) << row.name;
}

TEST(Reasons, FollowOneAnotherInTextAndJson) {
  const std::vector<Reason> reasons = {because<Code::league_full>(12),
                                       because<Code::within_margin>(3, 15.0, 5.0, 5.5, 40)};
  EXPECT_EQ(sentences(reasons),
            "The league has 12 challengers that score better or wait for an operator. Does not err "
            "less than champion 3 by the margin of 15 %: MRSE 5.000 % and 5.500 % on 40 blocks.");
  EXPECT_EQ(to_json(reasons).dump(),
            R"([{"code":"league_full","members":12},)"
            R"({"code":"within_margin","champion":3,"margin_percent":15.0,"mrse_percent":5.0,)"
            R"("champion_mrse_percent":5.5,"blocks":40}])");
  EXPECT_EQ(outcome_of({because<Code::challenger>(5.0)}), Outcome::challenger);
}

TEST(Reasons, OfWhichTheLastHasNoOutcomeAreNotThoseOfAnAttempt) {
  EXPECT_THROW(outcome_of({}), std::logic_error);
  EXPECT_THROW(outcome_of({because<Code::challenger>(5.0), because<Code::held>("ana", "")}),
               std::logic_error);
}

TEST(Outcomes, SayWhatIsDecidedAboutAVersionOrAreRefused) {
  EXPECT_EQ(kind_of(Outcome::challenger), DecisionKind::wait);
  EXPECT_EQ(kind_of(Outcome::unstable), DecisionKind::reject);
  EXPECT_THROW(kind_of(Outcome::low_coverage), std::logic_error) << "there is no version";
  EXPECT_THROW(kind_of(static_cast<Outcome>(999)), std::logic_error) << "a new one without a row";
}

}  // namespace
}  // namespace reident::test::reasons_test
