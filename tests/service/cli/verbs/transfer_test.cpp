// import, export and completeness.
#include <chrono>
#include <fcntl.h>
#include <fstream>
#include <random>
#include <sstream>
#include <unistd.h>

#include <fmt/format.h>
#include <sys/wait.h>

#include "storage/archive/archive.hpp"
#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::transfer_test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

storage::ParameterDescriptor descriptor(const std::string& spacecraft, std::uint32_t id,
                                        const std::string& name, const std::string& unit) {
  storage::ParameterDescriptor made;
  made.spacecraft = spacecraft;
  made.id = id;
  made.name = name;
  made.unit = unit;
  return made;
}

class Transfer : public test::CliTest {
 protected:
  /// A row a second from 2023-11-14T22:13:20Z on, without the rows in `lost`.
  void write_telemetry(int rows, int lost_from = 0, int lost_to = 0) const {
    std::string text = "unix_s,bus_u_mv,bus_i_ma,mode\n";
    for (int row = 0; row < rows; ++row)
      if (row < lost_from || row >= lost_to)
        text += fmt::format("{},{},{},{}\n", 1'700'000'000 + row, 28000 + row % 7 * 25,
                            1400 + row % 13, row / 1000);
    write("t.csv", text);
  }
  std::string text_of(const std::string& name) const {
    std::stringstream text;
    text << std::ifstream(folder() / name, std::ios::binary).rdbuf();
    return text.str();
  }
  std::vector<std::string> import_of(const std::string& file, const std::string& database) const {
    return {"import", file, "--db", database, "--spacecraft", "SAT-1"};
  }
  /// Runs an import and kills it after a while; whether it had to be killed.
  bool kill_import(std::chrono::microseconds after) const {
    const pid_t child = fork();
    if (child == 0) {
      const int nowhere = open("/dev/null", O_WRONLY);
      dup2(nowhere, STDOUT_FILENO);
      if (chdir(folder().c_str()) == 0)
        execl(REIDENT_PROGRAM, "reident", "import", "t.csv", "--db", "killed.db", "--spacecraft",
              "SAT-1", nullptr);
      _exit(127);
    }
    const auto moment = std::chrono::steady_clock::now() + after;
    while (std::chrono::steady_clock::now() < moment) {
    }
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status);
  }
};

