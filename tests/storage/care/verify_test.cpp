#include "storage/care/verify.hpp"

#include <algorithm>
#include <limits>
#include <random>

#include "storage/archive/holdings.hpp"
#include "storage/care/retention.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::verify_test {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;
using Mode = Database::Mode;

constexpr Time second = 1'000'000'000;
constexpr ArchiveOptions small_chunks{.chunk_samples = 64};

bool to_the_end(const VerifyProgress&) {
  return true;
}

/// Three parameters with a hole, a source that skipped numbers, chunks and what is recent over
/// them; a version. Plain SQL may do with the closed file what it likes.
class Verify : public ::testing::Test {
 protected:
  Verify() {
    Database database(path, Mode::read_write);
    Archive archive(database, small_chunks);
    for (std::uint64_t k = 0; k < 600; k += 50) archive.append(frames(k, k + 50));
    archive.compact();
    archive.seal("CB4", 500 * second);
    archive.append(frames(640, 700));
    archive.append(frames(100, 140, 2));  // late ones between those in chunks
    Registry registry(database);
    NewAttempt attempt;
    attempt.spacecraft = "CB4";
    attempt.equipment = "BDR";
    attempt.window = {0, 500 * second};
    attempt.evidence_json = "{}";
    registry.record(attempt, {"{}", "digest"}, {DecisionKind::approve, "gate", "Good."});
  }

  static std::vector<TelemetryFrame> frames(std::uint64_t from, std::uint64_t to, Time shift = 0) {
    std::vector<TelemetryFrame> result;
    for (std::uint64_t k = from; k < to; ++k) {
      std::vector<Sample> samples;
      for (std::uint32_t p = 1; p <= 3; ++p)
        samples.push_back({p, Quality::good, std::sin(static_cast<double>(k * p) / 9)});
      if (k % 97 == 0) samples[1].value = std::numeric_limits<double>::infinity();
      result.push_back(frame(2 * k + (shift ? 1 : 0),
                             static_cast<Time>(k) * second + shift * second / 10, samples));
    }
    return result;
  }
  VerifyReport report(bool quick = false) const {
    Database database(path, Mode::read_only);
    return verify(database, {.quick = quick}, to_the_end);
  }
  /// "check: name: what" of each finding.
  static std::vector<std::string> texts(const VerifyReport& report) {
    std::vector<std::string> result;
    for (const Finding& finding : report.findings) {
      EXPECT_NE(finding.remedy, "");
      result.push_back(finding.check + ": " + finding.name + ": " + finding.what);
    }
    return result;
  }
  std::vector<std::string> after(const std::string& sql, bool quick = false) const {
    EXPECT_THAT(rows(path, sql), IsEmpty());
    return texts(report(quick));
  }

  TemporaryFolder folder;
  fs::path path = folder / "a.db";
};

TEST_F(Verify, FindsNothingInASoundFile) {
  for (const bool quick : {false, true}) {
    const VerifyReport found = report(quick);
    EXPECT_THAT(texts(found), IsEmpty());
    EXPECT_TRUE(found.complete);
    EXPECT_EQ(found.series, 3U);
    EXPECT_GE(found.chunks, 3U * 9);
    EXPECT_EQ(found.versions, 1U);
  }
  // Every sample that is in a chunk or in a fragment, the 40 late ones of each among them.
  EXPECT_EQ(report().samples, 3U * (600 + 60 + 40));
}

TEST_F(Verify, FindsNothingInAnEmptyFileAndInOneThatIsCompacted) {
  {
    Database database(path, Mode::read_write);
    Archive(database, small_chunks).compact();
  }
  EXPECT_THAT(texts(report()), IsEmpty());
  fs::remove(path);
  { Database database(path, Mode::read_write); }
  EXPECT_THAT(texts(report()), IsEmpty());
}

