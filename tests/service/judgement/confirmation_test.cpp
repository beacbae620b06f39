#include "service/judgement/confirmation.hpp"

#include <cmath>
#include <functional>
#include <utility>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "service/daemon/confirmation_watch.hpp"
#include "service/model/model_json.hpp"
#include "service/operations/refresh.hpp"
#include "tests/service/daemon_fixture.hpp"
#include "tests/service/judgement/evidence_page.hpp"
#include "tests/service/reason_codes.hpp"

namespace reident::test::confirmation_test {
namespace {

using storage::DecisionKind;
using Code = ReasonCode;

/// Champion 1 is of a plant of gain 1; version 2 is on probation.
class Probation : public DaemonTest {
 protected:
  static constexpr storage::Time window_end = day + 20 * minute;

  Probation() {
    archive.describe(descriptors());
    archive.append(telemetry(day, 600));
    make_version(day + 10 * minute, "approved", DecisionKind::approve);
  }
  /// From here on the plant has another gain; the version's window ends after ten minutes of it.
  void change_plant(double gain) {
    archive.append(telemetry(day + 10 * minute, 901, gain));
    make_version(window_end, "on_probation", DecisionKind::wait);
  }
  void make_version(storage::Time end, const std::string& outcome, DecisionKind kind) {
    make_version_of(equipment, end, outcome, kind);
  }
  void make_version_of(const EquipmentConfig& config, storage::Time end, const std::string& outcome,
                       DecisionKind kind, const std::function<void(EquipmentModel&)>& alter = {}) {
    WindowCache nothing = window_cache_of("SAT", config);
    RefreshResult result =
        refresh(archive, registry, {"SAT", config, {end - config.window, end}, "slide", "d"},
                nothing, {}, [] { return false; });
    ASSERT_TRUE(result.candidate) << result.attempt.reason;
    if (alter) {
      EquipmentModel model = equipment_model_from_json(result.version.model_json);
      alter(model);
      result.version.model_json = to_json(model).dump();
      result.version.digest = model_digest(model);
    }
    result.attempt.outcome = outcome;
    registry.record(result.attempt, result.version, {kind, "gate", "for the test"});
  }
  /// What was recorded.
  std::vector<ProbationDecision> look(storage::Time reached, storage::Time since = INT64_MIN) {
    std::vector<ProbationDecision> found;
    look_at_probation(archive, registry, "SAT", equipment, since, reached,
                      [&](const storage::DecisionState& state, const ProbationDecision& decided) {
                        found.push_back(decided);
                        return record(registry, state, decided, reached);
                      });
    return found;
  }
  std::string status(std::int64_t version) const {
    return registry.version("SAT", "PLANT", version)->status;
  }

  static EquipmentConfig with_confirmation() {
    EquipmentConfig config = plant();
    config.confirmation = 5 * minute;
    return config;
  }

