// Operators' commands and `at` on a database that no service holds.
#include <unistd.h>

#include "storage/registry/registry.hpp"
#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::operators_test {
namespace {

using nlohmann::json;
using storage::DecisionKind;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::SizeIs;

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t start = 1'700'000'000 * second;  // 2023-11-14T22:13:20Z

class OperatorCommands : public test::CliTest {
 protected:
  /// BDR: version 1 superseded, 2 champion, 3 and 4 wait.
  OperatorCommands() {
    storage::Database database(path(), storage::Database::Mode::read_write);
    storage::Registry registry(database);
    for (const DecisionKind kind :
         {DecisionKind::approve, DecisionKind::approve, DecisionKind::wait, DecisionKind::wait}) {
      storage::NewAttempt attempt;
      attempt.spacecraft = "CBERS-4";
      attempt.equipment = "BDR";
      attempt.time = next_ += 10 * second;
      attempt.outcome = "approved";
      attempt.reason = "Good.";
      registry.record(attempt, {"{}", "digest", R"({"rows":3})", "5a"}, {kind, "gate", "Good."});
    }
  }
  std::filesystem::path path() const { return folder() / "reident.db"; }
  static std::vector<std::string> on_file(std::vector<std::string> words) {
    words.insert(words.end(), {"--database", "reident.db", "--actor", "Ana"});
    return words;
  }
  std::string status_of(std::int64_t version) const {
    storage::Database database(path(), storage::Database::Mode::read_only);
    return storage::Registry(database).version("CBERS-4", "BDR", version)->status;
  }

 private:
  std::int64_t next_ = start - 10 * second;
};

TEST_F(OperatorCommands, AreCarriedOutOnTheFileAndSaySo) {
  const test::Ran ran = reident(on_file({"approve", "BDR", "3", "--reason", "seen"}));
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out,
            "version 3 of CBERS-4/BDR is approved and champion now, after version 2 (no service "
            "runs: done in its database)\n");
  EXPECT_EQ(status_of(3), "approved");
}

TEST_F(OperatorCommands, InJsonSayWhatWasAskedAndAnswered) {
  const json answer = json_of(on_file({"reject", "CBERS-4/BDR", "3", "--reason", "heater test"}));
  EXPECT_EQ(answer["ok"], true);
  EXPECT_EQ(answer["reply"], "version 3 of CBERS-4/BDR is rejected");
  EXPECT_EQ(answer["by"], "file");
  EXPECT_EQ(answer["action"], "reject");
  EXPECT_EQ(answer["version"], 3);
  EXPECT_EQ(answer["actor"], "Ana");
  EXPECT_EQ(answer["reason"], "heater test");
}

TEST_F(OperatorCommands, ThatAreRefusedExitWithTheReason) {
  EXPECT_THAT(refusal_of(on_file({"approve", "BDR", "2", "--reason", "x"})),
              HasSubstr("version 2 of CBERS-4/BDR is not waiting: it is the champion, approved by "
                        "gate at 2023-11-14T22:13:30Z"));
  EXPECT_THAT(refusal_of(on_file({"hold", "MEA"})), HasSubstr("known: CBERS-4/BDR"));
  EXPECT_THAT(refusal_of(on_file({"hold", "BDR@1"})), HasSubstr("about the equipment alone"));
  EXPECT_THAT(refusal_of(on_file({"approve", "BDR", "--reason", "x"})),
              HasSubstr("write BDR@NUMBER"));
  EXPECT_THAT(refusal_of(on_file({"approve", "BDR@3", "4", "--reason", "x"})),
              HasSubstr("two versions"));
  EXPECT_THAT(refusal_of({"hold", "BDR", "--database", "reident.db", "--actor", ""}),
              HasSubstr("the operator's name is empty"));
  for (const char* command : {"approve", "reject", "withdraw"}) {
    EXPECT_THAT(refusal_of(on_file({command, "BDR", "3"})), HasSubstr("--reason is required"));
    EXPECT_THAT(refusal_of(on_file({command, "BDR", "0", "--reason", "x"})), HasSubstr("version"));
  }
  const test::Ran ran = reident(on_file({"release", "BDR", "--json"}));
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(json::parse(ran.out)["reply"], "CBERS-4/BDR is not held");
}

TEST_F(OperatorCommands, NameAVersionAsEveryCommandDoes) {
  EXPECT_EQ(json_of(on_file({"approve", "CBERS-4/BDR@3", "--reason", "seen"}))["version"], 3);
  EXPECT_EQ(json_of(on_file({"rollback", "BDR@2"}))["version"], 2);
  EXPECT_EQ(status_of(2), "approved");
}

TEST_F(OperatorCommands, TheActorIsTheLoginNameUnlessNamed) {
  const json answer = json_of({"hold", "BDR", "--database", "reident.db"});
  EXPECT_THAT(answer["actor"].get<std::string>(), Not(IsEmpty()));
}

