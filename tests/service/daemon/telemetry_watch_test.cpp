#include "service/daemon/telemetry_watch.hpp"

#include <gmock/gmock.h>

#include "service/support/time_text.hpp"
#include "tests/service/daemon_fixture.hpp"

namespace reident::test::telemetry_watch_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

struct Nobody : ArchiveListener {
  void stored(const std::vector<storage::TelemetryFrame>& frames,
              const storage::AppendReport&) override {
    heard += frames.size();
  }
  void described(const std::vector<storage::ParameterDescriptor>& descriptors,
                 const storage::Archive&) override {
    heard += descriptors.size();
  }
  std::size_t heard = 0;
};

class Watch : public DaemonTest {
 protected:
  void describe(const std::vector<storage::ParameterDescriptor>& descriptors) {
    archive.describe(descriptors);
    watch.described(descriptors, archive);
  }
  void store(const std::vector<storage::TelemetryFrame>& frames) {
    watch.stored(frames, archive.append(frames));
  }
  std::vector<std::string> codes() {
    std::vector<std::string> codes;
    for (const storage::Alarm& alarm : watch.alarms())
      codes.push_back(alarm.code + " " + alarm.about.spacecraft + "/" + alarm.about.equipment);
    return codes;
  }

  Config config_ = config();
  storage::Time now = day + 1000 * minute;
  storage::Database database = open();
  storage::Archive archive{database};
  Nobody next;
  storage::Time set_by = 0;  // the clock of the machine, and not the uptime
  TelemetryWatch watch{config_, [this] { return now + set_by; }, [this] { return now; }, next};
};

TEST_F(Watch, PassesOnWhatItHears) {
  describe(descriptors());
  store(telemetry(day, 5));
  EXPECT_EQ(next.heard, 8U);
}

TEST_F(Watch, TelemetryThatStaysAwayForASlideIsAnAlarmUntilItComesAgain) {
  describe(descriptors());
  EXPECT_THAT(codes(), IsEmpty());
  now += 5 * minute + second;
  EXPECT_THAT(codes(), ElementsAre("no_telemetry SAT/PLANT"));
  const std::string text = watch.alarms()[0].text;
  now += minute;
  EXPECT_EQ(watch.alarms()[0].text, text) << "the same until something changes";
  store(telemetry(day, 5));
  EXPECT_THAT(codes(), IsEmpty());
  now += 5 * minute + second;
  store(telemetry(day, 5));
  EXPECT_THAT(codes(), SizeIs(1)) << "what is archived already is no telemetry";
}

TEST_F(Watch, ANameThatNoTelemetryHasIsAnAlarmOnceAllWereDescribed) {
  config_.spacecraft[0].equipment[0].inputs = {"u", "vv", "temperature"};
  TelemetryWatch misspelt(
      config_, [this] { return now; }, [this] { return now; }, next);
  archive.describe(descriptors());
  misspelt.described(descriptors(), archive);
  EXPECT_THAT(misspelt.alarms(), IsEmpty());
  now += 10 * second;
  const auto alarms = misspelt.alarms();
  ASSERT_THAT(alarms, SizeIs(1));
  EXPECT_EQ(alarms[0].code, "unknown_names");
  EXPECT_EQ(alarms[0].about, (storage::EquipmentName{"SAT", "PLANT"}));
  EXPECT_THAT(alarms[0].text, AllOf(HasSubstr("vv (did you mean v?)"), HasSubstr("temperature.")));
}

TEST_F(Watch, ASpacecraftThatIsNotConfiguredIsAnAlarm) {
  auto others = descriptors();
  for (auto& one : others) one.spacecraft = "SAT1";
  describe(others);
  now += 10 * second;
  const auto alarms = watch.alarms();
  ASSERT_THAT(alarms, SizeIs(1));
  EXPECT_EQ(alarms[0].about.spacecraft, "SAT1");
  EXPECT_THAT(alarms[0].text, HasSubstr("(did you mean SAT?)"));
}

TEST_F(Watch, AFloodOfSpacecraftThatAreNotConfiguredIsAFewAlarms) {
  auto others = descriptors();
  for (int i = 0; i < 1000; ++i) {
    for (auto& one : others) one.spacecraft = "STRANGE-" + std::to_string(i);
    watch.described(others, archive);
  }
  now += 10 * second;
  const auto found = codes();
  EXPECT_THAT(found, SizeIs(11));
  EXPECT_THAT(found, ::testing::Contains("unknown_names /"));
}

TEST_F(Watch, TelemetryAheadOfTheClockIsAnAlarmUntilItIsNot) {
  describe(descriptors());
  store(telemetry(now + 180 * minute, 2));
  const auto alarms = watch.alarms();
  ASSERT_THAT(alarms, SizeIs(1));
  EXPECT_EQ(alarms[0].code, "clock");
  EXPECT_THAT(alarms[0].text, HasSubstr(" 3h, more than max_clock_lead (1h)"));
  store(telemetry(now - minute, 2));
  EXPECT_THAT(codes(), IsEmpty());
}

TEST_F(Watch, AClockBeforeTheLastEntryIsAnAlarmUntilItIsCorrected) {
  watch.recover(archive, now + 90 * minute);
  const auto alarms = watch.alarms();
  ASSERT_THAT(alarms, SizeIs(1));
  EXPECT_EQ(alarms[0].code + alarms[0].about.spacecraft, "clock");
  EXPECT_THAT(alarms[0].text, HasSubstr("at " + time_text(now + 90 * minute)));
  now += 89 * minute;
  store(telemetry(day, 5));
  EXPECT_THAT(codes(), ::testing::Not(::testing::Contains("clock /")));
}

TEST_F(Watch, AClockThatIsSetWhileItRunsNeitherRaisesNorHidesThatTelemetryStaysAway) {
  describe(descriptors());
  store(telemetry(day, 5));
  set_by = 1000 * minute;
  EXPECT_THAT(codes(), IsEmpty());
  set_by = -1000 * minute;
  now += 5 * minute + second;
  EXPECT_THAT(codes(), ElementsAre("no_telemetry SAT/PLANT"));
}

TEST_F(Watch, AClockThatIsSetBeforeAWindowOfThisRunIsAnAlarm) {
  watch.tried(now);
  EXPECT_THAT(codes(), IsEmpty());
  set_by = -2 * minute;
  EXPECT_THAT(codes(), ElementsAre("clock /"));
}

TEST_F(Watch, KnowsWhatEarlierRunsWereTold) {
  archive.describe(descriptors());
  Config misspelt = config();
  misspelt.spacecraft[0].equipment[0].outputs = {"z"};
  TelemetryWatch again(
      misspelt, [this] { return now; }, [this] { return now; }, next);
  again.recover(archive, 0);
  now += 10 * second;
  EXPECT_THAT(again.alarms(), SizeIs(1));
}

}  // namespace
}  // namespace reident::test::telemetry_watch_test