  EquipmentConfig equipment = with_confirmation();
  storage::Database database = open();
  storage::Archive archive{database};
  storage::Registry registry{database};
};

TEST_F(Probation, EndsWithAnApprovalOnceMoreTelemetryBearsTheVersionOut) {
  change_plant(2);
  EXPECT_TRUE(look(window_end + 3 * minute).empty()) << "less than three quarters";
  EXPECT_EQ(status(2), "waiting");
  const auto found = look(window_end + 4 * minute);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(status(2), "approved");
  EXPECT_EQ(registry.version("SAT", "PLANT", 2)->parent, 1);
  const auto evidence = nlohmann::json::parse(found[0].decision.evidence_json);
  EXPECT_EQ(evidence["until_ns"], window_end + 225 * second) << "three quarters";
  EXPECT_EQ(evidence["comparison"]["rows"], 180 + 225) << "the validation part and what came after";
  EXPECT_EQ(evidence["after_window"]["rows"], 225);
  EXPECT_TRUE(look(window_end + 5 * minute).empty());
}

TEST_F(Probation, IsLookedAtAtThreeQuartersAndAllOfTheConfirmation) {
  change_plant(2);
  const storage::Time three_quarters = window_end + 225 * second, all = window_end + 300 * second;
  EXPECT_TRUE(look(three_quarters - 1).empty());
  EXPECT_TRUE(look(all - 1, three_quarters).empty()) << "the look at three quarters was before";
  const auto found = look(all, three_quarters);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(nlohmann::json::parse(found[0].decision.evidence_json)["until_ns"], all);
}

TEST_F(Probation, EndsWithARejectionWhereTheChampionIsAsGood) {
  change_plant(1);
  EXPECT_TRUE(look(window_end + 4 * minute).empty());
  ASSERT_EQ(look(window_end + 5 * minute).size(), 1U);
  EXPECT_EQ(status(2), "rejected");
}

/// Adds a mode that no input moves, and takes as much from the output's offset: what a run begins
/// with makes up for that until the mode has fallen.
void make_up_by_a_slow_mode(EquipmentModel& model, double offset, double time_constant_s) {
  identification::StateSpaceModel& known = model.dynamics;
  identification::StateSpaceModel slow = known;
  const auto n = known.order();
  slow.A = identification::Matrix::Zero(n + 1, n + 1);
  slow.A.topLeftCorner(n, n) = known.A;
  slow.A(n, n) = std::exp(-known.period_s / time_constant_s);
  slow.B = identification::Matrix::Zero(n + 1, known.inputs());
  slow.B.topRows(n) = known.B;
  slow.C = identification::Matrix::Ones(1, n + 1);
  slow.C.leftCols(n) = known.C;
  slow.K = identification::Matrix::Zero(n + 1, 1);
  slow.y0.array() -= offset;
  known = slow;
  model.tracking.reset();
}

TEST_F(Probation, LetsNoFirstStateMakeUpForAnOffset) {
  constexpr double offset = 1;  // about twice the error of the champion
  const storage::Time end = day + 50 * minute;
  archive.append(telemetry(day + 10 * minute, 2701, 2));
  const auto with_mode_of = [&](double time_constant_s) {
    make_version_of(equipment, end, "on_probation", DecisionKind::wait,
                    [time_constant_s](EquipmentModel& model) {
                      make_up_by_a_slow_mode(model, offset, time_constant_s);
                    });
    const auto found = look(end + 5 * minute).at(0).decision;
    const auto evidence = nlohmann::json::parse(found.evidence_json);
    EXPECT_EQ(evidence["with_window"]["rows"], 600 + 300);
    return std::pair(found.kind, evidence["comparison"]["mrse_percent"].get<double>());
  };
  const auto [slow, slow_error] = with_mode_of(1200);
  EXPECT_EQ(slow, DecisionKind::reject);
  EXPECT_GT(slow_error, 0.8 * 10 * offset) << "of an output about 10";
  // What never falls makes up for it in a simulator's run too.
  const auto [steady, steady_error] = with_mode_of(1e9);
  EXPECT_EQ(steady, DecisionKind::approve);
  EXPECT_LT(steady_error, 1);
}

/// Another gain from `since` on, after fifty minutes of the old one with four of `before` in them.
class ProbationAfterLong : public Probation {
 protected:
  static constexpr storage::Time since = day + 60 * minute;