TEST_F(Verify, NamesTheParameterAndTheTimeOfAChunkThatWasChanged) {
  // The byte before the last of a body of series 2, which its checksum covers.
  EXPECT_THAT(rows(path,
                   "UPDATE chunk_data SET bytes = CAST(substr(bytes, 1, length(bytes) - 1) || "
                   "x'5a' AS BLOB) WHERE id = (SELECT data FROM chunk WHERE series = 2 "
                   "ORDER BY first_time LIMIT 1 OFFSET 3)"),
              IsEmpty());
  const VerifyReport found = report();
  ASSERT_THAT(found.findings, SizeIs(1));
  const Finding& finding = found.findings[0];
  EXPECT_EQ(finding.check, "chunk");
  EXPECT_EQ(finding.spacecraft, "CB4");
  EXPECT_EQ(finding.name, "2");
  EXPECT_EQ(finding.first, 192 * second);
  EXPECT_EQ(finding.last, 255 * second);
  EXPECT_THAT(finding.what, HasSubstr("64 samples cannot be read"));
  EXPECT_THAT(finding.remedy, HasSubstr("reident import"));
  EXPECT_THAT(texts(report(true)), IsEmpty()) << "the body is not looked at quickly";
}

TEST_F(Verify, DecodesAgainWhatChangedAlone) {
  const auto knowing = [&](const SoundChunks& known) {
    Database database(path, Mode::read_only);
    return verify(database, {.known = &known}, to_the_end);
  };
  const VerifyReport first = knowing({});
  EXPECT_EQ(first.known, 0U);
  EXPECT_EQ(first.sound.size(), first.chunks);
  const VerifyReport again = knowing(first.sound);
  EXPECT_THAT(texts(again), IsEmpty());
  EXPECT_EQ(again.sound, first.sound);
  // All but those that late samples lie in, which are counted by their times.
  EXPECT_GE(again.known, first.chunks - 3U * 3);
  EXPECT_LT(again.known, first.chunks);
  {
    Database database(path, Mode::read_write);
    Archive archive(database, small_chunks);
    archive.append(frames(860, 1000));
    archive.compact();
  }
  const VerifyReport later = knowing(again.sound);
  EXPECT_THAT(texts(later), IsEmpty());
  EXPECT_GT(later.known, 0U);
  EXPECT_EQ(later.sound.size(), later.chunks);
  EXPECT_THAT(rows(path,
                   "UPDATE chunk_data SET bytes = CAST(substr(bytes, 1, length(bytes) - 1) || "
                   "x'5a' AS BLOB) WHERE id = (SELECT data FROM chunk WHERE series = 2 "
                   "ORDER BY first_time LIMIT 1)"),
              IsEmpty());
  const VerifyReport damaged = knowing(later.sound);
  ASSERT_THAT(texts(damaged), SizeIs(1)) << "a changed byte is found in what is known too";
  EXPECT_EQ(damaged.findings[0].check, "chunk");
  EXPECT_EQ(damaged.sound.size(), later.chunks - 1);
}

struct Damage {
  const char* sql;
  const char* finding;
  bool quick = true;  // found quickly too
};

TEST_F(Verify, FindsEachContradiction) {
  const std::string some_chunk = " WHERE series = 1 AND first_time = 64000000000";
  const Damage damages[] = {
      {"UPDATE chunk SET samples = 65", "its row says 65 samples, there are 64"},
      {"UPDATE chunk SET last_time = last_time + 1", "its row says other times than it holds"},
      {"UPDATE chunk SET least = NULL", "its row says other least and greatest values"},
      {"UPDATE chunk SET greatest = 7.5", "its row says other least and greatest values"},
      {"UPDATE chunk SET step = 5", "its row says another step than its times have", false},
      {"DELETE FROM chunk_data WHERE id = (SELECT data FROM chunk", "of chunk_data) are missing"},
      {"DELETE FROM chunk", "row 2 of chunk_data belongs to 0 chunks"},
  };
  const std::string whole = read_file(path);
  for (const Damage& damage : damages) {
    const std::string sql = damage.sql + some_chunk +
                            (std::string(damage.sql).find('(') != std::string::npos ? ")" : "");
    for (const bool quick : {false, true}) {
      SCOPED_TRACE(sql + (quick ? ", quickly" : ""));
      write_file(path, whole);
      const auto found = after(sql, quick);
      if (damage.quick || !quick)
        EXPECT_THAT(found, Contains(HasSubstr(damage.finding)));
      else
        EXPECT_THAT(found, IsEmpty());
    }
  }
}

