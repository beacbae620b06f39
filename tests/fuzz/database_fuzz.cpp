// A database with any damage is opened for reading and read, or refused with a reason; whatever it
// holds, nothing but storage's error ends a read. The bytes are places and new bytes of a good one,
// after one that says what is read, and whether they are on pages of the schema. TMPDIR is best in
// memory.
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

#include <sqlite3.h>

#include "storage/archive/archive.hpp"
#include "storage/care/retention.hpp"
#include "storage/care/verify.hpp"
#include "storage/database/connection.hpp"
#include "storage/registry/registry.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace reident::storage;
namespace fs = std::filesystem;

void require(bool condition) {
  if (!condition) std::abort();
}

constexpr Time hour = 3600 * second_ns;

TelemetryFrame frame_at(Time time, std::uint64_t sequence) {
  TelemetryFrame frame;
  frame.spacecraft = "SAT";
  frame.source = "station";
  frame.sequence = sequence;
  frame.generation_time = frame.reception_time = time;
  for (std::uint32_t id = 1; id <= 3; ++id)
    frame.samples.push_back({id, Quality::good, static_cast<double>(sequence % (7 * id))});
  return frame;
}

/// Chunks, samples that wait for one, gaps, late samples, a version with its record, an alarm.
void fill(const fs::path& path) {
  Database database(path, Database::Mode::read_write, Durability::kill);
  Archive archive(database, {.chunk_samples = 64, .recent_samples = 256, .step_samples = 64});
  for (std::uint32_t id = 1; id <= 3; ++id)
    archive.describe({{{.spacecraft = "SAT", .id = id, .name = "P" + std::to_string(id)}}});
  std::vector<TelemetryFrame> frames;
  for (std::uint64_t i = 0; i < 400; ++i)
    if (i % 50 != 7) frames.push_back(frame_at(static_cast<Time>(i) * second_ns, i + 1));
  archive.append(frames);
  archive.compact();
  archive.seal("SAT", hour);
  archive.append(std::vector{frame_at(7 * second_ns, 8), frame_at(500 * second_ns, 401)});
  Registry registry(database);
  registry.journal().begin_term(2, "a", 1);
  NewAttempt attempt;
  attempt.spacecraft = "SAT";
  attempt.equipment = "BDR";
  attempt.window = {0, 100};
  attempt.trigger = "slide";
  attempt.outcome = "challenger";
  attempt.evidence_json = "{}";
  registry.record(attempt, {.model_json = "{}", .digest = "d"},
                  {.kind = DecisionKind::approve, .actor = "gate", .reason = "because"});
  Block block;
  block.range = {60, 120};
  block.output_mean = {0.5};
  registry.record_scores("SAT", "BDR", block,
                         {{2, 60, 5, {0.1}, {0.2}, {}, {{1, 2}, 7, {3}, 4}, {0.5}}});
  registry.raise({"disk", {}, "full", 40});
}

std::vector<char> good_file(const fs::path& path) {
  fill(path);
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Whatever ends a read is storage's error, with a reason.
template <class Action>
void look(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    require(error.what()[0] != '\0');
  }
}

enum class Read { archive, registry, both, verify };

void read(Database& database, Read what) {
  const Archive archive(database);
  const Registry registry(database);
  if (what == Read::archive || what == Read::both) {
    for (std::uint32_t id = 1; id <= 3; ++id) {
      // A range of all time makes room for millions of samples, which takes longer than all else.
      look([&] { archive.read_with_sources("SAT", Origin::real, id, {-hour, hour}); });
      look([&] { archive.first_at_or_after("SAT", Origin::real, id, 100 * second_ns); });
    }
    look([&] { archive.parameters("SAT"); });
    look([&] { archive.extent("SAT", Origin::real); });
    look([&] { archive.late_ranges("SAT"); });
    look([&] { archive.sequence_gaps(); });
    look([&] { archive.sources(); });
    look([&] { plan_retention(database, {.max_bytes = 1}, {}, hour); });
  }
  if (what == Read::registry || what == Read::both) {
    look([&] { registry.champions(); });
    look([&] { registry.decisions("SAT", "BDR"); });
    look([&] { registry.attempts(); });
    look([&] { registry.scores("SAT", "BDR", 2, 0); });
    look([&] { registry.alarms(); });
    look([&] { registry.journal().part(0, std::numeric_limits<std::size_t>::max()); });
  }
  if (what == Read::verify)
    look([&] { verify(database, {}, [](const VerifyProgress&) { return true; }); });
}

/// A good file, which is changed for each input and put back. It stays open where its schema is as
/// it was: opening takes many times as long as all reading.
class ChangedFile {
 public:
  ChangedFile() : good_(good_file(path_)), database_(open()) {
    const std::string_view content(good_.data(), good_.size());
    for (std::size_t page = 0; page < good_.size(); page += page_bytes) {
      const bool of_schema =
          page == 0 || content.substr(page, page_bytes).find("CREATE ") != content.npos;
      (of_schema ? schema_pages_ : other_pages_).push_back(page);
    }
  }

  void read_changed(std::span<const std::uint8_t> changes, Read what, bool in_schema) {
    const std::vector<std::size_t>& pages = in_schema ? schema_pages_ : other_pages_;
    std::vector<std::size_t> changed;
    for (; changes.size() >= 4; changes = changes.subspan(4)) {
      const std::size_t in_page = (changes[0] + 256U * changes[1]) % page_bytes;
      changed.push_back(pages[changes[2] % pages.size()] + in_page);
      write(changed.back(), static_cast<char>(changes[3]));
    }
    if (in_schema) {
      look([&] {
        Database again = open();
        Registry(again).champions();  // a schema that cannot be read is parsed at each statement
        read(again, what);
      });
    } else {
      read(database_, what);
      database_.impl().archive.reset();
      sqlite3_db_release_memory(connection(database_).handle());
    }
    for (const std::size_t place : changed) write(place, good_[place]);
  }

 private:
  static constexpr std::size_t page_bytes = 4096;

  Database open() const { return {path_, Database::Mode::read_only}; }
  void write(std::size_t place, char byte) {
    require(::pwrite(file_, &byte, 1, static_cast<off_t>(place)) == 1);
  }

  reident::test::TemporaryFolder folder_;
  fs::path path_ = folder_ / "changed.db";
  std::vector<char> good_;
  int file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  Database database_;
  std::vector<std::size_t> schema_pages_, other_pages_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static ChangedFile file;
  if (size > 0)
    file.read_changed({bytes + 1, size - 1}, static_cast<Read>(bytes[0] % 4), bytes[0] / 4 == 63);
  return 0;
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  require(sqlite3_config(SQLITE_CONFIG_SINGLETHREAD) == SQLITE_OK);
  return 0;
}
