#include "service/daemon/window_feed.hpp"

#include <limits>

#include "tests/service/daemon_fixture.hpp"

namespace reident::test::window_feed_test {
namespace {

class Feed : public DaemonTest {
 protected:
  std::unique_ptr<WindowFeed> make_feed() {
    return std::make_unique<WindowFeed>(
        config_, [this] { return now + set_by; }, [this] { return now; });
  }
  /// Stores the frames and notifies the feed, as the archive's writer does.
  void store(WindowFeed& feed, const std::vector<storage::TelemetryFrame>& frames) {
    feed.stored(frames, archive.append(frames));
  }
  /// Ends of the windows that are due now, all of them tried and recorded.
  std::vector<storage::Time> try_all(WindowFeed& feed) {
    now += 2 * second;
    std::vector<storage::Time> ends;
    while (feed.pending() > 0) {
      const auto job = feed.next();
      archive.seal(*job->spacecraft, job->window.window.end);
      storage::NewAttempt attempt;
      attempt.spacecraft = *job->spacecraft;
      attempt.equipment = job->equipment->name;
      attempt.window = job->window.window;
      attempt.evidence_json = "{}";
      registry.record(attempt);
      feed.finished(*job, true);
      feed.forget_settled(*job->spacecraft, archive);
      ends.push_back(job->window.window.end);
    }
    return ends;
  }

