// backup, verify and retain on a real database, as an operator calls them.
#include <sqlite3.h>

#include "storage/archive/archive.hpp"
#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::care_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t start = 1'700'000'000 * second;  // 2023-11-14T22:13:20Z

constexpr auto first_chunk = storage::ArchiveOptions().chunk_samples;

class Care : public test::CliTest {
 protected:
  Care() { append(0, 600); }

  std::filesystem::path path() const { return folder() / "reident.db"; }
  /// One frame a second with V_BUS (1) and I_BUS (2).
  void append(std::uint64_t from, std::uint64_t to) const {
    storage::Database database(path(), storage::Database::Mode::read_write);
    storage::Archive archive(database);
    archive.describe(std::vector{descriptor(1, "V_BUS"), descriptor(2, "I_BUS")});
    std::vector<storage::TelemetryFrame> frames;
    for (std::uint64_t k = from; k < to; ++k) {
      storage::TelemetryFrame frame;
      frame.spacecraft = "CB4";
      frame.source = "station";
      frame.sequence = k;
      frame.generation_time = start + static_cast<std::int64_t>(k) * second;
      frame.samples = {{1, storage::Quality::good, 28 + static_cast<double>(k % 7)},
                       {2, storage::Quality::good, static_cast<double>(k)}};
      frames.push_back(frame);
    }
    archive.append(frames);
  }
  /// What plain SQL does to the file.
  void change(const std::string& sql) const {
    sqlite3* handle = nullptr;
    ASSERT_EQ(sqlite3_open(path().c_str(), &handle), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(handle);
  }
  static storage::ParameterDescriptor descriptor(std::uint32_t id, const std::string& name) {
    storage::ParameterDescriptor one;
    one.spacecraft = "CB4";
    one.id = id;
    one.name = name;
    return one;
  }
};

TEST_F(Care, BackupSaysWhatItCopied) {
  const test::Ran ran = reident({"backup", "reident.db", "copy.db"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.err, "");
  EXPECT_EQ(ran.out, (folder() / "copy.db").string() + ": " +
                         std::to_string(std::filesystem::file_size(folder() / "copy.db")) +
                         " bytes, 1200 samples up to 2023-11-14T22:23:19Z, "
                         "0 versions of models\n");
  append(600, 700);
  const json again = json_of({"backup", "reident.db", "copy.db", "--replace"});
  EXPECT_EQ(again["samples"], 1400);
  EXPECT_EQ(again["newest"], "2023-11-14T22:24:59Z");
  storage::Database copy(folder() / "copy.db", storage::Database::Mode::read_only);
  EXPECT_EQ(storage::Archive(copy).sample_count(), 1400U);
}

TEST_F(Care, BackupRefusesInOneLineWithTheRemedy) {
  write("taken.db", "something else");
  EXPECT_THAT(refusal_of({"backup", "reident.db", "taken.db"}), HasSubstr("--replace"));
  EXPECT_THAT(refusal_of({"backup", "reident.db", "reident.db", "--replace"}),
              HasSubstr("is the database itself"));
  EXPECT_THAT(refusal_of({"backup", "reident.db", "no/folder/copy.db"}),
              HasSubstr("does not exist"));
  EXPECT_THAT(refusal_of({"backup", "nothing.db", "copy.db"}), HasSubstr("does not exist"));
  EXPECT_THAT(refusal_of({"backup", "taken.db", "copy.db"}), HasSubstr("is not a database"));
  EXPECT_THAT(refusal_of({"backup", "reident.db"}), HasSubstr("copy is required"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "copy.db"));
}

TEST_F(Care, BackupWorksWhileAServiceHoldsTheFile) {
  const storage::Database service(path(), storage::Database::Mode::read_write);
  EXPECT_EQ(json_of({"backup", "reident.db", "copy.db"})["samples"], 1200);
}

TEST_F(Care, VerifySaysThatASoundFileIsSound) {
  const test::Ran ran = reident({"verify", "reident.db"});
  EXPECT_EQ(ran.status, 0) << ran.out << ran.err;
  EXPECT_EQ(ran.out,
            "reident.db: sound; looked at 2 series, 0 chunks with 1200 samples and 0 versions\n");
  reident({"backup", "reident.db", "copy.db"});
  const json found = json_of({"verify", "copy.db", "--quick"});
  EXPECT_EQ(found["sound"], true);
  EXPECT_EQ(found["findings"], json::array());
}

TEST_F(Care, VerifyNamesWhatItFindsAndTheRemedyAndExitsWith1) {
  {
    storage::Database database(path(), storage::Database::Mode::read_write);
    storage::Archive(database).compact();
  }
  change("UPDATE chunk SET samples = 601 WHERE series = 1");
  const test::Ran ran = reident({"verify", "reident.db"});
  EXPECT_EQ(ran.status, 1);
  EXPECT_THAT(
      ran.out,
      HasSubstr("chunk: V_BUS of CB4 (real), 2023-11-14T22:13:20Z to 2023-11-14T22:23:19Z: "
                "its row says 601 samples, there are 600\n  remedy: restore these samples"));
  const test::Ran again = reident({"verify", "reident.db", "--json"});
  EXPECT_EQ(again.status, 1);
  const json object = json::parse(again.out);
  EXPECT_EQ(object["sound"], false);
  EXPECT_EQ(object["findings"][0]["name"], "V_BUS");
  EXPECT_EQ(object["findings"][0]["first"], "2023-11-14T22:13:20Z");
}

TEST_F(Care, VerifyOfWhatIsNoDatabaseIsRefused) {
  EXPECT_THAT(refusal_of({"verify", "nothing.db"}), HasSubstr("does not exist"));
  write("text.db", "something else");
  EXPECT_THAT(refusal_of({"verify", "text.db"}), HasSubstr("is not a database"));
}

TEST_F(Care, SplitMovesClosedYearsAndEverythingIsReadAsBefore) {
  EXPECT_EQ(json_of({"archive", "split", "reident.db"})["chunks"], 0) << "the year goes on";
  const test::Ran before = reident({"export", "reident.db"});
  const json done = json_of({"archive", "split", "reident.db", "--before", "2024"});
  EXPECT_EQ(done["chunks"], 2);
  EXPECT_EQ(done["shards"][0]["samples"], 1200);
  EXPECT_EQ(reident({"export", "reident.db"}).out, before.out);
  EXPECT_EQ(json_of({"verify", "reident.db"})["sound"], true);
  EXPECT_EQ(json_of({"backup", "reident.db", "copy.db"})["shards"], 1);
  std::filesystem::remove_all(folder() / "reident.db.shards");
  EXPECT_THAT(refusal_of({"export", "reident.db"}), HasSubstr("reident.db.shards"));
  const storage::Database service(path(), storage::Database::Mode::read_write);
  EXPECT_THAT(refusal_of({"archive", "split", "reident.db"}), HasSubstr("stop the service"));
}

TEST_F(Care, SplitThroughALinkNamesTheFolderThatHasTheShards) {
  std::filesystem::create_symlink("reident.db", folder() / "link.db");
  EXPECT_THAT(reident({"archive", "split", "link.db", "--before", "2024"}).out,
              HasSubstr("reident.db.shards/"));
}

TEST_F(Care, WhatChangesADatabaseMakesNone) {
  write("reident.toml",
        "[archive]\ndatabase = \"mistyped.db\"\n[[spacecraft]]\nname = \"CB4\"\n"
        "[[spacecraft.equipment]]\nname = \"BDR\"\ninputs = [\"I_BUS\"]\noutputs = "
        "[\"V_BUS\"]\nsample_period = \"1s\"\nwindow = \"30min\"\n");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"archive", "split", "mistyped.db"},
        {"retain", "mistyped.db", "--keep", "1h"},
        {"import", "telemetry.csv", "--undo", "--db", "mistyped.db"},
        {"backfill", "--config", "reident.toml"}})
    EXPECT_THAT(refusal_of(words), HasSubstr("mistyped.db does not exist")) << words[0];
  for (const auto& file : std::filesystem::directory_iterator(folder()))
    EXPECT_FALSE(file.path().filename().string().starts_with("mistyped.db")) << file.path();
}

