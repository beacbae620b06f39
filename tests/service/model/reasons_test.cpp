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
    {because<Code::low_coverage>(41.66, 90.0),
     "Only 41.7 % of the window has every parameter valid; 90 % are needed."},
    {because<Code::low_coverage_with_derived>(41.66, 92.5),
     "Only 41.7 % of the window has every parameter valid and every derived input finite; 92.5 % "
     "are needed."},
    {because<Code::implausible>("V_BUS is stuck", 41.66, 90.0),
     "Telemetry is not believed: V_BUS is stuck. 41.7 % of the window is left, 90 % are needed."},
    {because<Code::no_model>("No output moves."), "No output moves."},
};

const Example against_a_candidate[] = {
    {because<Code::validation_says_nothing>(),
     "An output does not move in the validation part, so that no score there can tell a good model "
     "from a bad one."},
    {because<Code::not_finite>(), "The model or its run holds numbers that are not finite."},
    {because<Code::unstable>(1.25), "The model is unstable: its spectral radius is 1.250000."},
    {because<Code::slower_than_window>(12.345),
     "Its slowest time constant is 12.3 times the window's length, which cannot tell it: a long "
     "run would drift away."},
    {because<Code::error_above_limit>(10.0101, 10.0),
     "MRSE 10.010 % on unseen data is above the limit of 10 %."},
    {because<Code::fit_below_limit>(39.9, 40.0),
     "Fit 39.90 % on unseen data is below the limit of 40 % (0 % is a constant at the mean)."},
    {because<Code::fit_of_few_samples>(70.0, 49),
     "Fit 70.00 % on 49 unseen samples may be chance: they are too few, or too much of one "
     "stretch, to tell."},
    {because<Code::fit_not_sure>(70.0, 99.0),
     "Fit 70.00 % on unseen data may be chance: with a confidence of 99 % it is not above 0 % (a "
     "constant at the mean)."},
    {because<Code::residual_out_of_range>(1.5),
     "The largest error is 1.50 times the output's range."},
    {because<Code::inputs_out_of_range>(50.6),
     "On 51 % of the validation part an input is outside the range that the model was identified "
     "in: the score there is of an extrapolation."},
    {because<Code::not_better_than_simulator>(5.0, 5.1, 15.0),
     "MRSE 5.000 % does not surely undercut the simulator's own telemetry (5.100 % on the same "
     "samples) by 15 %."},
    {because<Code::not_below_baseline>(5.0, 4.9),
     "MRSE 5.000 % is not below the baseline's 4.900 %."},
    {because<Code::telemetry_in_doubt>(0.26, 3),
     "0.26 faults of sensors were found in 100 ticks: others that go unnoticed make any comparison "
     "doubtful, and champion 3 stays."},
    {because<Code::comparison_says_nothing>(49, 3),
     "49 samples compare the candidate with champion 3: too few, or too much of one stretch, to "
     "tell."},
    {because<Code::not_surely_better>(5.0, 3, 5.5, 5.0, 9.09, 3.2, 99.0),
     "MRSE 5.000 % does not surely undercut champion 3 (5.500 % on the same samples) by 5 %: the "
     "reduction is 9.09 %, and 3.20 % with a confidence of 99 %."},
    {because<Code::gain_within_noise>(5.0, 3, 8.0, 3.0),
     "MRSE 5.000 % undercuts champion 3 (8.000 % on the same samples) by too little beside the "
     "noise of the sensors (3.000 %)."},
    {because<Code::disagrees_with_champion>(120, 3, 33.33, 30.0),
     "On 120 samples of the window of champion 3, with inputs that this one was not validated "
     "with, the two differ by 33.3 % of the output's range, above the limit of 30 %, and the "
     "champion is nearer to the telemetry of that time."},
    {because<Code::older_than_champion>(3), "Champion 3 was identified from newer telemetry."},
    {because<Code::too_soon>(hour, 3, 36 * hour),
     "The window ends 1h after that of champion 3; versions are at least 36h apart."},
};

