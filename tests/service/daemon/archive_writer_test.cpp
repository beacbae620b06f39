#include "service/daemon/archive_writer.hpp"

#include <csignal>
#include <optional>
#include <thread>

#include <sys/resource.h>

#include "tests/service/daemon_fixture.hpp"

namespace reident::test::archive_writer_test {
namespace {

using namespace std::chrono_literals;

struct Listener : ArchiveListener {
  void stored(const std::vector<storage::TelemetryFrame>& frames,
              const storage::AppendReport&) override {
    committed += frames.size();
  }
  void described(const std::vector<storage::ParameterDescriptor>& descriptors,
                 const storage::Archive&) override {
    known += descriptors.size();
  }
  std::atomic<std::size_t> committed = 0;
  std::atomic<std::size_t> known = 0;
};

template <class Condition>
bool eventually(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + 30s;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(5ms);  // poll
  }
  return true;
}

/// No file of this process may grow beyond `bytes` while it lives: a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit now{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

class Writer : public DaemonTest {
 protected:
  Writer() : thread([this] { writer.run(give_up); }) {}
  ~Writer() override { end(); }
  void end() {
    queue.close();
    if (thread.joinable()) thread.join();
  }
  void push(std::vector<storage::TelemetryFrame> frames) {
    for (auto& frame : frames) queue.push(std::move(frame));
  }

  BoundedQueue<TelemetryEvent> queue{64};
  Listener listener;
  std::atomic<bool> give_up = false;
  ArchiveWriter writer{open(), {}, queue, 16, 5'000'000, listener};
  std::thread thread;
};

TEST_F(Writer, StoresAllThatWasQueuedBeforeItEnds) {
  for (auto& descriptor : descriptors()) queue.push(std::move(descriptor));
  push(telemetry(day, 300));
  end();
  EXPECT_EQ(listener.committed, 300U);
  EXPECT_EQ(listener.known, 3U);
  EXPECT_EQ(writer.counts().stored, 900U);
  EXPECT_EQ(writer.backlog(), 0U);
}

TEST_F(Writer, RunsTasksOnItsThreadAndHandsTheirExceptionsBack) {
  std::thread::id where;
  writer.post([&](auto&, auto&) { where = std::this_thread::get_id(); }).get();
  EXPECT_EQ(where, thread.get_id());
  auto failing = writer.post([](auto&, auto&) { throw std::runtime_error("no"); });
  EXPECT_THROW(failing.get(), std::runtime_error);
}

TEST_F(Writer, BreaksTheFutureOfATaskThatCameTooLate) {
  end();
  auto late = writer.post([](auto&, auto&) {});
  EXPECT_THROW(late.get(), std::future_error);
}

TEST_F(Writer, KeepsABatchThatTheDiskRefusesAndStoresItWhenThereIsRoom) {
  std::optional<FullDisk> full(std::in_place, 256 * 1024);
  std::thread source([&] { push(telemetry(day, 8000)); });
  EXPECT_TRUE(eventually([&] { return !writer.counts().last_error.empty(); }));
  EXPECT_LT(listener.committed, 8000U);
  EXPECT_TRUE(eventually([&] { return queue.waits() > 0; })) << "the source is held back";
  writer.goes_on();
  EXPECT_TRUE(eventually([&] { return writer.goes_on(); })) << "it tries again";
  writer.post([](auto&, auto&) {}).get();  // what is wrong can be recorded
  full.reset();
  source.join();
  end();
  EXPECT_EQ(listener.committed, 8000U);
  EXPECT_EQ(writer.counts().lost, 0U);
  EXPECT_TRUE(writer.counts().last_error.empty());
}

TEST_F(Writer, KeepsABatchWhileTheDatabaseIsAway) {
  push(telemetry(day, 10));
  EXPECT_TRUE(eventually([&] { return listener.committed == 10U; }));
  const std::filesystem::path away = path().string() + ".away";
  std::filesystem::rename(path(), away);
  push(telemetry(day + minute, 10));
  EXPECT_TRUE(eventually([&] { return !writer.counts().last_error.empty(); }));
  EXPECT_NE(writer.counts().last_error.find("was deleted or moved"), std::string::npos);
  std::filesystem::rename(away, path());
  end();
  EXPECT_EQ(listener.committed, 20U);
  EXPECT_EQ(writer.counts().lost, 0U);
}

TEST_F(Writer, GivesUpWhatTheDiskRefusesOnlyWhenItIsToldToAndCountsIt) {
  std::optional<FullDisk> full(std::in_place, 256 * 1024);
  std::thread source([&] { push(telemetry(day, 8000)); });
  EXPECT_TRUE(eventually([&] { return !writer.counts().last_error.empty(); }));
  give_up = true;
  source.join();
  end();
  full.reset();
  EXPECT_EQ(listener.committed + writer.counts().lost, 8000U);
  EXPECT_GT(writer.counts().lost, 0U);
  EXPECT_FALSE(writer.counts().last_error.empty());
}

}  // namespace
}  // namespace reident::test::archive_writer_test
