// history and show on a database that the registry filled.
#include <array>

#include <fmt/format.h>

#include "service/model/model_json.hpp"
#include "service/support/terminal.hpp"
#include "storage/registry/registry.hpp"
#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::stored_test {
namespace {

using nlohmann::json;
using storage::DecisionKind;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr std::int64_t minute = 60'000'000'000;
constexpr std::int64_t start = 1'700'000'000'000'000'000;  // 2023-11-14T22:13:20Z

EquipmentModel model_of(const std::string& equipment) {
  EquipmentModel model;
  model.spacecraft = "CBERS-4";
  model.equipment = equipment;
  model.inputs = {{"I_BDRIN1", "A", 0, 7.5}, {"I_BDRIN2", "A", 0.25, 8}};
  model.outputs = {{"I_BDROUT", "A", -1, 12}};
  auto& dynamics = model.dynamics;
  dynamics.A = Eigen::Matrix2d{{0.9, 0.1}, {-0.1, 0.9}};
  dynamics.B = Eigen::Matrix2d{{1, 2}, {3, 4}};
  dynamics.C = Eigen::RowVector2d(1, 0);
  dynamics.D = Eigen::RowVector2d(0, 0.5);
  dynamics.u0 = Eigen::Vector2d(3, 4);
  dynamics.y0 = Eigen::VectorXd::Constant(1, 5);
  dynamics.period_s = 1;
  model.sample_hold_ns = 3'000'000'000;
  model.identified_from = {start, start + 70 * minute};
  model.validated_on = {start + 70 * minute, start + 100 * minute};
  model.validation = {Eigen::VectorXd::Constant(1, 2.5), Eigen::VectorXd::Constant(1, 91.25), 1800};
  model.method = "n4sid, horizon 12, order 2";
  return model;
}

storage::NewAttempt attempt_of(const std::string& equipment, int slide, const std::string& outcome,
                               const std::string& evidence) {
  storage::NewAttempt attempt;
  attempt.spacecraft = "CBERS-4";
  attempt.equipment = equipment;
  attempt.window = {start + slide * minute, start + (100 + slide) * minute};
  attempt.trigger = "slide";
  attempt.time = attempt.window.end + minute;
  attempt.outcome = outcome;
  attempt.reason = "The reason of " + outcome + ".";
  attempt.evidence_json = evidence;
  attempt.configuration_digest = "c0ffee";
  attempt.program_version = "0.1.0";
  return attempt;
}

class Stored : public test::CliTest {
 protected:
  Stored() : registry_(database_) {}

  void record_version(const std::string& equipment, int slide, DecisionKind kind,
                      const std::string& outcome) {
    const EquipmentModel model = model_of(equipment);
    registry_.record(
        attempt_of(equipment, slide, outcome,
                   R"({"order": 2, "mrse_percent": 2.5, "fit_percent": 91.25, "coverage": 1,)"
                   R"( "champion": {"version": 1, "mrse_percent": 3.75}})"),
        {to_json(model).dump(), model_digest(model)}, {kind, "gate", "The reason of the gate."});
  }
  /// BDR: no model, version 1 superseded, 2 rejected, 3 champion; MEA: version 1 waits.
  void fill() {
    registry_.record(attempt_of("BDR", 0, "too_few_samples", "{}"));
    record_version("BDR", 30, DecisionKind::approve, "approved");
    record_version("BDR", 60, DecisionKind::reject, "error_above_limit");
    record_version("BDR", 90, DecisionKind::approve, "approved");
    record_version("MEA", 30, DecisionKind::wait, "waiting");
  }

  storage::Database database_{folder() / "reident.db", storage::Database::Mode::read_write};
  storage::Registry registry_;
  const std::vector<std::string> from_ = {"--database", "reident.db"};
  std::vector<std::string> command(std::vector<std::string> words) const {
    words.insert(words.end(), from_.begin(), from_.end());
    return words;
  }
};

TEST_F(Stored, HistoryHasALineForEachWindowWithTheVerdictInWords) {
  fill();
  const test::Ran ran = reident(command({"history"}));
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out, AllOf(HasSubstr("CBERS-4/BDR  2023-11-14T23:53         -       -  too few "
                                       "samples\n"),
                             HasSubstr("        1     2.5  was champion\n"),
                             HasSubstr("        2     2.5  rejected: error above the limit\n"),
                             HasSubstr("       3*     2.5  champion now\n"),
                             HasSubstr("CBERS-4/MEA  2023-11-15T00:23         1     2.5  ")));
}