const Example for_a_candidate[] = {
    {because<Code::first_version>(5.0, 70.0),
     "First version: MRSE 5.000 %, fit 70.0 % on unseen data."},
    {because<Code::champion_cannot_run>(5.0, 3),
     "MRSE 5.000 % on unseen data, on which champion 3 cannot run."},
    {because<Code::better_than_champion>(5.0, 3, 8.0),
     "MRSE 5.000 % on unseen data; champion 3 has 8.000 % on the same samples."},
    {because<Code::held>("ana", "eclipse season"),
     "Waits: ana holds the equipment (eclipse season)."},
    {because<Code::offset_unvouched>(15.0, "V_BUS, I_BUS"),
     "But for a constant offset the champion is not surely worse by 15 %, and a sensor of V_BUS, "
     "I_BUS would show the same; no relation binds it. Waits for an operator's approval."},
    {because<Code::waits_for_operator>(), "Waits for an operator's approval."},
    {because<Code::offset_not_sure>(6.0, 5.0),
     "But for a constant offset the champion has 6.000 %, which is not surely worse by 5 %."},
    {because<Code::gain_near_noise>(2.0),
     "That is little less beside the noise of the sensors (2.000 %)."},
    {because<Code::shorter_than_slowest>(600.4),
     "But those are fewer than the slowest time constant of the two lasts (600)."},
    {because<Code::input_still>("V_BUS"),
     "But V_BUS stands still all over the window: it is stuck, or the operation is not the usual "
     "one."},
    {because<Code::operation_unusual>(52.0),
     "The inputs move over 52 % of the ranges that the champion was identified in: the operation "
     "is not the usual one."},
    {because<Code::hardly_changed>(8.0),
     "It had 8.000 % where it was validated, so that the equipment has hardly changed."},
    {because<Code::waits_for_telemetry>(hour),
     "Waits for 1h of telemetry after its window, or for twice as much."},
};

const Example of_an_evaluation[] = {
    {because<Code::evaluated>(5.0, 500, hour, 3, 8.0),
     "MRSE 5.000 % on 500 samples of the validation part and after it, until "
     "1970-01-01T01:00:00Z; champion 3 has 8.000 % there."},
    {because<Code::evaluated_beside_offset>(5.0, 500, hour, 3, 8.0, 5.2),
     "MRSE 5.000 % on 500 samples of the validation part and after it, until "
     "1970-01-01T01:00:00Z; champion 3 has 8.000 % there, 5.200 % but for a constant offset that "
     "no relation vouches for."},
    {because<Code::confirmed>(37.5, 99.0, 5.1),
     "Confirmed: the reduction is 37.50 %, and with a confidence of 99 % at least 5.10 %."},
    {because<Code::unconfirmed_champion_withdrawn>(),
     "Not confirmed: the champion that it was to replace was withdrawn; windows that end from now "
     "on are judged without one."},
    {because<Code::unconfirmed_confirmation_off>(),
     "Not confirmed: `confirmation` is 0 now, so that no version waits for telemetry after its "
     "window."},
    {because<Code::unconfirmed_older>(3),
     "Not confirmed: champion 3 was identified from newer telemetry."},
    {because<Code::unconfirmed_too_soon>(hour, 3, 36 * hour),
     "Not confirmed: the window ends 1h after that of champion 3; versions are at least 36h "
     "apart."},
    {because<Code::unconfirmed_damaged>(2, "its model cannot be read"),
     "Not confirmed: version 2 is damaged in the registry: its model cannot be read."},
    {because<Code::unconfirmed_other_outputs>(3), "Not confirmed: champion 3 has other outputs."},
    {because<Code::unconfirmed_nothing_left>(),
     "Not confirmed: no telemetry to judge it by is left."},
    {because<Code::unconfirmed_in_doubt>(0.26),
     "Not confirmed: with 0.26 faults of sensors found in 100 ticks any comparison is doubtful."},
    {because<Code::unconfirmed_above_limit>(20.0),
     "Not confirmed: that is above the limit of 20 %."},
    {because<Code::unconfirmed_nothing_after>(),
     "Not confirmed: of the telemetry after its window none is believed and says anything."},
    {because<Code::unconfirmed_worse_after>(100, 6.0, 5.0),
     "Not confirmed: on the 100 samples after its window alone it has 6.000 % and the champion "
     "5.000 %."},
    {because<Code::unconfirmed_worse_with_window>(8.0, 7.0),
     "Not confirmed: over all of its window and what came after it, it has 8.000 % and the "
     "champion 7.000 %."},
    {because<Code::unconfirmed_not_surely_less>(15.0, 5.0),
     "Not confirmed: that is not 15 % less, and surely 5 %."},
    {because<Code::unconfirmed_not_keeping_up>(15.0, 15.0, 5.0, 2.5),
     "Not confirmed: that is not 15 % less, and surely 15 %, as it has to be of a version that has "
     "5.000 % after its window and had 2.500 % where it was validated."},
    {because<Code::unconfirmed_within_noise>(2.2),
     "Not confirmed: that is too little less beside the noise of the sensors (2.200 %)."},
    {because<Code::unconfirmed_input_still>("V_BUS"),
     "Not confirmed: from the begin of its window on V_BUS stands still: it is stuck, or the "
     "operation is not the usual one."},
    {because<Code::unconfirmed_unusual>(52.0),
     "Not confirmed: there the inputs move over 52 % of the ranges that the champion was "
     "identified in: an unusual operation, which says little of the usual one."},
    {because<Code::unconfirmed_no_change>(20.0, 100, 19.0, 21.0),
     "Not confirmed: the champion had 20.000 % where it was validated, so that nothing tells of a "
     "change; over 100 samples of then and now the version has 19.000 % and the champion 21.000 "
     "%."},
    {because<Code::unconfirmed_after_not_sure>(100, 5.0, 8.0),
     "Not confirmed: on the 100 samples after its window alone it has 5.000 % and the champion "
     "8.000 %, which is not surely less."},
    {because<Code::unconfirmed_tenure_excluded>(8.0, 49.0),
     "Not confirmed: the champion had 8.000 % where it was validated, and of the telemetry that "
     "leads from then to the version's window 49 % is believed, so that nothing tells of a "
     "change."},
    {because<Code::unconfirmed_as_in_tenure>(6.0, 500, 5.0, 8.0),
     "Not confirmed: since the champion was validated it had up to 6.000 % already, so that "
     "nothing tells of a change; over 500 samples of then and now the version has 5.000 % and the "
     "champion 8.000 %."},
    {because<Code::unconfirmed_excursion>(5.2, 200.0, 600, 5.0, 8.0),
     "Not confirmed: but for a constant the champion has 5.200 %, and a mode with a time constant "
     "of 200 samples may make it for a while; over 600 samples since the champion was validated "
     "the version has 5.000 % and the champion 8.000 %."},
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
  expect_worded(against_a_candidate);
  expect_worded(for_a_candidate);
  expect_worded(of_an_evaluation);
  for (const ReasonRow& row : Catalogue::reasons) EXPECT_EQ(examples[row.code], 1) << row.name;
}