  void make_version_after(double before) {
    archive.append(telemetry(day + 10 * minute, 2280, 1));
    archive.compact();
    archive.append(telemetry(day + 48 * minute, 240, before));
    archive.append(telemetry(day + 52 * minute, 480, 1));
    archive.append(telemetry(since, 901, 2));
    make_version(since + 10 * minute, "on_probation", DecisionKind::wait);
  }
  storage::NewDecision decided() { return look(since + 15 * minute).at(0).decision; }
};

TEST_F(ProbationAfterLong, EndsWithAnApprovalWhereTheChampionHasNeverErredSo) {
  make_version_after(1);
  const auto found = decided();
  EXPECT_EQ(found.kind, DecisionKind::approve) << found.reason;
  const auto evidence = nlohmann::json::parse(found.evidence_json);
  EXPECT_LT(1.5 * evidence["champion_worst_mrse_percent"].get<double>(),
            evidence["comparison"]["rival_mrse_percent"].get<double>());
  EXPECT_FALSE(evidence.contains("over_tenure"));
}

TEST_F(ProbationAfterLong, EndsWithARejectionWhereTheChampionHasErredSoAndWasRight) {
  make_version_after(2);
  const auto found = decided();
  EXPECT_EQ(found.kind, DecisionKind::reject);
  EXPECT_EQ(code_in(found.evidence_json), name(Code::unconfirmed_as_in_tenure));
  const auto evidence = nlohmann::json::parse(found.evidence_json);
  EXPECT_EQ(evidence["over_tenure"]["rows"], 2400 + 180 + 300) << "four windows and what is new";
  EXPECT_THAT(not_on_the_page(evidence), testing::IsEmpty());
}

TEST_F(ProbationAfterLong, DoesNotAskForWhatTheChampionRanOnWhereThatIsDamaged) {
  make_version_after(2);
  damage_chunks(2);
  const auto found = decided();
  EXPECT_EQ(found.kind, DecisionKind::approve) << found.reason;
  EXPECT_FALSE(nlohmann::json::parse(found.evidence_json).contains("over_tenure"));
}

TEST_F(Probation, IsNotEndedWithAnApprovalByAnUnusualOperation) {
  archive.append(operation(day + 10 * minute, 901,
                           {.u = 0.3, .v = 0.3, .gain = 2, .since = window_end + second}));
  make_version(window_end, "on_probation", DecisionKind::wait);
  EXPECT_TRUE(look(window_end + 4 * minute).empty());
  EXPECT_EQ(code_in(look(window_end + 5 * minute).at(0).decision.evidence_json),
            name(Code::unconfirmed_unusual));
  EXPECT_EQ(status(2), "rejected");
}

TEST_F(Probation, GivesTheChampionNoTelemetryThatItDoesNotBelieve) {
  std::vector<storage::TelemetryFrame> frames = telemetry(day + 10 * minute, 901);
  frames[700].samples[1].value = 500;
  archive.append(frames);
  make_version(window_end, "on_probation", DecisionKind::wait);
  ASSERT_EQ(look(window_end + 5 * minute).size(), 1U);
  EXPECT_EQ(status(2), "rejected");
}

TEST_F(Probation, WaitsAsLongAgainForTelemetryThatDidNotCome) {
  archive.append(telemetry(day + 10 * minute, 601));
  make_version(window_end, "on_probation", DecisionKind::wait);
  EXPECT_TRUE(look(window_end + 5 * minute).empty());
  EXPECT_TRUE(look(window_end + 10 * minute - 1).empty());
  EXPECT_EQ(code_in(look(window_end + 10 * minute).at(0).decision.evidence_json),
            name(Code::unconfirmed_worse_after));
  EXPECT_EQ(status(2), "rejected");
}

TEST_F(Probation, IsDecidedByWhatComesLaterWhereTooLittleCame) {
  const auto frames = telemetry(day + 10 * minute, 1201, 2);
  archive.append({frames.begin(), frames.begin() + 602});
  archive.append({frames.begin() + 900, frames.end()});  // five minutes are lost
  EquipmentConfig brief = equipment;
  brief.sample_hold = second;  // nothing is held into the hole
  make_version_of(brief, window_end, "on_probation", DecisionKind::wait);
  const auto found = look(window_end + 10 * minute);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(status(2), "approved") << found[0].decision.reason;
  EXPECT_EQ(nlohmann::json::parse(found[0].decision.evidence_json)["until_ns"],
            window_end + 10 * minute);
}

TEST_F(Probation, LooksNoFurtherThanTheConfirmation) {
  change_plant(2);
  const auto found = look(window_end + 60 * minute);
  EXPECT_EQ(nlohmann::json::parse(found.at(0).decision.evidence_json)["until_ns"],
            window_end + 5 * minute);
}

TEST_F(Probation, OfANewerWindowEndsThatOfTheOlder) {
  change_plant(2);
  make_version(window_end + minute, "on_probation", DecisionKind::wait);
  make_version(window_end + 2 * minute, "on_probation", DecisionKind::wait);
  EXPECT_EQ(look(window_end + 6 * minute).size(), 3U);
  EXPECT_EQ(status(4), "approved");
  EXPECT_EQ(status(3), "rejected");
  EXPECT_EQ(status(2), "rejected");
  EXPECT_EQ(code_in(registry.decisions("SAT", "PLANT", 3).back().evidence_json),
            name(Code::unconfirmed_older));
}

TEST_F(Probation, RestsWhileAnOperatorHoldsTheEquipment) {
  change_plant(2);
  registry.put_on_hold("SAT", "PLANT", {"ana", "rehearsal", 1});
  EXPECT_TRUE(look(window_end + 5 * minute).empty());
  registry.release("SAT", "PLANT", {"ana", "over", 2});
  EXPECT_EQ(look(window_end + 5 * minute).size(), 1U);
}

TEST_F(Probation, IsLeftToTheOperatorWhoDecides) {
  change_plant(2);
  EquipmentConfig by_hand = equipment;
  by_hand.approval = ApprovalPolicy::by_hand;
  look_at_probation(archive, registry, "SAT", by_hand, INT64_MIN, window_end + 5 * minute,
                    [](const auto&, const auto&) { return ADD_FAILURE(), false; });
}

TEST_F(Probation, WaitsWhereAnOutputIsZeroAfterItsWindow) {
  archive.append(telemetry(day + 10 * minute, 600, 2));
  auto eclipse = telemetry(window_end, 601);
  for (auto& frame : eclipse) frame.samples[2].value = 0;
  archive.append(eclipse);
  make_version(window_end, "on_probation", DecisionKind::wait);
  equipment.screening = false;  // a sensor that is stuck is another matter
  EXPECT_TRUE(look(window_end + 5 * minute).empty());
  const auto found = look(window_end + 10 * minute).at(0).decision;
  EXPECT_EQ(found.kind, DecisionKind::reject);
  const auto evidence = nlohmann::json::parse(found.evidence_json);
  EXPECT_EQ(evidence["comparison"]["rows"], 180 + 600) << found.reason;
  EXPECT_EQ(evidence["after_window"]["rows"], 0);
}

TEST_F(Probation, KnowsAnUnusualOperationAlsoOnceItsHoldIsAnotherOne) {
  archive.append(operation(day + 10 * minute, 901,
                           {.u = 0.3, .v = 0.3, .gain = 2, .since = window_end + second}));
  EquipmentConfig longer = equipment;
  longer.sample_hold = 5 * second;
  make_version_of(longer, window_end, "on_probation", DecisionKind::wait);
  EXPECT_EQ(code_in(look(window_end + 5 * minute).at(0).decision.evidence_json),
            name(Code::unconfirmed_unusual));
}

TEST_F(Probation, IsOverOnceNoneWaitsAnyMore) {
  change_plant(2);
  EquipmentConfig none = equipment;
  none.confirmation = 0;
  std::vector<ProbationDecision> found;
  look_at_probation(archive, registry, "SAT", none, INT64_MIN, window_end + minute,
                    [&](const storage::DecisionState&, const ProbationDecision& decided) {
                      found.push_back(decided);
                      return true;
                    });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].decision.kind, DecisionKind::reject);
  EXPECT_EQ(code_in(found[0].decision.evidence_json), name(Code::unconfirmed_confirmation_off));
}