TEST_F(Verify, AFirstChunkThatEndsBeforeItBeginsEndsNoRead) {
  rows(path,
       "UPDATE chunk SET last_time = first_time - 5 WHERE series = 1 AND first_time = 64000000000");
  Database database(path, Mode::read_only);
  const Archive archive(database);
  const Series held = archive.read("CB4", Origin::real, 1, {64 * second_ns - 5, 86400 * second_ns});
  EXPECT_GT(held.time.size(), 600U) << "all but those before";
}

TEST_F(Verify, EndsWhereAKeyIsNoInteger) {
  const std::string whole = read_file(path);
  EXPECT_THAT(after("UPDATE recent SET batch = 'x' || batch"),
              Contains(HasSubstr("rows of the table recent out of order")));
  write_file(path, whole);
  EXPECT_THAT(after("UPDATE chunk SET first_time = 'x' || first_time"), Not(IsEmpty()));
  Database database(path, Mode::read_only);
  EXPECT_THAT(error_of([&] { plan_retention(database, {.max_bytes = 1}, {}, 0); }),
              StartsWith("corrupt: "));
  SampleColumns samples;
  SeriesBatches batches(database, 1, {-86400 * second, 86400 * second}, 2, {});
  EXPECT_THAT(error_of([&] {
                while (batches.next(samples)) continue;
              }),
              StartsWith("corrupt: "));
}

TEST_F(Verify, BatchesThatCannotBeAreNotCountedUpTo) {
  rows(
      path,
      "UPDATE series SET moved = -9223372036854775807;"
      "UPDATE recent SET batch = 9223372036854775800 WHERE batch = (SELECT min(batch) FROM recent);"
      "UPDATE recent SET batch = batch - 9223372036854775800 WHERE batch < 9223372036854775800");
  Database database(path, Mode::read_only);
  const Archive archive(database);
  EXPECT_THAT(error_of([&] {
                archive.read("CB4", Origin::real, 1, {0, 86400 * second_ns});
              }),
              StartsWith("corrupt: "));
}

TEST_F(Verify, FindsWhatContradictsTheSamplesOfASeries) {
  const Damage damages[] = {
      {"UPDATE series SET samples = samples + 1 WHERE id = 1",
       "its row says 761 samples, there are 760"},
      {"UPDATE series SET last_time = last_time + 1 WHERE id = 1", "other first and last times"},
      {"UPDATE series SET first_time = 5 WHERE id = 2", "other first and last times"},
      {"DELETE FROM sample_gap", "is not the one of its samples (1)"},
      {"INSERT INTO sample_gap VALUES (1, 7, 9)", "they differ from here on"},
      {"UPDATE recent SET samples = 1", "says other counts or times than it holds"},
      {"UPDATE recent SET data = x'0102'", "recent samples cannot be read"},
      {"DELETE FROM recent WHERE series = 2", "its row says 760 samples, there are 700"},
      {"UPDATE revision SET last_time = last_time + 1 WHERE series = 1",
       "what a late change replaced cannot be read: its row says other times"},
      {"UPDATE revision SET landed = x'00'",
       "what a late change replaced cannot be read: its chunk"},
      {"UPDATE source SET name = 'other', spacecraft = 'X'", "name the source 1, which does not"},
  };
  {  // a hole that is in chunks
    Database database(path, Mode::read_write);
    Archive archive(database, small_chunks);
    archive.compact();
    archive.append(frames(800, 860));
  }
  ASSERT_THAT(texts(report()), IsEmpty());
  const std::string whole = read_file(path);
  for (const Damage& damage : damages) {
    SCOPED_TRACE(damage.sql);
    write_file(path, whole);
    EXPECT_THAT(after(damage.sql), Contains(HasSubstr(damage.finding)));
  }
}

