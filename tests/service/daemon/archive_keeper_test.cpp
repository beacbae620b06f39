#include "service/daemon/archive_keeper.hpp"

#include <thread>

#include "tests/service/daemon_fixture.hpp"

namespace reident::test::archive_keeper_test {
namespace {

struct Nobody : ArchiveListener {
  void stored(const std::vector<storage::TelemetryFrame>&, const storage::AppendReport&) override {}
  void described(const std::vector<storage::ParameterDescriptor>&,
                 const storage::Archive&) override {}
};

class Keeper : public DaemonTest {
 protected:
  Keeper() {
    settings.keep = 60 * minute;
    {
      storage::Database database = open();
      storage::Archive archive(database, {.chunk_samples = 64});
      archive.append(telemetry(day, 4 * 3600));
      archive.compact();
    }
    writer.emplace(open(), storage::ArchiveOptions{}, queue, 16, 5'000'000, nobody);
    thread = std::thread([this] { writer->run(give_up); });
  }
  ~Keeper() override {
    queue.close();
    thread.join();
  }
  /// What the writer's thread sees once all that was posted so far is done, steps of a run too.
  std::uint64_t samples() {
    std::uint64_t count = 0, before = 0;
    do {
      before = count;
      writer->post([&count](auto&, storage::Archive& archive) { count = archive.sample_count(); })
          .get();
    } while (count != before);
    return count;
  }

  Config settings = config();
  storage::Time now = day + 4 * 60 * minute;
  BoundedQueue<TelemetryEvent> queue{64};
  Nobody nobody;
  std::atomic<bool> give_up = false;
  std::optional<ArchiveWriter> writer;
  std::thread thread;
};

TEST_F(Keeper, RemovesWhatIsTooOldAndThenWaits) {
  ArchiveKeeper keeper(settings, *writer, [this] { return now; });
  keeper.look();
  const std::uint64_t left = samples();
  EXPECT_GE(left, 3U * 3600);
  EXPECT_LE(left, 3U * (3600 + 64));
  // Hours later all of that is too old: it waits for its time.
  writer
      ->post([](auto&, storage::Archive& archive) {
        archive.append(telemetry(day + 8 * 60 * minute, 100));
      })
      .get();
  now += ArchiveKeeper::interval - 1;
  keeper.look();
  EXPECT_EQ(samples(), left + 3 * 100);
  now = day + 9 * 60 * minute;
  keeper.look();
  EXPECT_EQ(samples(), 3U * 100);
}

TEST_F(Keeper, RemovesNothingUnlessItIsConfigured) {
  settings.keep.reset();
  ArchiveKeeper keeper(settings, *writer, [this] { return now; });
  keeper.look();
  EXPECT_EQ(samples(), 3U * 4 * 3600);
}

TEST_F(Keeper, LeavesWhatTheNextWindowsNeedHoweverLittleRoomThereIs) {
  settings.keep.reset();
  settings.max_size = 4096;
  writer->post([](auto&, storage::Archive& archive) { archive.describe(descriptors()); }).get();
  ArchiveKeeper keeper(settings, *writer, [this] { return now; });
  keeper.look();
  const std::uint64_t left = samples();
  EXPECT_GE(left, 3U * 15 * 60) << "a window and a slide";
  EXPECT_LE(left, 3U * (15 * 60 + 2 * 64 + 3));
}

}  // namespace
}  // namespace reident::test::archive_keeper_test