TEST(Reasons, FollowOneAnotherInTextAndJson) {
  const std::vector<Reason> reasons = {because<Code::better_than_champion>(5.0, 3, 8.0),
                                       because<Code::held>("ana", "eclipse season")};
  EXPECT_EQ(sentences(reasons),
            "MRSE 5.000 % on unseen data; champion 3 has 8.000 % on the same samples. Waits: ana "
            "holds the equipment (eclipse season).");
  EXPECT_EQ(to_json(reasons).dump(),
            R"([{"code":"better_than_champion","mrse_percent":5.0,"champion":3,)"
            R"("champion_mrse_percent":8.0},)"
            R"({"code":"held","actor":"ana","reason":"eclipse season"}])");
  EXPECT_EQ(outcome_of(reasons), Outcome::held);
}

TEST(Reasons, OfWhichTheLastHasNoOutcomeAreNotThoseOfAnAttempt) {
  EXPECT_THROW(outcome_of({}), std::logic_error);
  EXPECT_THROW(outcome_of({because<Code::held>("ana", ""), because<Code::input_still>("u")}),
               std::logic_error);
}

TEST(Outcomes, SayWhatIsDecidedAboutAVersionOrAreRefused) {
  EXPECT_EQ(kind_of(Outcome::approved), DecisionKind::approve);
  EXPECT_EQ(kind_of(Outcome::on_probation), DecisionKind::wait);
  EXPECT_EQ(kind_of(Outcome::unstable), DecisionKind::reject);
  EXPECT_THROW(kind_of(Outcome::low_coverage), std::logic_error) << "there is no version";
  EXPECT_THROW(kind_of(static_cast<Outcome>(999)), std::logic_error) << "a new one without a row";
}

}  // namespace
}  // namespace reident::test::reasons_test