TEST_F(Probation, ApprovesNoModelThatIsNotTheOneOfItsDigest) {
  change_plant(2);
  run_sql("DROP TRIGGER version_update");
  run_sql("UPDATE version SET digest = 'another' WHERE number = 2");
  EXPECT_EQ(code_in(look(window_end + 5 * minute).at(0).decision.evidence_json),
            name(Code::unconfirmed_damaged));
  EXPECT_EQ(status(2), "rejected");
}

TEST_F(Probation, IsOverWhereTheChampionHasOtherOutputs) {
  change_plant(2);
  EquipmentConfig other = equipment;
  other.inputs = {"u"};
  other.outputs = {"v", "y"};
  make_version_of(other, window_end - 2 * minute, "approved", DecisionKind::approve);
  EXPECT_EQ(code_in(look(window_end + 5 * minute).at(0).decision.evidence_json),
            name(Code::unconfirmed_other_outputs));
}

TEST_F(Probation, IsOverWhereTheChampionWasWithdrawn) {
  change_plant(2);
  registry.decide("SAT", "PLANT", 1, {DecisionKind::withdraw, "ana", "bad"}, 1);
  EXPECT_EQ(code_in(look(window_end + minute).at(0).decision.evidence_json),
            name(Code::unconfirmed_champion_withdrawn));
  EXPECT_EQ(status(2), "rejected");
}