TEST_F(Stored, HistoryShowsTheLastTwentyUnlessAllAreAskedFor) {
  for (int slide = 0; slide < 25; ++slide)
    registry_.record(attempt_of("BDR", slide, "unstable", "{}"));
  const auto lines = [&](std::vector<std::string> words) {
    const std::string out = reident(command(std::move(words))).out;
    return std::count(out.begin(), out.end(), '\n');
  };
  EXPECT_EQ(lines({"history"}), 1 + 20 + 2);
  EXPECT_EQ(lines({"history", "--all"}), 1 + 25 + 1);
  EXPECT_EQ(lines({"history", "--last", "3"}), 1 + 3 + 1);
  EXPECT_EQ(lines({"history", "--csv"}), 1 + 25);
  EXPECT_THAT(json_of(command({"history"}))["attempts"], SizeIs(25));
}

TEST_F(Stored, HistoryCanBeAskedForAnOutcomeAndATime) {
  fill();
  const auto attempts = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "history");
    return json_of(command(std::move(words)))["attempts"].size();
  };
  EXPECT_EQ(attempts({"--outcome", "error_above_limit"}), 1U);
  EXPECT_EQ(attempts({"--from", "2023-11-15T01:00"}), 1U);
  EXPECT_EQ(attempts({"--to", "2023-11-14T22:30"}), 1U);
  EXPECT_THAT(refusal_of(command({"history", "--outcome", "unstabel"})),
              HasSubstr("(did you mean unstable?)"));
  EXPECT_THAT(refusal_of(command({"history", "--outcome", "unstable", "--equipment", "BDR"})),
              HasSubstr("with this outcome"));
}

TEST_F(Stored, HistoryAsCsvHasARowForEachWindow) {
  auto odd = attempt_of("BDR", 0, "too_few_samples", "{}");
  odd.reason = "He said \"no\", twice.";
  registry_.record(odd);
  EXPECT_THAT(reident(command({"history", "--csv"})).out,
              HasSubstr("\n1,\"CBERS-4\",\"BDR\",2023-11-14T22:13:20Z,2023-11-14T23:53:20Z,"
                        "2023-11-14T23:54:20Z,too_few_samples,,,,,,\"too few samples\",\"He said "
                        "\"\"no\"\", twice.\"\n"));
}

TEST_F(Stored, HistoryTellsTheReasonsWhereTheyAreAskedFor) {
  fill();
  const test::Ran ran = reident(command({"history", "--long"}));
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("CBERS-4/BDR  2023-11-14T22:13:20Z  100min        -      -       "
                                 "-      -  too_few_samples: The reason of too_few_samples.\n"));
  EXPECT_THAT(ran.out, HasSubstr("2023-11-14T23:43:20Z  100min       3*      2     2.5  91.25  "
                                 "approved: "));
  EXPECT_THAT(ran.out, HasSubstr("        1      2     2.5  91.25  approved: "))
      << "a superseded version has no mark";
}

TEST_F(Stored, HistoryInJsonHasTheEvidence) {
  fill();
  const json attempts = json_of(command({"history"}))["attempts"];
  ASSERT_THAT(attempts, SizeIs(5));
  EXPECT_TRUE(attempts[0]["version"].is_null());
  EXPECT_TRUE(attempts[0]["mrse_percent"].is_null());
  EXPECT_EQ(attempts[0]["outcome"], "too_few_samples");
  EXPECT_EQ(attempts[1]["champion"], false);
  EXPECT_EQ(attempts[3]["champion"], true);
  EXPECT_EQ(attempts[3]["version"], 3);
  EXPECT_EQ(attempts[3]["mrse_percent"], 2.5);
  EXPECT_EQ(attempts[3]["evidence"]["champion"]["version"], 1);
  EXPECT_EQ(attempts[3]["window"]["begin"], "2023-11-14T23:43:20Z");
  EXPECT_EQ(attempts[3]["configuration_digest"], "c0ffee");
}

TEST_F(Stored, HistoryCanBeFiltered) {
  fill();
  EXPECT_THAT(json_of(command({"history", "--equipment", "MEA"}))["attempts"], SizeIs(1));
  EXPECT_THAT(json_of(command({"history", "--equipment", "CBERS-4/MEA"}))["attempts"], SizeIs(1));
  EXPECT_THAT(refusal_of(command({"history", "--equipment", "ISS/MEA"})),
              HasSubstr("no attempt of ISS/MEA; "));
  EXPECT_THAT(json_of(command({"history", "--spacecraft", "CBERS-4"}))["attempts"], SizeIs(5));
  EXPECT_THAT(json_of(command({"history", "--versions-only"}))["attempts"], SizeIs(4));
  const json last = json_of(command({"history", "--equipment", "BDR", "--last", "2"}))["attempts"];
  ASSERT_THAT(last, SizeIs(2));
  EXPECT_EQ(last[0]["version"], 2);
  EXPECT_EQ(last[1]["version"], 3);
}

