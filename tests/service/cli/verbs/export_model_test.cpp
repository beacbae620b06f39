// export-model on a database that the registry filled.
#include <algorithm>
#include <csignal>

#include <sys/resource.h>

#include "storage/registry/registry.hpp"
#include "tests/service/cli/cli_fixture.hpp"
#include "tests/service/model/example_model.hpp"

namespace reident::cli::export_model_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class ExportModel : public test::CliTest {
 protected:
  ExportModel() {
    storage::Database database(folder() / "reident.db", storage::Database::Mode::read_write);
    storage::Registry registry(database);
    const EquipmentModel model = reident::test::full_example_model();
    EquipmentModel damaged = model;
    damaged.dynamics.A(0, 0) = 0.8;
    for (const EquipmentModel& stored : {model, damaged}) {
      storage::NewAttempt attempt;
      attempt.spacecraft = model.spacecraft;
      attempt.equipment = model.equipment;
      attempt.window = {0, 7'000};
      attempt.time = 1'700'000'000'000'000'000;
      attempt.outcome = "approved";
      attempt.evidence_json = "{}";
      attempt.program_version = "0.1.0";
      registry.record(attempt, {to_json(stored).dump(), model_digest(model)},
                      {storage::DecisionKind::approve, "ana", "Good."});
    }
  }

  std::vector<std::string> command(const std::string& subject,
                                   std::vector<std::string> words) const {
    words.insert(words.begin(), {"export-model", subject, "--database", "reident.db"});
    return words;
  }
  void expect_failure(const test::Ran& ran, const std::string& says) const {
    EXPECT_EQ(ran.status, 1);
    EXPECT_THAT(ran.err, StartsWith("reident: " + says));
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    for (const char* name : {"a.fmu", "a.fmu.part", "a.mat", "a.mat.part"})
      EXPECT_FALSE(exists(name)) << name;
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder() / name); }
};

TEST_F(ExportModel, WritesAllFilesAtOnceAndSaysWhat) {
  const test::Ran ran =
      reident(command("BDR@1", {"--fmu", "a.fmu", "--mat", "a.mat", "--json", "a.json"}));
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(
      ran.out,
      "a.fmu: FMU (FMI 2.0) of CBERS4/BDR version 1\na.mat: MATLAB file of CBERS4/BDR version 1\n"
      "a.json: JSON of CBERS4/BDR version 1\n");
  for (const char* name : {"a.fmu", "a.mat", "a.json"}) EXPECT_TRUE(exists(name)) << name;
  const test::Ran again = reident(command("CBERS4/BDR@1", {"--json", "a.json", "--force"}));
  EXPECT_EQ(again.status, 0) << again.err;
}

TEST_F(ExportModel, PrintsJsonWithTheDecision) {
  const test::Ran ran = reident(command("BDR@1", {"--json", "-"}));
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto object = nlohmann::json::parse(ran.out);
  EXPECT_EQ(object["version"], 1);
  EXPECT_EQ(object["status"], "superseded");
  EXPECT_EQ(object["decided_by"], "ana");
  EXPECT_EQ(object["model"]["inputs"][1]["expression"], "V_BUS * I_BDRIN2");
}

TEST_F(ExportModel, RefusesWhatCannotBeWritten) {
  write("old.mat", "kept");
  EXPECT_THAT(refusal_of(command("BDR@1", {})), HasSubstr("nothing to write; name a file with"));
  EXPECT_THAT(refusal_of(command("BDR@1", {"--mat", "old.mat", "--fmu", "new.fmu"})),
              HasSubstr("old.mat exists; name another file, or replace it with --replace"));
  EXPECT_FALSE(exists("new.fmu"));
  EXPECT_THAT(refusal_of(command("BDR@1", {"--mat", "x", "--json", "x"})),
              HasSubstr("x is named twice"));
  EXPECT_THAT(refusal_of(command("BDR@1", {"--fmu", "-"})),
              HasSubstr("the FMU (FMI 2.0) cannot go to standard output"));
  EXPECT_THAT(refusal_of(command("BDR@9", {"--fmu", "a.fmu"})),
              HasSubstr("CBERS4/BDR has no version 9; versions: 1 (superseded), 2 (approved)"));
  EXPECT_THAT(refusal_of(command("BDR", {"--fmu", "a.fmu"})),
              HasSubstr("CBERS4/BDR version 2 cannot be exported: its stored model does not match "
                        "its digest"));
  EXPECT_FALSE(exists("a.fmu"));
}

TEST_F(ExportModel, LeavesNothingBehindWhereAFileCannotBeWritten) {
  for (const char* path : {"nowhere/a.mat", "/dev/full"}) {
    const test::Ran ran = reident(command("BDR@1", {"--fmu", "a.fmu", "--mat", path, "--force"}));
    expect_failure(ran, path);
  }
}

TEST_F(ExportModel, LeavesNothingBehindOnAFullDisk) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit less_than_an_fmu{36'000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &less_than_an_fmu);
  const test::Ran ran = reident(command("BDR@1", {"--mat", "a.mat", "--fmu", "a.fmu"}));
  setrlimit(RLIMIT_FSIZE, &before);
  expect_failure(ran, "a.fmu cannot be written, there is no room");
}

}  // namespace
}  // namespace reident::cli::export_model_test