TEST_F(Transfer, AFileIsImportedAndExportedAsItWas) {
  write_telemetry(5000);
  const json counts = json_of(import_of("t.csv", "a.db"));
  EXPECT_EQ(counts["rows"], 5000);
  EXPECT_EQ(counts["stored"], 15000);
  EXPECT_EQ(counts["new_parameters"], 3);
  const test::Ran again = reident(import_of("t.csv", "a.db"));
  EXPECT_THAT(again.out, AllOf(HasSubstr("15000 samples in 5000 rows: 0 stored, 15000 there"),
                               HasSubstr("all of it was in the archive already")));
  const test::Ran exported = reident({"export", "a.db", "-o", "long.csv"});
  EXPECT_EQ(exported.status, 0) << exported.err;
  EXPECT_EQ(exported.out, "long.csv: 15000 samples of 3 series in 15000 rows\n");
  EXPECT_EQ(reident({"import", "long.csv", "--db", "b.db"}).status, 0);
  EXPECT_EQ(reident({"export", "b.db"}).out, text_of("long.csv"));
  EXPECT_THAT(refusal_of({"export", "a.db", "-o", "long.csv"}),
              HasSubstr("long.csv exists; name another file, or replace it with --replace"));
  EXPECT_EQ(reident({"export", "a.db", "-o", "long.csv", "--replace"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder() / "long.csv.part"));
  const test::Ran wide = reident({"export", "a.db", "--wide", "--parameter", "mode", "bus_u",
                                  "--from", "1700000003", "--to", "1700000005"});
  EXPECT_EQ(wide.out,
            "time,mode,bus_u\n2023-11-14T22:13:23Z,0,28075\n2023-11-14T22:13:24Z,0,28100\n");
}

TEST_F(Transfer, KilledAtAnyMomentAnImportGoesOnToTheSameContents) {
  write_telemetry(200'000);
  ASSERT_EQ(reident(import_of("t.csv", "whole.db")).status, 0);
  const std::string whole = reident({"export", "whole.db", "--wide"}).out;
  std::mt19937 random(17);
  int killed = 0;
  for (int trial = 0; trial < 12; ++trial)
    killed += kill_import(std::chrono::microseconds(1000 + random() % 120'000)) ? 1 : 0;
  const json last = json_of(import_of("t.csv", "killed.db"));
  EXPECT_GT(killed, 0);
  EXPECT_EQ(last["complete"], true);
  EXPECT_EQ(reident({"export", "killed.db", "--wide"}).out, whole);
}

TEST_F(Transfer, AMistakeNamesFileLineAndRemedyAndCanBePassedOver) {
  write("t.csv", "unix_s,u\n1700000000,1\n1700000001,off\n1700000002,3\n");
  EXPECT_THAT(refusal_of(import_of("t.csv", "a.db")),
              StartsWith("reident: t.csv:3: 'off' in column 'u' is no number; mend it, say with "
                         "--missing"));
  auto command = import_of("t.csv", "a.db");
  command.push_back("--skip-bad-lines");
  const test::Ran ran = reident(command);
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("1 bad lines left out"));
  EXPECT_THAT(ran.err, HasSubstr("reident: left out: t.csv:3: 'off'"));
}

TEST_F(Transfer, RequestsThatCannotBeMetAreRefused) {
  write_telemetry(10);
  EXPECT_THAT(refusal_of({"import", "t.csv", "--db", "a.db"}), HasSubstr("--spacecraft"));
  EXPECT_THAT(refusal_of(import_of("none.csv", "a.db")), HasSubstr("there is no such file"));
  EXPECT_THAT(refusal_of(import_of("t.csv", ".")), HasSubstr("is a folder"));
  EXPECT_THAT(refusal_of({"import", "t.csv", "--db", "a.db", "--map", "x"}), HasSubstr("COLUMN="));
  EXPECT_THAT(refusal_of({"export", "none.db"}), HasSubstr("does not exist"));
  reident(import_of("t.csv", "a.db"));
  EXPECT_THAT(refusal_of({"export", "a.db", "--from", "noon"}), HasSubstr("is no time"));
  EXPECT_THAT(refusal_of({"export", "a.db", "--parameter", "x"}),
              HasSubstr("no parameter 'x'; it has bus_i, bus_u, mode"));
  EXPECT_THAT(refusal_of({"completeness", "a.db", "--spacecraft", "SAT-2"}), HasSubstr("SAT-1"));
  EXPECT_THAT(refusal_of({"completeness", "a.db", "--equipment", "EPS"}), HasSubstr("--config"));
}

TEST_F(Transfer, WhileAnotherProgramWritesAnImportIsRefusedAndAnExportWorks) {
  write_telemetry(10);
  reident(import_of("t.csv", "a.db"));
  const storage::Database writer(folder() / "a.db", storage::Database::Mode::read_write);
  EXPECT_THAT(refusal_of(import_of("t.csv", "a.db")), HasSubstr("a.db"));
  EXPECT_EQ(reident({"export", "a.db"}).status, 0);
  EXPECT_EQ(reident({"completeness", "a.db"}).status, 0);
}

TEST_F(Transfer, AnOutputThatCannotBeWrittenIsAClearError) {
  write_telemetry(20'000);
  reident(import_of("t.csv", "a.db"));
  const auto shell = [&](const std::string& command) {
    return system(fmt::format("cd {} && ({}) 2> err.txt", folder().string(), command).c_str());
  };
  EXPECT_NE(shell(REIDENT_PROGRAM " export a.db > /dev/full"), 0);
  EXPECT_THAT(text_of("err.txt"), HasSubstr("standard output cannot be written, there is no room"));
  shell("(" REIDENT_PROGRAM " export a.db; echo status $? >&2) | head -1 > first.txt");
  EXPECT_THAT(text_of("err.txt"),
              AllOf(HasSubstr("the reader of the output went away"), HasSubstr("status 1")));
  EXPECT_NE(shell("ulimit -f 100; trap '' XFSZ; " REIDENT_PROGRAM " export a.db -o e.csv"), 0);
  EXPECT_THAT(text_of("err.txt"), HasSubstr("e.csv cannot be written, there is no room"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "e.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "e.csv.part"));
}

TEST_F(Transfer, CompletenessShowsEachDayWithItsBar) {
  write_telemetry(20'000, 7'000, 10'000);  // from 22:13:20 on; 0:10:00 to 1:00:00 is lost
  reident(import_of("t.csv", "a.db"));
  const test::Ran ran = reident({"completeness", "a.db", "--parameters"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out, StartsWith("SAT-1 (real), 3 parameters, samples by day (UTC)\n"));
  EXPECT_THAT(ran.out,
              HasSubstr("2023-11-14  19200     19200  100.00  ####################     0"));
  EXPECT_THAT(ran.out, HasSubstr("2023-11-15  31800     40800   77.94  ###############.....     1"
                                 "    50min"));
  EXPECT_THAT(ran.out, HasSubstr("\nmode       17000     20000  85.00  #################..."));
  const json object = json_of({"completeness", "a.db", "--by", "hour", "--parameter", "mode"});
  const json& hours = object["telemetry"][0]["bins"];
  ASSERT_THAT(hours, SizeIs(6));
  EXPECT_EQ(hours[2]["begin"], "2023-11-15T00:00:00Z");
  EXPECT_EQ(hours[2]["came"], 600);
  EXPECT_EQ(hours[2]["expected"], 3600);
  EXPECT_EQ(hours[2]["percent"], 16.66);
  EXPECT_EQ(hours[2]["gaps"], 1);
  EXPECT_EQ(hours[2]["longest_gap_s"], 3001);
  EXPECT_EQ(hours[3]["percent"], 100);
}

TEST_F(Transfer, CompletenessSaysWhatLiesFarFromTheRest) {
  write_telemetry(5000);
  write("wrong.csv", "unix_s,u\n338418,1\n338419,2\n");
  reident(import_of("t.csv", "a.db"));
  auto wrong = import_of("wrong.csv", "a.db");
  wrong.emplace_back("--force-times");
  ASSERT_EQ(reident(wrong).status, 0);
  const json far = json_of({"completeness", "a.db"})["telemetry"][0]["far_from_the_rest"];
  ASSERT_THAT(far, SizeIs(1));
  EXPECT_EQ(far[0]["samples"], 2);
  EXPECT_EQ(far[0]["begin"], "1970-01-04T22:00:18Z");
  EXPECT_THAT(reident({"completeness", "a.db"}).out, HasSubstr("2 samples from 1970-01-04"));
}

TEST_F(Transfer, CompletenessCountsFramesAndKnowsTheParametersOfAnEquipment) {
  {
    storage::Database database(folder() / "a.db", storage::Database::Mode::read_write);
    storage::Archive archive(database);
    archive.describe({{descriptor("SAT-1", 1, "u", ""), descriptor("SAT-1", 2, "y", ""),
                       descriptor("SAT-1", 3, "z", "")}});
    std::vector<storage::TelemetryFrame> frames;
    for (std::uint64_t i = 0; i < 100; ++i) {
      if (i >= 40 && i < 50) continue;
      const storage::Time time =
          1'700'000'000'000'000'000 + static_cast<std::int64_t>(i) * 1'000'000'000;
      frames.push_back({"SAT-1",
                        "gs",
                        storage::Origin::real,
                        i,
                        time,
                        time,
                        {{1, storage::Quality::good, 1}, {2, storage::Quality::good, 2}}});
    }
    frames.back().samples.push_back({3, storage::Quality::good, 3});
    archive.append(frames);
  }
  write("reident.toml",
        "[[spacecraft]]\nname = \"SAT-1\"\n[[spacecraft.equipment]]\nname = \"EPS\"\n"
        "inputs = [\"u\"]\noutputs = [\"y\"]\nsample_period = \"1s\"\nwindow = \"1h\"\n");
  const json all = json_of({"completeness", "a.db", "--equipment", "EPS", "--parameters"});
  const json& telemetry = all["telemetry"][0];
  EXPECT_EQ(telemetry["bins"][0]["frames_missing"], 10);
  EXPECT_EQ(telemetry["bins"][0]["came"], 180);
  EXPECT_EQ(telemetry["bins"][0]["expected"], 200);
  EXPECT_THAT(telemetry["parameters"], SizeIs(2));
  EXPECT_THAT(refusal_of({"completeness", "a.db", "--equipment", "TTC"}), HasSubstr("SAT-1/EPS"));
}

}  // namespace
}  // namespace reident::cli::transfer_test