TEST_F(Stored, HistoryIsReadBesideTheOneWhoWrites) {
  fill();
  EXPECT_THAT(json_of(command({"history"}))["attempts"], SizeIs(5));
  record_version("MEA", 60, DecisionKind::wait, "waiting");
  EXPECT_THAT(json_of(command({"history"}))["attempts"], SizeIs(6));
}

TEST_F(Stored, AnEmptyHistorySaysSo) {
  EXPECT_THAT(refusal_of(command({"history"})), HasSubstr("no window has been tried yet"));
  EXPECT_THAT(json_of(command({"history"}))["attempts"], IsEmpty());
}

TEST_F(Stored, AnUnknownEquipmentIsAnsweredWithWhatExists) {
  fill();
  EXPECT_THAT(refusal_of(command({"history", "--equipment", "BAT1"})),
              HasSubstr("no attempt of (any)/BAT1; the database has CBERS-4/BDR, CBERS-4/MEA"));
  EXPECT_THAT(refusal_of(command({"show", "CBERS-4/BAT1"})), HasSubstr("CBERS-4/BDR, CBERS-4/MEA"));
  EXPECT_THAT(refusal_of(command({"show", "ISS/BDR"})), HasSubstr("CBERS-4/BDR, CBERS-4/MEA"));
}

TEST_F(Stored, ShowTellsTheWholeStoryOfTheChampion) {
  fill();
  const test::Ran ran = reident(command({"show", "CBERS-4/BDR"}));
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out,
              AllOf(HasSubstr("CBERS-4/BDR version 3: approved"),
                    HasSubstr("2023-11-14T23:43:20Z to 2023-11-15T01:23:20Z (100min)"),
                    HasSubstr("n4sid, horizon 12, order 2"), HasSubstr("0.9 ± 0.1j"),
                    HasSubstr("I_BDRIN2  input   A       0.25        8"),
                    HasSubstr("I_BDROUT     2.5  91.25"),
                    HasSubstr("version 1, on the same rows: MRSE 3.75 %"),
                    HasSubstr("approved  gate  The reason of the gate."),
                    HasSubstr(model_digest(model_of("BDR"))), HasSubstr("K = (none)"),
                    HasSubstr("continuous time: poles -0.0992"), HasSubstr("dx/dt = A x")));
  EXPECT_THAT(ran.out, Not(HasSubstr("DOES NOT MATCH")));
}

TEST_F(Stored, ShowInJsonHasTheModelAndTheDecisions) {
  fill();
  const json shown = json_of(command({"show", "BDR@2"}));
  EXPECT_EQ(shown["spacecraft"], "CBERS-4");
  EXPECT_EQ(shown["version"], 2);
  EXPECT_EQ(json_of(command({"show", "BDR", "2"})), shown);
  EXPECT_EQ(shown["status"], "rejected");
  EXPECT_EQ(shown["digest_matches"], true);
  EXPECT_EQ(shown["decisions"][0]["kind"], "reject");
  EXPECT_EQ(shown["model"]["A"][1][0], -0.1);
  EXPECT_EQ(shown["continuous"]["A"].size(), 2u);
  EXPECT_EQ(shown["model"]["inputs"][0]["name"], "I_BDRIN1");
}

TEST_F(Stored, ShowTellsWhenTheStoredModelWasChanged) {
  const EquipmentModel model = model_of("BDR");
  registry_.record(attempt_of("BDR", 0, "approved", "{}"), {to_json(model).dump(), "0123"},
                   {DecisionKind::approve, "gate", "Good."});
  EXPECT_THAT(reident(command({"show", "BDR"})).out, HasSubstr("DOES NOT MATCH the stored model"));
}

TEST_F(Stored, ShowRefusesWhatDoesNotExist) {
  fill();
  EXPECT_THAT(refusal_of(command({"show", "CBERS-4/BDR@9"})),
              HasSubstr("CBERS-4/BDR has no version 9; versions: 1 (superseded), 2 (rejected), 3 "
                        "(approved)"));
  EXPECT_THAT(refusal_of(command({"show", "CBERS-4/MEA"})),
              HasSubstr("has no approved version; versions: 1 (waiting)"));
  EXPECT_THAT(refusal_of(command({"show", "CBERS-4/BDR@last"})), HasSubstr("names no version"));
  EXPECT_THAT(refusal_of(command({"why", "CBERS-4/BDR@1", "2"})), HasSubstr("1 and 2"));
  EXPECT_THAT(refusal_of(command({"show", "CBERS-4/"})), HasSubstr("names no equipment"));
}

