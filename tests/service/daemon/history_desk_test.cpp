// Questions over DDS: heard, answered in pages, by a desk that no console holds up.
#include "service/daemon/history_desk.hpp"

#include <filesystem>
#include <thread>

#include <gmock/gmock.h>

#include "service/history/remote_history.hpp"
#include "service/history/remote_readers.hpp"
#include "service/history/stored_readers.hpp"
#include "storage/registry/registry.hpp"
#include "tests/service/dds/dds_fixture.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::test::history_desk_test {
namespace {

using history::RemoteHistory;
using ::testing::HasSubstr;

/// A desk whose thread runs on a database, and a console.
class HistoryDesk : public testing::Test {
 protected:
  const TemporaryFolder folder_;
  storage::Database database_{folder_ / "reident.db", storage::Database::Mode::read_write};
  storage::Registry registry_{database_};
  dds::Participant service_{own_endpoint()};
  dds::Participant console_{own_endpoint()};
  reident::HistoryDesk desk_{service_, "first"};
  std::thread thread_;

  void run() {
    thread_ = std::thread([this] {
      storage::Database database(folder_ / "reident.db", storage::Database::Mode::read_only);
      desk_.run([&](const HistoryQuery& query) { return history::answer(database, query); });
    });
  }
  ~HistoryDesk() override {
    desk_.stop();
    if (thread_.joinable()) thread_.join();
  }

  void add_attempts(int count, const std::string& evidence = "{}") {
    for (int i = 0; i < count; ++i) {
      storage::NewAttempt attempt;
      attempt.spacecraft = "SAT";
      attempt.equipment = "PLANT";
      attempt.window = {i, i + 10};
      attempt.evidence_json = evidence;
      registry_.record(attempt);
    }
  }
  static HistoryQuery about(const std::string& subject) {
    HistoryQuery query;
    query.subject = subject;
    return query;
  }
  static std::string failure(const std::variant<HistoryPage, RemoteHistory::Failure>& answer) {
    const auto* failed = std::get_if<RemoteHistory::Failure>(&answer);
    return failed ? failed->message : "answered";
  }
};

TEST_F(HistoryDesk, GivesEveryRowThroughAsManyPagesAsItTakes) {
  add_attempts(100, "{\"why\":\"" + std::string(10'000, 'x') + "\"}");
  run();
  RemoteHistory remote(console_, "first");
  const history::RemoteHistoryReader reader(history::RemoteRows(remote, 10s));
  const auto attempts = reader.attempts({});
  const auto stored = history::StoredHistory(database_).attempts({});
  ASSERT_EQ(attempts.size(), stored.size());
  for (std::size_t i = 0; i < stored.size(); ++i) {
    EXPECT_EQ(attempts[i].id, stored[i].id);
    EXPECT_EQ(attempts[i].evidence_json, stored[i].evidence_json);
  }
  storage::HistoryFilter newest;
  newest.last = 3;
  const auto last = reader.attempts(newest);
  ASSERT_EQ(last.size(), 3U);
  EXPECT_EQ(last.front().id, 98);
  EXPECT_EQ(last.back().id, 100);
}

TEST_F(HistoryDesk, SaysWhatIsWrongWithAQuestionAndHearsTheNext) {
  add_attempts(1);
  run();
  RemoteHistory remote(console_);
  EXPECT_THAT(failure(remote.page(about("weather"), 10s)), HasSubstr("there is no subject"));
  HistoryQuery damaged = about("attempts");
  damaged.spacecraft = "\xff";
  EXPECT_THAT(failure(remote.page(damaged, 10s)), HasSubstr("spacecraft is not UTF-8"));
  damaged = about("attempts");
  damaged.cursor = "damaged";
  EXPECT_THAT(failure(remote.page(damaged, 10s)), HasSubstr("begin again"));
  EXPECT_EQ(failure(remote.page(about("attempts"), 10s)), "answered");
}

TEST_F(HistoryDesk, LeavesQuestionsToAnotherServiceAlone) {
  add_attempts(1);
  run();
  RemoteHistory other(console_, "second");
  EXPECT_EQ(failure(other.page(about("attempts"), 300ms)),
            "no service second answered within 0.3 s");
}

TEST_F(HistoryDesk, WithoutAServiceTheConsoleIsToldInTime) {
  std::vector<bool> waits;
  RemoteHistory remote(console_, "", [&waits](bool is_waiting) { waits.push_back(is_waiting); });
  EXPECT_THAT(failure(remote.page(about("attempts"), 200ms)), HasSubstr("within 0.2 s"));
  ASSERT_GT(waits.size(), 1U);
  EXPECT_TRUE(waits.front());
  EXPECT_FALSE(waits.back());
}

}  // namespace
}  // namespace reident::test::history_desk_test
