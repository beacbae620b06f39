#include "service/operations/refresh.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "service/model/model_json.hpp"
#include "tests/service/daemon_fixture.hpp"
#include "tests/service/judgement/evidence_page.hpp"
#include "tests/service/reason_codes.hpp"

namespace reident::test::refresh_test {
namespace {

using storage::DecisionKind;

const auto never = [] { return false; };

class Refresh : public DaemonTest {
 protected:
  Refresh() { archive.describe(descriptors()); }

  RefreshResult run(storage::Time end, const EquipmentConfig& equipment = plant()) {
    WindowCache nothing = window_cache_of("SAT", equipment);
    return run(end, nothing, equipment);
  }
  RefreshResult run(storage::Time end, WindowCache& kept,
                    const EquipmentConfig& equipment = plant()) {
    return refresh(archive, registry,
                   {"SAT", equipment, {end - equipment.window, end}, "slide", "digest"}, kept, {},
                   never);
  }
  void record(const RefreshResult& result) {
    registry.record(result.attempt, result.version, *result.decision);
  }
  void record_champion(const RefreshResult& result) {
    registry.record(result.attempt, result.version, {DecisionKind::approve, "gate", "good"});
  }

  storage::Database database = open();
  storage::Archive archive{database};
  storage::Registry registry{database};
};

TEST_F(Refresh, MakesAGoodModelAChallengerAndExplainsIt) {
  archive.append(telemetry(day, 601));
  const RefreshResult result = run(day + 10 * minute);
  EXPECT_EQ(result.attempt.outcome, "challenger") << result.attempt.reason;
  ASSERT_TRUE(result.candidate);
  EXPECT_EQ(result.candidate->inputs[0].name, "u");
  EXPECT_EQ(result.candidate->inputs[0].unit, "V");
  EXPECT_EQ(result.candidate->inputs[0].low, -1);
  EXPECT_EQ(result.candidate->inputs[0].high, 1);
  EXPECT_EQ(result.candidate->identified_from, (storage::TimeRange{day, day + 5 * minute}));
  EXPECT_EQ(result.candidate->validated_on,
            (storage::TimeRange{day + 7 * minute, day + 10 * minute}));
  EXPECT_GT(result.evidence.fit_percent, 90);
  const auto evidence = nlohmann::json::parse(result.attempt.evidence_json);
  EXPECT_EQ(evidence["rows_identified"], 300);
  EXPECT_EQ(evidence["rows_tuned"], 120);
  EXPECT_EQ(evidence["rows_validated"], 180);
  EXPECT_EQ(evidence["coverage"], 1.0);
  EXPECT_TRUE(evidence["timing_ms"].contains("load"));
}

TEST_F(Refresh, LooksForATrackingGainOnlyOfACandidateThatMayRun) {
  archive.append(telemetry(day, 601));
  const RefreshResult first = run(day + 10 * minute);
  EXPECT_TRUE(nlohmann::json::parse(first.attempt.evidence_json).contains("integral_feedback"));
  EquipmentConfig strict = plant();
  strict.max_mrse_percent = 1e-6;
  const RefreshResult turned_away = run(day + 10 * minute, strict);
  ASSERT_EQ(turned_away.attempt.outcome, "error_above_limit");
  EXPECT_FALSE(
      nlohmann::json::parse(turned_away.attempt.evidence_json).contains("integral_feedback"));
}

TEST_F(Refresh, SaysThatTelemetryIsDamagedAndWhich) {
  archive.append(telemetry(day, 601));
  archive.compact();
  damage_chunks(2);
  const RefreshResult result = run(day + 10 * minute);
  EXPECT_EQ(result.attempt.outcome, "telemetry_damaged");
  const auto reason = reasons_in(result.attempt.evidence_json)[0];
  EXPECT_EQ(reason["code"], name(ReasonCode::telemetry_damaged));
  EXPECT_THAT(reason["damage"].get<std::string>(), testing::HasSubstr("601 samples of v of SAT"));
  EXPECT_FALSE(result.candidate);
  EXPECT_FALSE(result.decision);
}

TEST_F(Refresh, LetsNoCandidateInThatErrsMoreThanTheChampionWhereItIsValidated) {
  archive.append(telemetry(day, 1201));
  const RefreshResult first = run(day + 20 * minute);
  registry.record(first.attempt, first.version, {DecisionKind::approve, "gate", "good"});
  // A window of the same end whose validation part the champion knows as well or better.
  EquipmentConfig rough = plant();
  rough.min_order = rough.max_order = 1;
  rough.inputs = {"u", "v"};
  const RefreshResult result = run(day + 20 * minute, rough);
  if (result.attempt.outcome == "challenger") {
    EXPECT_LT(result.evidence.mrse_percent, first.evidence.mrse_percent);
  } else {
    EXPECT_EQ(result.attempt.outcome, "not_better_than_champion");
    EXPECT_EQ(code_in(result.attempt.evidence_json), name(ReasonCode::not_better_where_validated));
  }
}

TEST_F(Refresh, PrefersAStaticGainWhereDynamicsAreNoBetter) {
  auto frames = telemetry(day, 601, 0, 0.05);
  for (auto& frame : frames)
    frame.samples[2].value += 2 * frame.samples[0].value - frame.samples[1].value;
  archive.append(frames);
  const RefreshResult result = run(day + 10 * minute);
  const auto evidence = nlohmann::json::parse(result.attempt.evidence_json);
  ASSERT_TRUE(result.candidate);
  EXPECT_LE(result.evidence.mrse_percent, evidence.at("static_mrse_percent"));
  if (result.candidate->dynamics.order() == 0) {
    EXPECT_EQ(result.candidate->method, "static regression");
    EXPECT_NEAR(result.candidate->dynamics.D(0, 0), 2, 0.02);
    EXPECT_NEAR(result.candidate->dynamics.D(0, 1), -1, 0.02);
  }
}

TEST_F(Refresh, AdaptsTheChampionTooAndTakesTheBetterOfTwo) {
  archive.append(telemetry(day, 1201, 1, 0.3));
  const RefreshResult first = run(day + 10 * minute);
  EXPECT_FALSE(nlohmann::json::parse(first.attempt.evidence_json).contains("adapted"));
  record_champion(first);
  for (const storage::Time end : {day + 15 * minute, day + 20 * minute}) {
    const RefreshResult result = run(end);
    const auto adapted = nlohmann::json::parse(result.attempt.evidence_json).at("adapted");
    const double of_champion = adapted.at("mrse_percent"),
                 of_search = adapted.at("identified_mrse_percent");
    EXPECT_EQ(adapted.at("version"), 1);
    EXPECT_EQ(adapted.at("is_candidate"), of_champion < of_search);
    EXPECT_EQ(result.evidence.mrse_percent, std::min(of_champion, of_search));
    EXPECT_EQ(result.candidate->method.starts_with("A and C of version 1"),
              of_champion < of_search);
  }
}

TEST_F(Refresh, MeasuresAChampionThatAShortWindowAdaptsByTheConfiguredWindow) {
  archive.append(telemetry(day, 600, 1, 0.3));
  record_champion(run(day + 10 * minute));
  archive.append(telemetry(day + 10 * minute, 301, 1.5, 0.3));
  WindowCache kept = window_cache_of("SAT", plant());
  const RefreshResult result = refresh(
      archive, registry,
      {"SAT", plant(), {day + 10 * minute, day + 15 * minute}, "drift", "digest"}, kept, {}, never);
  const auto evidence = nlohmann::json::parse(result.attempt.evidence_json);
  ASSERT_TRUE(evidence.at("adapted").at("is_candidate"));
  EXPECT_DOUBLE_EQ(result.evidence.slowest_over_window,
                   slowest_time_constant_s(result.candidate->dynamics) / 600);
}

TEST_F(Refresh, KeepsNoEvidenceThatItsPageDoesNotName) {
  auto frames = telemetry(day, 1201, 1, 0.3);
  frames[200].samples[1].value = 500;  // is not believed
  archive.append(frames);
  const auto expect_all_named = [this](storage::Time end) {
    const RefreshResult result = run(end);
    const auto evidence = nlohmann::json::parse(result.attempt.evidence_json);
    EXPECT_THAT(not_on_the_page(evidence), testing::IsEmpty());
    record(result);
    return evidence;
  };
  EXPECT_TRUE(expect_all_named(day + 10 * minute).contains("implausible"));
  registry.decide("SAT", "PLANT", 1, {DecisionKind::approve, "gate", "good"}, day);
  EXPECT_TRUE(expect_all_named(day + 15 * minute).contains("adapted"));
}

TEST_F(Refresh, GivesTheSameBitsForTheSameSamples) {
  archive.append(telemetry(day, 601));
  EXPECT_EQ(to_json(*run(day + 10 * minute).candidate).dump(),
            to_json(*run(day + 10 * minute).candidate).dump());
}

TEST_F(Refresh, IdentifiesFromWhatLiesBeforeTheValidationAlone) {
  archive.append(telemetry(day, 420));
  archive.append(telemetry(day + 420 * second, 181, 1.0, 0.01));
  const auto one = run(day + 10 * minute);
  storage::Database other_database(path().string() + "-other", storage::Database::Mode::read_write);
  storage::Archive other(other_database);
  storage::Registry other_registry(other_database);
  other.describe(descriptors());
  other.append(telemetry(day, 420));
  other.append(telemetry(day + 420 * second, 181, 5.0, 0.5));
  EquipmentConfig believing = plant();  // noise that is left out would move the parts
  believing.screening = false;
  WindowCache kept = window_cache_of("SAT", believing);
  const auto two =
      refresh(other, other_registry,
              {"SAT", believing, {day, day + 10 * minute}, "slide", "digest"}, kept, {}, never);
  ASSERT_TRUE(one.candidate && two.candidate);
  EXPECT_EQ(one.candidate->dynamics.A, two.candidate->dynamics.A);
  EXPECT_EQ(one.candidate->dynamics.B, two.candidate->dynamics.B);
  EXPECT_EQ(one.candidate->dynamics.y0, two.candidate->dynamics.y0);
  EXPECT_NE(one.evidence.mrse_percent, two.evidence.mrse_percent);
}

TEST_F(Refresh, NamesAParameterThatTelemetryHasNotDescribed) {
  EquipmentConfig equipment = plant();
  equipment.inputs = {"u", "w"};
  const RefreshResult result = run(day + 10 * minute, equipment);
  EXPECT_EQ(result.attempt.outcome, "unknown_parameter");
  EXPECT_EQ(reasons_in(result.attempt.evidence_json)[0]["parameter"], "w");
  EXPECT_FALSE(result.candidate);
}

TEST_F(Refresh, RefusesAWindowFullOfHoles) {
  archive.append(telemetry(day, 250));
  EXPECT_EQ(run(day + 10 * minute).attempt.outcome, "low_coverage");
  EXPECT_EQ(run(day + 60 * minute).attempt.outcome, "low_coverage") << "no sample at all";
}

TEST_F(Refresh, NamesTheParameterThatIsMissingMost) {
  const auto y = archive.parameter("SAT", "y")->id;
  int values = 0;
  auto frames = telemetry(day, 600);
  for (auto& frame : frames)
    std::erase_if(frame.samples,
                  [&](const auto& sample) { return sample.parameter == y && ++values % 8 != 0; });
  archive.append(frames);
  const auto reason = reasons_in(run(day + 10 * minute).attempt.evidence_json)[0];
  EXPECT_EQ(reason["parameter"], "y");
  EXPECT_NEAR(reason["parameter_coverage_percent"], 37.5, 1) << "a value is held for three periods";
}

TEST_F(Refresh, PassesTheVerdictOfTheIdentificationOn) {
  auto frames = telemetry(day, 601);
  for (auto& frame : frames) frame.samples[2].value = 7;
  archive.append(frames);
  const RefreshResult result = run(day + 10 * minute);
  EXPECT_EQ(result.attempt.outcome, "constant_outputs");
  EXPECT_EQ(code_in(result.attempt.evidence_json), name(ReasonCode::no_model));
  EXPECT_THAT(result.attempt.reason, testing::Not(testing::IsEmpty()));
}

TEST_F(Refresh, AdmitsNoCandidateThatErrsOnItsValidationPart) {
  auto frames = telemetry(day, 601);
  for (std::size_t k = 420; k < frames.size(); ++k) frames[k].samples[2].value = 7;
  archive.append(frames);
  EXPECT_EQ(run(day + 10 * minute).attempt.outcome, "error_above_limit");
}

TEST_F(Refresh, LeavesSamplesOfBadQualityOut) {
  auto frames = telemetry(day, 601);
  for (std::size_t k = 100; k < 160; ++k) {
    frames[k].samples[2].quality = storage::Quality::invalid;
    frames[k].samples[2].value = 1e6;
  }
  archive.append(frames);
  const RefreshResult result = run(day + 10 * minute);
  EXPECT_EQ(result.attempt.outcome, "challenger") << result.attempt.reason;
  EXPECT_LT(result.candidate->outputs[0].high, 20);
}

TEST_F(Refresh, LeavesOutWhatTwoFramesOfOneTimeDisagreeAbout) {
  const auto frames = telemetry(day, 601);
  std::vector<storage::TelemetryFrame> restamped(frames.begin() + 100, frames.begin() + 160);
  for (auto& frame : restamped)
    for (storage::Sample& sample : frame.samples) sample.value += 1e6;
  archive.append(restamped);
  archive.append(frames);
  const RefreshResult result = run(day + 10 * minute);
  EXPECT_EQ(result.attempt.outcome, "challenger") << result.attempt.reason;
  EXPECT_LT(result.candidate->outputs[0].high, 20);
}

TEST_F(Refresh, GivesTheSameBitsWhateverWasKeptOfEarlierWindows) {
  EquipmentConfig equipment = plant();
  equipment.window = 40 * minute;
  archive.append(telemetry(day, 3601));
  WindowCache kept = window_cache_of("SAT", equipment);
  const auto same_as_from_scratch = [&](storage::Time end) {
    const auto slid = run(end, kept, equipment), fresh = run(end, equipment);
    ASSERT_TRUE(slid.candidate && fresh.candidate) << slid.attempt.reason;
    EXPECT_EQ(slid.candidate->dynamics.A, fresh.candidate->dynamics.A);
    EXPECT_EQ(slid.candidate->dynamics.B, fresh.candidate->dynamics.B);
    EXPECT_EQ(slid.candidate->dynamics.y0, fresh.candidate->dynamics.y0);
    EXPECT_EQ(slid.evidence.mrse_percent, fresh.evidence.mrse_percent);
  };
  for (int minutes = 40; minutes <= 58; minutes += 9) same_as_from_scratch(day + minutes * minute);
  // A range that was played back late with other values than those it had without it.
  archive.append(telemetry(day + 25 * minute + second / 2, 120, 1.5));
  kept.forget({day + 25 * minute, day + 27 * minute});
  same_as_from_scratch(day + 59 * minute);
}

TEST_F(Refresh, OfASlidWindowReadsOnlyWhatIsNew) {
  EquipmentConfig equipment = plant();
  equipment.window = 40 * minute;
  archive.append(telemetry(day, 3601));
  WindowCache kept = window_cache_of("SAT", equipment);
  run(day + 40 * minute, kept, equipment);
  EXPECT_EQ(kept.ticks_read(), 2400);
  run(day + 50 * minute, kept, equipment);
  EXPECT_LE(kept.ticks_read(), 2400 + 600 + 2 * 512) << "the new minutes and a chunk at each end";
}

TEST_F(Refresh, IdentifiesFromADerivedInputAndPutsItsExpressionInTheModel) {
  EquipmentConfig equipment = plant();
  equipment.inputs = {"w"};
  equipment.derived = {{"w", "u + v / 2", "V"}};
  archive.append(telemetry(day, 601));
  const RefreshResult result = run(day + 10 * minute, equipment);
  ASSERT_EQ(result.attempt.outcome, "challenger") << result.attempt.reason;
  const Signal& input = result.candidate->inputs.at(0);
  EXPECT_EQ(input.expression, "u + v / 2");
  EXPECT_EQ(input.unit, "V");
  EXPECT_NEAR(input.low, -1.5, 0.01);
  EXPECT_NEAR(input.high, 1.5, 0.01);
  EXPECT_EQ(request_of(*result.candidate), request_of("SAT", equipment));
}

TEST_F(Refresh, StopsWhenItIsAskedTo) {
  archive.append(telemetry(day, 601));
  WindowCache kept = window_cache_of("SAT", plant());
  EXPECT_THROW(
      refresh(archive, registry, {"SAT", plant(), {day, day + 10 * minute}, "slide", "digest"},
              kept, {}, [] { return true; }),
      Stopped);
}

}  // namespace
}  // namespace reident::test::refresh_test
