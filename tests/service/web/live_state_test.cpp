#include "service/web/live_state.hpp"

#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "storage/registry/registry.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::web {
namespace {

using namespace std::chrono_literals;

dds::Endpoint endpoint() {
  return {static_cast<std::uint32_t>(31 + ::getpid() % 170),
          "live-" + std::to_string(::getpid()) +
              testing::UnitTest::GetInstance()->current_test_info()->name()};
}

class LiveStateTest : public testing::Test {
 protected:
  LiveStateTest() : thread_([this] { live.run([this] { ++changes; }); }) {}
  ~LiveStateTest() override {
    live.stop();
    thread_.join();
  }

  template <typename Condition>
  static bool comes(const Condition& condition) {
    const auto deadline = std::chrono::steady_clock::now() + 20s;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(5ms);  // poll
    }
    return true;
  }

  void beat(std::uint64_t frames) {
    ServiceStatus status;
    status.service = "reident";
    status.program_version = "1";
    status.frames_received = frames;
    statuses.write(status);
  }

  reident::test::TemporaryFolder folder;
  dds::Participant participant{endpoint()};
  dds::Writer<ServiceStatus> statuses{participant};
  std::atomic<int> changes = 0;
  LiveState live{endpoint(), folder / "reident.db"};

 private:
  std::thread thread_;
};

TEST_F(LiveStateTest, GivesWhoDidNotReadTheNewestStateAndNoBacklog) {
  ASSERT_TRUE(comes([this] { return live.since(0).revision > 0 && changes > 0; }));
  const std::uint64_t before = live.since(0).revision;
  ASSERT_TRUE(comes([this] { return statuses.matched_readers() > 0; }));
  for (std::uint64_t frames = 1; frames <= 50; ++frames) {
    beat(frames);
    ASSERT_TRUE(comes([&] {
      const auto services = live.services();
      return services.contains("reident") &&
             services.at("reident").status.frames_received == frames;
    }));
  }
  const EventSource::Events events = live.since(before);
  EXPECT_EQ(events.text.find("\"frames_received\":50"), events.text.rfind("\"frames_received\":"));
  EXPECT_GE(events.coalesced, 40U);
  EXPECT_EQ(live.since(events.revision).text, "");
  EXPECT_NE(events.text.find("id: " + std::to_string(events.revision)), std::string::npos);
}

TEST_F(LiveStateTest, SaysOfAHeartbeatHowOldItIsNow) {
  ASSERT_TRUE(comes([this] { return statuses.matched_readers() > 0; }));
  beat(1);
  ASSERT_TRUE(comes([this] { return live.services().contains("reident"); }));
  const auto age = [](const std::string& text) {
    constexpr std::string_view key = "\"age_s\":";
    const std::size_t place = text.find(key);
    return place == std::string::npos ? -1 : std::stod(text.substr(place + key.size()));
  };
  EXPECT_TRUE(comes([&] { return age(live.since(0).text) >= 0.2; }));
  EXPECT_TRUE(comes([&] { return age(live.changes_since(0).dump()) >= 0.3; }));
}

TEST_F(LiveStateTest, ShowsADecisionAndWhatIsWrongWithTheDatabase) {
  ASSERT_TRUE(comes([this] { return !live.database_error().empty(); }));
  {
    storage::Database database(folder / "reident.db", storage::Database::Mode::read_write);
    storage::Registry registry(database);
    storage::NewAttempt attempt;
    attempt.spacecraft = "SAT";
    attempt.equipment = "PLANT";
    attempt.window = {0, 10};
    attempt.outcome = "challenger";
    const std::uint64_t before = live.since(0).revision;
    registry.record(attempt, {"{}", "digest"}, {storage::DecisionKind::wait, "gate", "why"});
    ASSERT_TRUE(comes([&] {
      return live.since(before).text.find("\"equipment\":\"PLANT\",\"decision\":\"1\"") !=
             std::string::npos;
    }));
    EXPECT_EQ(live.database_error(), "");
    const Json changed = live.changes_since(before);
    EXPECT_TRUE(changed["revision"].is_string());
    EXPECT_FALSE(changed["changes"].empty());
  }
}

// Otherwise a viewer whose last revision came from a clock that was ahead would get nothing more.
TEST_F(LiveStateTest, ARevisionThatNobodyGaveYetGetsEverything) {
  ASSERT_TRUE(comes([this] { return live.since(0).revision > 0 && changes > 0; }));
  EXPECT_NE(live.since(UINT64_MAX).text, "");
}

}  // namespace
}  // namespace reident::web