TEST_F(Probation, GoesOnWhereItsTelemetryIsDamaged) {
  change_plant(2);
  archive.compact();
  damage_chunks(2);
  EXPECT_TRUE(look(window_end + 5 * minute).empty());
  EXPECT_EQ(status(2), "waiting");
}

/// A service into which telemetry comes while no window is tried.
class Watch : public Probation {
 protected:
  Watch() { feed.described(descriptors(), archive); }

  Config watched_config() const {
    Config config = DaemonTest::config();
    config.spacecraft[0].equipment = {equipment};
    return config;
  }
  /// The versions that are decided when telemetry has settled until `time`.
  std::vector<std::int64_t> when_reached(storage::Time time) {
    feed.stored(telemetry(time + config_.settle, 1), {});
    decided.clear();
    watch.look(archive, registry, feed, context);
    return decided;
  }

  static constexpr storage::Time three_quarters = window_end + 225 * second;
  static constexpr storage::Time all = window_end + 300 * second;
  const Config config_ = watched_config();
  WindowFeed feed{config_, [] { return day; }};
  std::vector<std::int64_t> decided;
  const AttemptContext context{
      "digest",
      [this](const AttemptContext::Task& task) { task(registry, archive); },
      [] { return day; },
      {},
      [] { return false; },
      [this](const ProbationDecision& one) { decided.push_back(one.version.number); }};
  ConfirmationWatch watch{config_};
};

TEST_F(Watch, EndsAProbationAsTelemetryComes) {
  change_plant(2);
  EXPECT_TRUE(when_reached(three_quarters - 5 * second).empty());
  EXPECT_EQ(when_reached(three_quarters), std::vector<std::int64_t>{2});
  EXPECT_EQ(status(2), "approved");
}

TEST_F(Watch, LooksAtAVersionThatWasMadeAfterItsTelemetryCame) {
  EXPECT_TRUE(when_reached(all).empty());
  change_plant(2);
  EXPECT_EQ(when_reached(all + 5 * second), std::vector<std::int64_t>{2});
}

TEST_F(Watch, LooksWhereAnOperatorHasReleasedTheEquipment) {
  change_plant(2);
  registry.put_on_hold("SAT", "PLANT", {"ana", "rehearsal", 1});
  EXPECT_TRUE(when_reached(all).empty());
  registry.release("SAT", "PLANT", {"ana", "over", 2});
  EXPECT_EQ(when_reached(all + 5 * second), std::vector<std::int64_t>{2});
}

}  // namespace
}  // namespace reident::test::confirmation_test