  const Config config_ = config();
  storage::Time now = day + 1000 * minute;
  storage::Time set_by = 0;  // the clock of the machine, and not the uptime
  storage::Database database = open();
  storage::Archive archive{database};
  storage::Registry registry{database};
};

TEST_F(Feed, GivesTheWindowsOfStoredTelemetry) {
  auto feed = make_feed();
  archive.describe(descriptors());
  feed->described(descriptors(), archive);
  store(*feed, telemetry(day, 901));
  EXPECT_EQ(try_all(*feed), (std::vector{day + 5 * minute, day + 10 * minute, day + 15 * minute}));
  EXPECT_EQ(feed->newest_telemetry(), day + 15 * minute);
}

TEST_F(Feed, GivesTheWindowsOfTheParametersOfADerivedInput) {
  Config derived = config();
  derived.spacecraft[0].equipment[0].inputs = {"w"};
  derived.spacecraft[0].equipment[0].derived = {{"w", "u + v", "V"}};
  WindowFeed feed(
      derived, [this] { return now; }, [this] { return now; });
  archive.describe(descriptors());
  feed.described(descriptors(), archive);
  auto frames = telemetry(day, 601);
  for (auto& frame : frames) frame.samples.resize(2);  // the parameters of the expression alone
  store(feed, frames);
  EXPECT_EQ(try_all(feed), (std::vector{day + 5 * minute, day + 10 * minute}));
}

TEST_F(Feed, GivesThemInTimeAlsoWhereTheClockOfTheMachineIsSetBack) {
  auto feed = make_feed();
  archive.describe(descriptors());
  feed->described(descriptors(), archive);
  store(*feed, telemetry(day, 901));
  set_by = -1440 * minute;
  EXPECT_EQ(try_all(*feed).size(), 3U);
}

TEST_F(Feed, GivesThemTooWhenTheDescriptorsComeAfterTheFrames) {
  auto feed = make_feed();
  store(*feed, telemetry(day, 901));
  EXPECT_EQ(feed->pending(), 0U);
  archive.describe(descriptors());
  feed->described(descriptors(), archive);
  EXPECT_EQ(try_all(*feed).size(), 3U);
}

TEST_F(Feed, StartsNothingForFramesThatCameBefore) {
  auto feed = make_feed();
  archive.describe(descriptors());
  feed->described(descriptors(), archive);
  store(*feed, telemetry(day, 901));
  try_all(*feed);
  store(*feed, telemetry(day, 901));
  EXPECT_EQ(feed->pending(), 0U);
}

TEST_F(Feed, StartsNothingForOtherSpacecraftParametersAndSimulatedTelemetry) {
  auto feed = make_feed();
  archive.describe(descriptors());
  feed->described(descriptors(), archive);
  auto other = telemetry(day, 901);
  for (auto& frame : other) frame.spacecraft = "OTHER";
  store(*feed, other);
  auto simulated = telemetry(day, 901);
  for (auto& frame : simulated) frame.origin = storage::Origin::simulated;
  store(*feed, simulated);
  auto foreign = telemetry(day, 901);
  for (auto& frame : foreign) frame.samples = {{99, storage::Quality::good, 1.0}};
  store(*feed, foreign);
  EXPECT_EQ(feed->pending(), 0U);
}

TEST_F(Feed, LooksAgainWhereLateTelemetryLandsAlsoAfterARestart) {
  auto feed = make_feed();
  archive.describe(descriptors());
  feed->described(descriptors(), archive);
  auto frames = telemetry(day, 1801);
  const std::vector<storage::TelemetryFrame> late(frames.begin() + 400, frames.begin() + 420);
  frames.erase(frames.begin() + 400, frames.begin() + 420);
  store(*feed, frames);
  EXPECT_EQ(try_all(*feed).size(), 6U);
  archive.append(late);  // and the service dies before it looks

  feed = make_feed();
  feed->recover(archive, registry);
  EXPECT_EQ(try_all(*feed), (std::vector{day + 10 * minute, day + 15 * minute}));
  EXPECT_TRUE(archive.late_ranges("SAT").empty()) << "the marks are settled";

  feed = make_feed();
  feed->recover(archive, registry);
  EXPECT_EQ(feed->pending(), 0U);
}

TEST_F(Feed, TakesUpWindowsThatAnEarlierRunDidNotTry) {
  archive.describe(descriptors());
  archive.append(telemetry(day, 901));
  {
    auto feed = make_feed();
    feed->recover(archive, registry);
    EXPECT_EQ(try_all(*feed).size(), 3U);
  }
  archive.append(telemetry(day + 901 * second, 600));
  auto feed = make_feed();
  feed->recover(archive, registry);
  EXPECT_EQ(try_all(*feed), (std::vector{day + 20 * minute, day + 25 * minute}));
}

TEST_F(Feed, StartsInSpiteOfDamagedTelemetryAndTriesTheNewestWindow) {
  archive.describe(descriptors());
  archive.append(telemetry(day, 901));
  archive.compact();
  for (const std::uint32_t parameter : {1U, 2U, 3U}) damage_chunks(parameter);
  auto feed = make_feed();
  feed->recover(archive, registry);
  feed->described(descriptors(), archive);
  store(*feed, telemetry(day + 901 * second, 300));
  EXPECT_EQ(try_all(*feed), (std::vector{day + 20 * minute}));
}

TEST_F(Feed, FollowsNoClockThatRanAwayNowOrAfterARestart) {
  auto feed = make_feed();
  archive.describe(descriptors());
  feed->described(descriptors(), archive);
  auto frames = telemetry(day, 301);
  auto ahead = frames.back();
  ahead.generation_time = now + 2 * config_.max_clock_lead;
  frames.push_back(ahead);
  ahead.generation_time = std::numeric_limits<storage::Time>::max();
  frames.push_back(ahead);
  ahead.generation_time = std::numeric_limits<storage::Time>::min();
  frames.push_back(ahead);
  store(*feed, frames);
  EXPECT_EQ(feed->clock_jumps(), 2U);
  EXPECT_EQ(feed->pending(), 1U);

  feed = make_feed();
  feed->recover(archive, registry);
  EXPECT_EQ(try_all(*feed), (std::vector{day + 5 * minute}));
}

TEST_F(Feed, GivesWithoutWaitingWhatIsDueByTheClockAndNothingElse) {
  auto feed = make_feed();
  archive.describe(descriptors());
  feed->described(descriptors(), archive);
  EXPECT_FALSE(feed->next_due()) << "no telemetry has come";
  store(*feed, telemetry(day, 601));
  now += config_.settle - 1;
  EXPECT_FALSE(feed->next_due()) << "stragglers are waited for";
  now += 1;
  const auto first = feed->next_due();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->window.window.end, day + 5 * minute);
  EXPECT_FALSE(feed->next_due()) << "one window of an equipment at a time";
  EXPECT_EQ(feed->pending(), 2U);
  feed->finished(*first, true);
  const auto second_one = feed->next_due();
  ASSERT_TRUE(second_one);
  EXPECT_EQ(second_one->window.window.end, day + 10 * minute);
  feed->finished(*second_one, false);
  EXPECT_FALSE(feed->next_due()) << "it settles anew";
  now += config_.settle;
  const auto again = feed->next_due();
  ASSERT_TRUE(again) << "what was not completed is tried once more";
  EXPECT_EQ(again->window, second_one->window);
  feed->finished(*again, true);
  EXPECT_FALSE(feed->next_due());
  EXPECT_EQ(feed->pending(), 0U);
}

TEST_F(Feed, SaysOnceWhereTelemetryOfAWindowHasChanged) {
  auto feed = make_feed();
  archive.describe(descriptors());
  feed->described(descriptors(), archive);
  auto frames = telemetry(day, 601);
  const std::vector<storage::TelemetryFrame> late(frames.begin() + 400, frames.begin() + 410);
  frames.erase(frames.begin() + 400, frames.begin() + 410);
  store(*feed, frames);
  now += config_.settle;
  const auto first = feed->next_due();
  ASSERT_TRUE(first);
  ASSERT_EQ(first->changed.size(), 1U);
  EXPECT_LE(first->changed[0].begin, day);
  EXPECT_GE(first->changed[0].end, day + 10 * minute);
  feed->finished(*first, true);
  const auto next = feed->next_due();
  ASSERT_TRUE(next);
  EXPECT_TRUE(next->changed.empty());
  feed->finished(*next, true);

  store(*feed, late);
  now += config_.settle;
  const auto again = feed->next_due();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->window.cause, "late telemetry");
  ASSERT_EQ(again->changed.size(), 1U);
  EXPECT_EQ(again->changed[0].begin, late.front().generation_time);
  EXPECT_GT(again->changed[0].end, late.back().generation_time);
}

TEST_F(Feed, EndsTheWaitWhenItIsStopped) {
  auto feed = make_feed();
  feed->stop();
  EXPECT_FALSE(feed->next());
}

}  // namespace
}  // namespace reident::test::window_feed_test