TEST_F(Stored, ShowAsksWhichSpacecraftWhereTwoHaveTheEquipment) {
  fill();
  auto other = attempt_of("BDR", 0, "too_few_samples", "{}");
  other.spacecraft = "AMAZONIA-1";
  registry_.record(other);
  EXPECT_THAT(refusal_of(command({"show", "BDR"})),
              AllOf(HasSubstr("name the spacecraft"), HasSubstr("AMAZONIA-1")));
}

TEST_F(Stored, OfManyVersionsARefusalNamesTheLast) {
  for (int slide = 0; slide < 8; ++slide)
    record_version("BDR", slide, DecisionKind::reject, "error_above_limit");
  EXPECT_THAT(refusal_of(command({"show", "BDR@9"})),
              EndsWith("versions: 1 to 8, the last of them 4 (rejected), 5 (rejected), 6 "
                       "(rejected), 7 (rejected), 8 (rejected)\n"));
}

TEST_F(Stored, WhyNamesAChampionThatFails) {
  record_version("BDR", 0, DecisionKind::approve, "challenger");
  constexpr int length = 15;  // minutes
  for (int i = 0; i < 60; ++i) {
    storage::Block block;
    const storage::Time begin = model_of("BDR").validated_on.begin + i * length * minute;
    block.range = {begin, begin + length * minute};
    block.rows = 900;
    block.believed = 1;
    block.output_mean = {10};
    block.output_square = {101};
    block.input_low = {0, 0};
    block.input_high = {1, 1};
    const double square = i % 3 == 0 ? 4.5 : 3;
    registry_.record_scores("CBERS-4", "BDR", block,
                            {{1, block.range.begin, 900, {0}, {square}, {1e-6}, {}, {}}});
  }
  const std::string why = json::parse(reident(command({"why", "BDR@1", "--json"})).out)["verdict"];
  EXPECT_THAT(why, HasSubstr(" 60 blocks"));
}

TEST_F(Stored, WhyTellsTheBaselineOfTheConfigurationAndTheChampionOfOlderPrograms) {
  const EquipmentModel model = model_of("BDR");
  const storage::NewVersion version{to_json(model).dump(), model_digest(model)};
  registry_.record(
      attempt_of("BDR", 0, "approved", R"({"mrse_percent": 2.5, "baseline_mrse_percent": 16.4})"),
      version, {DecisionKind::approve, "gate", "Good."});
  EXPECT_THAT(reident(command({"why", "BDR@1"})).out,
              AllOf(HasSubstr("The simulator's own model errs by 16.4 %, as the configuration"),
                    HasSubstr("At its window: approved. The reason of approved.\n")));
  record_version("BDR", 30, DecisionKind::approve, "approved");
  EXPECT_THAT(reident(command({"why", "BDR@2"})).out,
              HasSubstr("Champion 1 errs by 3.75 % on the same rows."));
}

TEST_F(Stored, WhyTellsWhichTelemetryWasNotBelieved) {
  const EquipmentModel model = model_of("BDR");
  const storage::NewVersion version{to_json(model).dump(), model_digest(model)};
  registry_.record(attempt_of("BDR", 0, "approved", R"({"implausible": {"stretches": 4, "longest": [
    {"check": "relation", "parameters": ["A", "B"], "begin_ns": 0, "end_ns": 60000000000,
     "relation": "node", "residual": 0.75, "tolerance": 0.5},
    {"check": "stuck", "parameters": ["C"], "begin_ns": 0, "end_ns": 50000000000},
    {"check": "spike", "parameters": ["C"], "begin_ns": 70000000000, "end_ns": 71000000000}],
    "not_applied": ["pair: telemetry has not described D"]}})"),
                   version, {DecisionKind::approve, "gate", "Good."});
  EXPECT_THAT(
      reident(command({"why", "BDR@1"})).out,
      AllOf(HasSubstr("Not believed, and left out: A, B from 1970-01-01T00:00:00Z to "
                      "1970-01-01T00:01:00Z, where relation node is 0.75 with a tolerance of 0.5."),
            HasSubstr("C (stuck) from 1970-01-01T00:00:00Z to 1970-01-01T00:00:50Z."),
            HasSubstr("C (spike) from 1970-01-01T00:01:10Z to 1970-01-01T00:01:11Z."),
            HasSubstr("Shorter stretches that were left out too: 1."),
            HasSubstr("A relation was not applied: pair: telemetry has not described D.")));
}