TEST_F(OperatorCommands, ARollbackNamesTheVersionThatItFound) {
  const json answer = json_of(on_file({"rollback", "BDR"}));
  EXPECT_EQ(answer["version"], 1);
  EXPECT_THAT(refusal_of(on_file({"rollback", "BDR"})), HasSubstr("follows no champion"));
  EXPECT_EQ(json_of(on_file({"rollback", "BDR", "--to", "2"}))["version"], 2);
}

TEST_F(OperatorCommands, WithoutAServiceBehindTheLockTheyTimeOutAndNothingIsDone) {
  const storage::Database holder(path(), storage::Database::Mode::read_write);
  const test::Ran ran =
      reident(on_file({"hold", "BDR", "--timeout", "0.2", "--domain",
                       std::to_string(1 + getpid() % 200), "--partition", "nobody"}));
  EXPECT_EQ(ran.status, 4);
  EXPECT_THAT(ran.err, AllOf(HasSubstr("no service answered on domain"), HasSubstr("nobody"),
                             HasSubstr("in use by process " + std::to_string(getpid())),
                             Not(HasSubstr("stop it"))));
}

TEST_F(OperatorCommands, NeedAPlaceToGo) {
  EXPECT_THAT(refusal_of({"hold", "BDR"}), HasSubstr("--config FILE"));
  write("text.db", "this is no database, but it is long enough to look like one to a hasty reader");
  EXPECT_THAT(refusal_of({"hold", "BDR", "--database", "text.db"}), HasSubstr("text.db"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "none.db"));
}

TEST_F(OperatorCommands, HistoryAndShowTellWhatWasDecided) {
  reident(on_file({"withdraw", "BDR", "2", "--reason", "wrong sensor"}));
  reident(on_file({"hold", "BDR", "--reason", "training"}));
  const test::Ran history = reident({"history", "--long", "--database", "reident.db"});
  EXPECT_THAT(history.out, HasSubstr("  2x  "));
  EXPECT_THAT(history.out, HasSubstr("approved: Good. Then withdrawn by Ana at 2"));
  EXPECT_THAT(history.out, HasSubstr("rolled back to by Ana at 2"));
  EXPECT_THAT(history.out, HasSubstr("(version 2 was withdrawn: wrong sensor)."));
  EXPECT_THAT(history.out, HasSubstr("* champion: what simulators run now; x withdrawn\n"
                                     "CBERS-4/BDR is held by Ana since 2"));
  const json attempts = json_of({"history", "--database", "reident.db"});
  EXPECT_EQ(attempts["attempts"][1]["status"], "withdrawn");
  EXPECT_EQ(attempts["attempts"][1]["parent"], 1);
  EXPECT_EQ(attempts["attempts"][0]["decisions"][1]["kind"], "roll_back");
  EXPECT_EQ(attempts["holds"][0]["hold"]["reason"], "training");
}

TEST_F(OperatorCommands, AtTellsTheChampionOfATimeAndWhoDecidedSo) {
  reident(on_file({"rollback", "BDR", "--reason", "odd"}));
  const auto at = [&](const std::string& time) {
    return json_of({"at", time, "BDR", "--database", "reident.db"})["equipment"][0]["champion"];
  };
  EXPECT_TRUE(at("2023-11-14T22:13:19.999999999Z").is_null());
  EXPECT_EQ(at("2023-11-14T22:13:20Z")["version"], 1);
  const json before =
      json_of({"at", "2020-01-01", "--database", "reident.db"})["equipment"][0]["first"];
  EXPECT_EQ(before["version"], 1);
  EXPECT_EQ(before["since"], "2023-11-14T22:13:20Z") << "when the first was decided";
  EXPECT_EQ(at("1700000010")["version"], 2);
  EXPECT_EQ(at("1700000010")["since"], "2023-11-14T22:13:30Z");
  EXPECT_EQ(at("1700000010")["actor"], "gate");
  EXPECT_EQ(at("2200-01-01")["version"], 1);
  EXPECT_EQ(at("2200-01-01")["kind"], "roll_back");
  EXPECT_EQ(at("2200-01-01")["reason"], "odd");
  const test::Ran table = reident({"at", "1700000010", "--database", "reident.db"});
  EXPECT_THAT(table.out, HasSubstr("CBERS-4/BDR        2  2023-11-14T22:13:30Z  gate  approved: "
                                   "Good.\n"));
  EXPECT_EQ(at("now")["version"], 1);
  EXPECT_EQ(at("-2h")["version"], 2) << "before the rollback";
  EXPECT_THAT(refusal_of({"at", "yesterday", "--database", "reident.db"}),
              HasSubstr("yesterday is no time"));
  EXPECT_THAT(refusal_of({"at", "0", "MEA", "--database", "reident.db"}),
              HasSubstr("nothing is known about MEA; the database has CBERS-4/BDR"));
}

}  // namespace
}  // namespace reident::cli::operators_test