TEST_F(Care, BackfillNamesParametersThatNoTelemetryHas) {
  append(600, 20000);
  write("reident.toml",
        "[archive]\ndatabase = \"reident.db\"\n[[spacecraft]]\nname = \"CB4\"\n"
        "[[spacecraft.equipment]]\nname = \"BDR\"\ninputs = [\"I_BUSS\"]\noutputs = "
        "[\"V_BUSS\"]\nsample_period = \"1s\"\nwindow = \"30min\"\n");
  const test::Ran ran = reident({"backfill", "--config", "reident.toml"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_THAT(ran.err, HasSubstr("CB4/BDR: no telemetry has I_BUSS"));
  EXPECT_THAT(ran.err, HasSubstr("V_BUSS"));
}

TEST_F(Care, RetainRemovesByAgeAndSaysSoBeforehand) {
  append(600, 20000);  // a chunk and a part of a second
  const json plan = json_of({"retain", "reident.db", "--keep", "1h", "--dry-run"});
  const json done = json_of({"retain", "reident.db", "--keep", "1h"});
  EXPECT_EQ(done["samples"], 2 * first_chunk);
  EXPECT_EQ(done["first"], "2023-11-14T22:13:20Z");
  EXPECT_LE(plan["samples"], done["samples"]);
  EXPECT_EQ(json_of({"verify", "reident.db"})["samples"], 2 * (20000 - first_chunk));
  const test::Ran again = reident({"retain", "reident.db", "--keep", "1h"});
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.out, HasSubstr("removed nothing; "));
}

TEST_F(Care, RetainTakesTheRuleOfTheConfiguration) {
  append(600, 20000);
  const std::string equipment =
      "[[spacecraft]]\nname = \"CB4\"\n[[spacecraft.equipment]]\nname = \"BDR\"\n"
      "inputs = [\"I_BUS\"]\noutputs = [\"V_BUS\"]\nsample_period = \"1s\"\nwindow = \"30min\"\n";
  write("kept.toml", "[archive]\nkeep = \"1h\"\n" + equipment);
  write("plain.toml", equipment);
  EXPECT_THAT(refusal_of({"retain", "reident.db", "--config", "plain.toml"}),
              HasSubstr("nothing says what to keep"));
  EXPECT_EQ(json_of({"retain", "reident.db", "--config", "kept.toml"})["samples"], 2 * first_chunk);
}

TEST_F(Care, RetainRefusesInOneLineWithTheRemedy) {
  EXPECT_THAT(refusal_of({"retain", "reident.db"}), HasSubstr("--keep TIME or --max-size SIZE"));
  EXPECT_THAT(refusal_of({"retain", "reident.db", "--keep", "long"}), HasSubstr("as 400d"));
  EXPECT_THAT(refusal_of({"retain", "reident.db", "--max-size", "7"}), HasSubstr("as 200GB"));
  const storage::Database service(path(), storage::Database::Mode::read_write);
  EXPECT_THAT(refusal_of({"retain", "reident.db", "--keep", "1h"}),
              HasSubstr("a service that runs removes by keep and max_size of its own"));
}

}  // namespace
}  // namespace reident::cli::care_test