TEST_F(Stored, AVersionFromBeforeProvenanceCannotBeReproduced) {
  fill();
  EXPECT_THAT(refusal_of(command({"reproduce", "BDR@1"})),
              HasSubstr("CBERS-4/BDR version 1 cannot be identified again: it is from before "
                        "schema 2 and does not say where it comes from"));
}

TEST_F(Stored, WhatIsShownFitsIntoTheTerminal) {
  fill();
  registry_.decide("CBERS-4", "MEA", 1,
                   {DecisionKind::wait, "gate", std::string(300, 'x') + " and blanks behind it",
                    R"({"reasons":[{"code":"bias_unverified"}]})"},
                   start + 300 * minute);
  registry_.raise({"disk", {}, "The disk of " + std::string(90, '/') + " is full.", start});
  const std::vector<std::vector<std::string>> commands = {{"history"},
                                                          {"history", "--versions-only"},
                                                          {"show", "BDR"},
                                                          {"why", "BDR"},
                                                          {"why", "MEA@1"},
                                                          {"at", "now"},
                                                          {"waiting"},
                                                          {"overview"},
                                                          {"compare", "BDR", "2", "3"},
                                                          {"show", "BDR@9"},
                                                          {"reproduce", "BDR@1"},
                                                          {"completeness"}};
  for (const unsigned short columns : std::array<unsigned short, 3>{60, 80, 120})
    for (const auto& words : commands) {
      const auto lines = lines_on_terminal(command(words), columns);
      EXPECT_THAT(lines, Not(IsEmpty())) << words[0];
      for (const std::string& line : lines)
        EXPECT_LE(display_width(line), columns) << words[0] << ": " << line;
    }
}

class WithoutDatabase : public test::CliTest {};

TEST_F(WithoutDatabase, TheRemedyIsNamed) {
  EXPECT_THAT(refusal_of({"history"}), HasSubstr("--database FILE or --config FILE"));
  EXPECT_THAT(refusal_of({"history", "--database", "none.db"}), HasSubstr("does not exist"));
  EXPECT_THAT(refusal_of({"show", "A/B", "--config", "none.toml"}), HasSubstr("none.toml"));
  EXPECT_THAT(refusal_of({"history", "--database", "a.db", "--config", "b.toml"}),
              HasSubstr("--database"));
  write("text.db", "this is no database, but it is long enough to look like one to a hasty reader");
  EXPECT_THAT(refusal_of({"history", "--database", "text.db"}), HasSubstr("text.db"));
  write("broken.toml", "[archive]\ndatabase = 3\n");
  EXPECT_THAT(refusal_of({"history", "--config", "broken.toml"}),
              HasSubstr("broken.toml: there is no spacecraft"));
}

TEST_F(WithoutDatabase, TheConfigurationNamesIt) {
  write("reident.toml", R"(
[archive]
database = "kept.db"
[[spacecraft]]
name = "CBERS-4"
[[spacecraft.equipment]]
name = "BDR"
inputs = ["I_BDRIN1"]
outputs = ["I_BDROUT"]
sample_period = "1s"
window = "1h"
)");
  EXPECT_THAT(refusal_of({"history"}), HasSubstr("kept.db does not exist"));
  storage::Database database(folder() / "kept.db", storage::Database::Mode::read_write);
  EXPECT_THAT(json_of({"history"})["attempts"], IsEmpty());
  EXPECT_THAT(json_of({"history", "--config", "reident.toml"})["attempts"], IsEmpty());
  for (const auto& where : std::vector<std::vector<std::string>>{
           {"--config", "reident.toml"}, {"--db", "kept.db"}, {"kept.db"}, {}}) {
    std::vector<std::string> verify = {"verify"}, completeness = {"completeness"};
    verify.insert(verify.end(), where.begin(), where.end());
    completeness.insert(completeness.end(), where.begin(), where.end());
    EXPECT_EQ(json_of(verify)["sound"], true);
    EXPECT_THAT(refusal_of(completeness), HasSubstr("there is no telemetry"));
  }
  EXPECT_EQ(reident({"backup", "a.db", "--config", "reident.toml"}).status, 0);
  EXPECT_EQ(reident({"backup", "kept.db", "b.db"}).status, 0);
  EXPECT_EQ(reident({"backup", "--db", "kept.db", "c.db"}).status, 0);
  for (const char* copy : {"a.db", "b.db", "c.db"})
    EXPECT_TRUE(std::filesystem::exists(folder() / copy)) << copy;
}

}  // namespace
}  // namespace reident::cli::stored_test
