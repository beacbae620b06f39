#include "service/judgement/champion_monitor.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "service/operations/refresh.hpp"
#include "tests/service/daemon_fixture.hpp"

namespace reident::test::champion_monitor_test {
namespace {

class Monitor : public DaemonTest {
 protected:
  Monitor() {
    archive.describe(descriptors());
    archive.append(telemetry(day, 1201));
    approve(day + 20 * minute);
  }

  static EquipmentConfig equipment() {
    EquipmentConfig equipment = plant();
    equipment.window = 20 * minute;
    return equipment;
  }
  void approve(storage::Time end) {
    WindowCache kept = window_cache_of("SAT", equipment());
    const RefreshResult result = refresh(
        archive, registry, {"SAT", equipment(), {end - equipment().window, end}, "slide", "digest"},
        kept, {}, [] { return false; });
    ASSERT_TRUE(result.candidate) << result.attempt.reason;
    registry.record(result.attempt, result.version,
                    {storage::DecisionKind::approve, "gate", "good"});
  }
  std::optional<ChampionMonitor::Drift> look(storage::Time reached) {
    return monitor.look(archive, registry, reached, 60 * minute);
  }

  storage::Database database = open();
  storage::Archive archive{database};
  storage::Registry registry{database};
  ChampionMonitor monitor{"SAT", equipment()};
};

TEST_F(Monitor, IsSilentWhileThePlantIsAsItWas) {
  archive.append(telemetry(day + 20 * minute + second, 7200));
  for (int minutes = 20; minutes <= 140; minutes += 5)
    EXPECT_FALSE(look(day + minutes * minute)) << minutes;
}

TEST_F(Monitor, FindsThatThePlantHasChangedBeforeAWindowHasSlid) {
  archive.append(telemetry(day + 20 * minute + second, 600, 1.5));
  std::optional<ChampionMonitor::Drift> drift;
  storage::Time reached = day + 20 * minute;
  while (!drift && reached < day + 30 * minute) drift = look(reached += second);
  ASSERT_TRUE(drift);
  EXPECT_EQ(drift->version, 1);
  EXPECT_LT(drift->end, day + 25 * minute);
  EXPECT_GE(drift->since, day + 20 * minute);
  EXPECT_LT(drift->since, day + 21 * minute);
  EXPECT_GT(drift->error_ratio, 2);
}

TEST_F(Monitor, KeepsTheBeginOfADriftThatLastsAsLongAsTheChampion) {
  archive.append(telemetry(day + 20 * minute + second, 1800));
  archive.append(telemetry(day + 50 * minute + second, 1800, 1.5));
  std::vector<ChampionMonitor::Drift> drifts;
  for (storage::Time reached = day + 20 * minute; reached < day + 80 * minute;
       reached += 10 * second)
    if (const auto drift = look(reached)) drifts.push_back(*drift);
  ASSERT_GT(drifts.size(), 2U);
  for (const ChampionMonitor::Drift& drift : drifts)
    EXPECT_TRUE(drift.since >= day + 50 * minute && drift.since < day + 51 * minute)
        << (drift.since - day) / second;
}

TEST(WindowOfADrift, BeginsWithTheDriftOnceHalfAWindowLiesBehindIt) {
  EquipmentConfig equipment;
  equipment.window = 100;
  equipment.sample_period = 4;
  equipment.max_order = 2;
  const auto window = [&equipment](storage::Time since, storage::Time end) {
    return ChampionMonitor::window_of({.since = since, .end = end}, equipment);
  };
  EXPECT_EQ(window(1000, 1010), (storage::TimeRange{1000, 1048}));
  EXPECT_EQ(window(1000, 1048), (storage::TimeRange{1000, 1048}));
  EXPECT_EQ(window(1000, 1080), (storage::TimeRange{1000, 1080}));
  EXPECT_EQ(window(1000, 1180), (storage::TimeRange{1080, 1180}));
  equipment.max_order = 4;
  EXPECT_EQ(window(1000, 1010), (storage::TimeRange{1000, 1080})) << "as many as it needs";
  equipment.max_order = 6;
  EXPECT_EQ(window(1000, 1010), (storage::TimeRange{1000, 1100})) << "no longer than configured";
}

TEST_F(Monitor, BeginsAgainWhereTheArchiveCouldNotBeRead) {
  archive.append(telemetry(day + 20 * minute + second, 1800, 1.5));
  run_sql("ALTER TABLE chunk RENAME TO gone");
  EXPECT_THROW(look(day + 30 * minute), storage::Error);
  run_sql("ALTER TABLE gone RENAME TO chunk");
  EXPECT_TRUE(look(day + 50 * minute));
}

TEST_F(Monitor, DoesNotTakeOneBadRangeForAChange) {
  auto frames = telemetry(day + 20 * minute + second, 1800);
  for (std::size_t k = 300; k < 310; ++k) frames[k].samples[2].value = 1000;
  archive.append(frames);
  EXPECT_FALSE(look(day + 50 * minute));
}

TEST_F(Monitor, PassesOverBlocksWithoutTelemetry) {
  archive.append(telemetry(day + 40 * minute, 900));
  EXPECT_FALSE(look(day + 55 * minute));
}

TEST_F(Monitor, WatchesTheNextChampionAfterwards) {
  archive.append(telemetry(day + 20 * minute + second, 1800, 1.5));
  EXPECT_TRUE(look(day + 30 * minute));
  approve(day + 50 * minute);
  archive.append(telemetry(day + 50 * minute + 2 * second, 1800, 1.5));
  EXPECT_FALSE(look(day + 80 * minute));
}

TEST_F(Monitor, HasNothingToSayWithoutAChampion) {
  EquipmentConfig unknown = equipment();
  unknown.name = "OTHER";
  ChampionMonitor other("SAT", unknown);
  EXPECT_FALSE(other.look(archive, registry, day + 20 * minute, 60 * minute));
}

TEST_F(Monitor, ThatBeginsLateLooksAtTheRecentPastAlone) {
  archive.append(telemetry(day + 20 * minute + second, 600, 1.5));
  archive.append(telemetry(day + 30 * minute + 2 * second, 7200));
  ChampionMonitor later("SAT", equipment());
  EXPECT_FALSE(later.look(archive, registry, day + 150 * minute, 60 * minute));
  EXPECT_TRUE(look(day + 79 * minute)) << "one that began in time";
}

TEST_F(Monitor, ThatBeginsLateKnowsOfNoDriftBeforeWhatItLooksAt) {
  archive.append(telemetry(day + 20 * minute + second, 7800, 1.5));
  ChampionMonitor later("SAT", equipment());
  const auto drift = later.look(archive, registry, day + 150 * minute, 60 * minute);
  ASSERT_TRUE(drift);
  EXPECT_GT(drift->since, day + 89 * minute);
}

}  // namespace
}  // namespace reident::test::champion_monitor_test