TEST_F(Verify, FindsWhatContradictsItselfInOtherTables) {
  const Damage damages[] = {
      {"UPDATE source SET missing = missing + 1", "numbers are missing; its gaps have"},
      {"UPDATE sequence_gap SET last = last + 2 WHERE first = (SELECT min(first) FROM "
       "sequence_gap)",
       "overlaps the one before it"},
      {"DROP VIEW champion", "schema: : the view champion is missing"},
      {"DROP TRIGGER decision_update", "schema: : the trigger decision_update is missing"},
      {"ALTER TABLE source ADD COLUMN more", "schema: : the table source is not the one"},
      {"CREATE TRIGGER mine AFTER INSERT ON series BEGIN SELECT 1; END",
       "the trigger mine is not of this program"},
      {"DROP TRIGGER decision_delete; DELETE FROM decision", "version 1 has no decision"},
      {"DROP TRIGGER version_update; UPDATE version SET number = 3", "numbered up to 3"},
      {"DROP TRIGGER attempt_update; UPDATE attempt SET evidence_json = '{'", "is no JSON"},
      {"DROP TRIGGER attempt_delete; DELETE FROM attempt", "that do not exist"},
      {"INSERT INTO block VALUES ('CB4', 'BDR', 5, 9, 1, 1.0, x'00', x'00', x'', x'', x'')",
       "a block is no list of numbers"},
      {"INSERT INTO score VALUES ('CB4', 'BDR', 1, 5, 1, x'', x'00', x'', x'', NULL, x'', 0, x'')",
       "a score of version 1 is no list of numbers"},
      {"INSERT INTO late_range (series, begin_time, end_time) VALUES (1, 9, 5)", "late"},
      {"INSERT INTO damaged_chunk (series, first_time, last_time, samples, bytes, reason, time) "
       "VALUES (1, 9, 5, 12, x'00', 'does not match its checksum', 1)",
       "12 samples could not be decoded and were set aside: does not match its checksum"},
  };
  const std::string whole = read_file(path);
  for (const Damage& damage : damages) {
    SCOPED_TRACE(damage.sql);
    write_file(path, whole);
    EXPECT_THAT(after(damage.sql), Contains(HasSubstr(damage.finding)));
  }
}

TEST_F(Verify, FindsNothingWrongInTheRegistryOfAPairUnlessItsJournalHasAHole) {
  {
    Database database(path, Mode::read_write);
    Registry registry(database);
    registry.journal().begin_term(2, "a", 5);
    NewAttempt attempt;
    attempt.spacecraft = "CB4";
    attempt.equipment = "BDR";
    attempt.evidence_json = "{}";
    for (int i = 0; i < 2; ++i)  // the versions 2 and 4
      registry.record(attempt, {"{}", "digest"}, {DecisionKind::wait, "gate", "Good."});
  }
  EXPECT_THAT(texts(report()), IsEmpty());
  EXPECT_THAT(after("DELETE FROM journal WHERE id = 2"), Contains(HasSubstr("numbered up to")));
}

TEST_F(Verify, AsksForTheModelsThatStorageCannotRead) {
  Database database(path, Mode::read_only);
  const VerifyReport found =
      verify(database, {.mistake_in = [](const Version& version) -> std::optional<std::string> {
               return "its digest " + version.digest + " is wrong";
             }},
             to_the_end);
  EXPECT_THAT(texts(found), ElementsAre("versions: BDR: version 1: its digest digest is wrong"));
}

