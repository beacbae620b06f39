// Which version belongs to telemetry of a time.
#include "service/history/telemetry_champion.hpp"

#include <gtest/gtest.h>

#include "service/history/stored_readers.hpp"
#include "storage/registry/registry.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::history::telemetry_champion_test {
namespace {

using storage::DecisionKind;
using storage::Time;

class TelemetryChampion : public testing::Test {
 protected:
  const reident::test::TemporaryFolder folder_;
  storage::Database database_{folder_ / "reident.db", storage::Database::Mode::read_write};
  storage::Registry registry_{database_};
  const storage::EquipmentName bdr_{"SAT", "BDR"};
  static constexpr Time decided = 1'000'000;  // all of it years after the telemetry

  void version(Time window_end) {
    storage::NewAttempt attempt;
    attempt.spacecraft = "SAT";
    attempt.equipment = "BDR";
    attempt.window = {window_end - 10, window_end};
    attempt.time = decided;
    attempt.outcome = "challenger";
    registry_.record(attempt, {"{}", "d"}, {DecisionKind::wait, "gate", "challenger"});
  }
  void decide(std::int64_t version, DecisionKind kind, std::optional<Time> until) {
    registry_.decide("SAT", "BDR", version,
                     {kind, until ? "gate" : "Ana", "so",
                      until ? "{\"until_ns\":" + std::to_string(*until) + "}" : ""},
                     decided);
  }
  std::int64_t at(Time time) {
    const auto reign = champion_for_telemetry(StoredHistory(database_), bdr_, time);
    return reign ? reign->decision.version : 0;
  }
};

TEST_F(TelemetryChampion, FollowsTheTelemetryThatWasJudgedAndNotTheClock) {
  for (const Time end : {100, 200, 300}) version(end);
  decide(1, DecisionKind::approve, 150);
  decide(2, DecisionKind::approve, 250);
  EXPECT_EQ(at(149), 0);
  EXPECT_EQ(at(150), 1);
  EXPECT_EQ(at(249), 1);
  EXPECT_EQ(at(250), 2);
  EXPECT_EQ(at(decided + 1), 2);
  EXPECT_EQ(first_champion(StoredHistory(database_), bdr_)->from, 150);
}

TEST_F(TelemetryChampion, BeginsNotBeforeTheEndOfItsWindow) {
  version(100);
  decide(1, DecisionKind::approve, 95);  // on blocks of the window
  EXPECT_EQ(at(99), 0);
  EXPECT_EQ(at(100), 1);
  EXPECT_EQ(tenures(StoredHistory(database_), bdr_).front().from, 100);
}

TEST_F(TelemetryChampion, AnOperatorsDecisionCountsFromWhereTheGateHadComeTo) {
  for (const Time end : {100, 200}) version(end);
  decide(1, DecisionKind::approve, 150);
  decide(2, DecisionKind::wait, 280);
  decide(2, DecisionKind::approve, std::nullopt);
  EXPECT_EQ(at(279), 1);
  EXPECT_EQ(at(280), 2);
  decide(2, DecisionKind::withdraw, std::nullopt);  // which rolls back to 1
  EXPECT_EQ(at(280), 1);
}

TEST_F(TelemetryChampion, IsAbsentWhereThereNeverWasOne) {
  version(100);
  EXPECT_EQ(at(1'000), 0);
  EXPECT_FALSE(first_champion(StoredHistory(database_), bdr_));
}

}  // namespace
}  // namespace reident::history::telemetry_champion_test
