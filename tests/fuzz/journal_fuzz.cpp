// Any bytes that the other service of a pair sends as rows are added to the registry, which can
// then be read, or are refused with a reason and change nothing. The first byte says what is done
// with them, and whether the rest are the bytes, or places and new bytes of good ones. TMPDIR is
// best in memory.
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <unistd.h>
#include <vector>

#include <sqlite3.h>

#include "storage/database/connection.hpp"
#include "storage/registry/journal.hpp"
#include "storage/registry/registry.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace reident::storage;
namespace fs = std::filesystem;

using Bytes = std::vector<std::uint8_t>;

void require(bool condition) {
  if (!condition) std::abort();
}

constexpr auto writing = Database::Mode::read_write;

NewAttempt attempt_at(Time time) {
  NewAttempt attempt;
  attempt.spacecraft = "SAT";
  attempt.equipment = "BDR";
  attempt.window = {0, 100};
  attempt.trigger = "slide";
  attempt.time = time;
  attempt.outcome = "challenger";
  attempt.evidence_json = "{}";
  return attempt;
}

/// A term with a row of each kind.
Bytes good_rows(const fs::path& path) {
  Database database(path, writing, Durability::kill);
  Registry registry(database);
  registry.journal().begin_term(2, "a", 1);
  registry.record(attempt_at(10), {.model_json = "{}", .digest = "d"},
                  {.kind = DecisionKind::approve, .actor = "gate", .reason = "because"});
  registry.put_on_hold("SAT", "BDR", {"Ana", "training", 20});
  registry.execute({"console", 1, "hold", "SAT", "BDR", 0, "Ana", ""}, 30, [] {
    return CommandOutcome{true, "held"};
  });
  registry.raise({"disk", {}, "full", 40});
  registry.record_change({"SAT", "BDR"}, {2, 5, 6}, 50);
  SimulatorState simulator;
  simulator.simulator = "trainer";
  simulator.equipment = {"SAT", "BDR"};
  registry.record_simulator(simulator);
  Block block;
  block.range = {60, 120};
  block.output_mean = {0.5};
  registry.record_scores("SAT", "BDR", block,
                         {{2, 60, 5, {0.1}, {0.2}, {}, {{1, 2}, 7, {3}, 4}, {0.5}}});
  return registry.journal().part(0, std::numeric_limits<std::size_t>::max()).rows;
}

/// A service's registry, which is empty again for each input. It stays open: opening takes many
/// times as long as all that is done with it.
class Follower {
 public:
  Follower() {
    { const Database made(path_, writing, Durability::kill); }
    std::ifstream file(path_, std::ios::binary);
    empty_.assign(std::istreambuf_iterator<char>(file), {});
    database_.emplace(path_, writing, Durability::kill);
  }
  const Bytes& good() const { return good_; }
  Database& database() { return *database_; }

  void empty() {
    sqlite3* const handle = connection(*database_).handle();
    require(sqlite3_wal_checkpoint_v2(handle, nullptr, SQLITE_CHECKPOINT_TRUNCATE, nullptr,
                                      nullptr) == SQLITE_OK);
    require(::pwrite(file_, empty_.data(), empty_.size(), 0) ==
            static_cast<ssize_t>(empty_.size()));
    sqlite3_db_release_memory(handle);
  }

 private:
  reident::test::TemporaryFolder folder_;
  fs::path path_ = folder_ / "follower.db";
  Bytes good_ = good_rows(folder_ / "leader.db");
  std::vector<char> empty_;
  int file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  std::optional<Database> database_;
};

/// What a service asks when it takes over.
void read(Database& database) {
  const Registry registry(database);
  for (const EquipmentName& name : registry.equipment()) {
    registry.summaries(name.spacecraft, name.equipment);
    registry.decisions(name.spacecraft, name.equipment);
    registry.blocks(name.spacecraft, name.equipment, 0);
    registry.last_change(name);
  }
  registry.champions();
  registry.alarms();
  registry.simulators();
  registry.journal().terms();
  registry.journal().overruled_since(0);
  registry.journal().part(0, std::numeric_limits<std::size_t>::max());
}

/// False where it was refused, with a reason.
template <class Action>
bool taken(const Action& action) {
  try {
    action();
    return true;
  } catch (const Error& error) {
    require(error.what()[0] != '\0');
    return false;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static Follower follower;
  if (size == 0) return 0;
  std::span<const std::uint8_t> data(bytes + 1, size - 1);
  JournalPart part{0, 1, {}};
  if ((bytes[0] & 1U) == 0) {
    part.rows.assign(data.begin(), data.end());
  } else {
    part.rows = follower.good();
    for (; data.size() >= 3; data = data.subspan(3))
      part.rows[(data[0] + 256U * data[1]) % part.rows.size()] = data[2];
  }
  if (part.rows.empty()) return 0;
  Database& database = follower.database();
  Journal journal(database);
  const bool keeps = (bytes[0] & 2U) != 0;
  if (!taken(
          [&] { keeps ? journal.keep_overruled(part, 1, "b", 9) : void(journal.apply(part)); })) {
    require(journal.last() == 0 && journal.terms().empty());
    return 0;
  }
  taken([&] { read(database); });
  if (!keeps) taken([&] { journal.overrule(0, 9); });
  follower.empty();
  return 0;
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  require(sqlite3_config(SQLITE_CONFIG_SINGLETHREAD) == SQLITE_OK);
  return 0;
}