TEST_F(Verify, CanBeStopped) {
  Database database(path, Mode::read_only);
  const VerifyReport found =
      verify(database, {}, [](const VerifyProgress& progress) { return progress.share < 0.5; });
  EXPECT_FALSE(found.complete);
  EXPECT_LT(found.series, 3U);
}

TEST_F(Verify, FindsNothingWrongWhileAnotherProgramWrites) {
  Database database(path, Mode::read_write);
  Archive archive(database, {.chunk_samples = 64, .recent_samples = 300, .recent_batches = 3});
  Database reader(path, Mode::read_only);
  std::uint64_t next = 1000, looks = 0;
  const VerifyReport found = verify(reader, {}, [&](const VerifyProgress&) {
    archive.append(frames(next, next + 20));
    archive.append(frames(next - 600, next - 590, 3));
    next += 20;
    return ++looks < 400;
  });
  EXPECT_THAT(texts(found), IsEmpty());
  EXPECT_TRUE(found.complete);
  EXPECT_GT(looks, 20U);
}

TEST_F(Verify, FindsAChangeOfAnyByteOfAChunk) {
  const auto put = [this](const std::string& hex) {
    EXPECT_THAT(rows(path, "UPDATE chunk_data SET bytes = x'" + hex + "' WHERE id = 2"), IsEmpty());
  };
  const std::string whole = rows(path, "SELECT hex(bytes) FROM chunk_data WHERE id = 2").at(0);
  ASSERT_GT(whole.size(), 300U);
  std::mt19937 random(20170717);
  for (std::size_t at = 0; at < whole.size(); at += 2) {
    std::string hex = whole;
    const std::size_t digit = at + random() % 2;
    hex[digit] = hex[digit] == '0' ? 'F' : '0';
    put(hex);
    EXPECT_THAT(texts(report()), SizeIs(1)) << "byte " << at / 2;
  }
  put(whole);
  EXPECT_THAT(texts(report()), IsEmpty());
}

/// What a reader gets of each sample.
std::string content(const fs::path& path) {
  Database database(path, Mode::read_only);
  const Archive archive(database);
  std::string text;
  for (std::uint32_t p = 1; p <= 3; ++p) {
    const Series series = archive.read_with_sources(
        "CB4", Origin::real, p,
        {std::numeric_limits<Time>::min(), std::numeric_limits<Time>::max()});
    const auto add = [&text](const auto& column) {
      text.append(reinterpret_cast<const char*>(column.data()), column.size() * sizeof column[0]);
    };
    add(series.time), add(series.value), add(series.quality), add(series.source);
  }
  return text;
}

TEST_F(Verify, FindsEveryChangedByteThatChangesASample) {
  {
    Database database(path, Mode::read_write);
    Archive archive(database, small_chunks);
    archive.append(frames(900, 1500));
  }
  const std::string whole = read_file(path), expected = content(path);
  std::mt19937 random(20170717);
  int found = 0, harmless = 0, changed = 0;
  for (int i = 0; i < 250; ++i) {
    std::string bytes = whole;
    const std::size_t at = random() % bytes.size();
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
    write_file(path, bytes);
    fs::remove(path.string() + "-wal");
    fs::remove(path.string() + "-shm");
    bool is_found = false, is_same = false;
    const std::string refused = error_of([&] { is_found = !report().findings.empty(); });
    error_of([&] { is_same = content(path) == expected; });
    is_found = is_found || refused != "no error";
    found += is_found;
    harmless += !is_found && is_same;
    changed += !is_found && !is_same;
    EXPECT_TRUE(is_found || is_same) << "bit of byte " << at << " of page " << at / 4096;
  }
  EXPECT_EQ(changed, 0);
  EXPECT_GT(found, 60);
  RecordProperty("found", found);
  RecordProperty("harmless", harmless);
}

}  // namespace
}  // namespace reident::storage::test::verify_test
