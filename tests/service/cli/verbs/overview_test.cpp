// overview and waiting on a database that the registry filled.
#include <chrono>

#include "service/model/model_json.hpp"
#include "service/support/terminal.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"
#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::overview_test {
namespace {

using nlohmann::json;
using storage::DecisionKind;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::int64_t minute = 60'000'000'000;
constexpr std::int64_t start = 1'700'000'000'000'000'000;  // 2023-11-14T22:13:20Z

class Overview : public test::CliTest {
 protected:
  void version(const std::string& equipment, DecisionKind kind) {
    EquipmentModel model;
    model.spacecraft = "SAT";
    model.equipment = equipment;
    model.inputs = {{"u", "A", 0, 1}};
    model.outputs = {{"y", "A", 0, 1}};
    model.dynamics.D = Eigen::MatrixXd::Ones(1, 1);
    model.dynamics.A = Eigen::MatrixXd(0, 0);
    model.dynamics.B = Eigen::MatrixXd(0, 1);
    model.dynamics.C = Eigen::MatrixXd(1, 0);
    model.dynamics.u0 = Eigen::VectorXd::Zero(1);
    model.dynamics.y0 = Eigen::VectorXd::Zero(1);
    model.dynamics.period_s = 1;
    model.sample_hold_ns = 3'000'000'000;
    model.validation = {Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1), 10};
    storage::NewAttempt attempt;
    attempt.spacecraft = "SAT";
    attempt.equipment = equipment;
    attempt.window = {start, start + 60 * minute};
    attempt.time = start + 60 * minute;
    attempt.outcome = "challenger";
    attempt.evidence_json = R"({"mrse_percent": 2.5})";
    registry_.record(attempt, {to_json(model).dump(), model_digest(model)},
                     {kind, "gate", "Good."});
  }
  /// Blocks of 15 minutes on which version 1 errs so.
  void record(const std::string& equipment, int blocks, double square) {
    for (int i = 0; i < blocks; ++i) {
      storage::Block block;
      block.range = {start + i * 15 * minute, start + (i + 1) * 15 * minute};
      block.rows = 900;
      block.believed = 1;
      block.output_mean = {10};
      block.output_square = {100};
      block.input_low = {0};
      block.input_high = {1};
      block.baseline_square = {4};
      const double of_block = i < blocks - 8 ? 1 : square;  // the last two cycles alone count
      registry_.record_scores("SAT", equipment, block,
                              {{1, block.range.begin, 900, {0}, {of_block}, {1e-6}, {}, {}}});
    }
  }
  void ask(const std::string& equipment, std::int64_t version) {
    registry_.decide("SAT", equipment, version,
                     {DecisionKind::wait, "gate", "Ask an operator.",
                      R"({"reasons":[{"code":"bias_unverified"}]})"},
                     start + 90 * minute);
  }
  json overview(int status) const {
    const test::Ran ran = reident({"overview", "--json", "--db", "reident.db"});
    EXPECT_EQ(ran.status, status) << ran.out << ran.err;
    return json::parse(ran.out, nullptr, false);
  }
  static std::vector<std::string> names(const json& view) {
    std::vector<std::string> names;
    for (const json& row : view["equipment"]) names.push_back(row["equipment"]);
    return names;
  }

  storage::Database database_{folder() / "reident.db", storage::Database::Mode::read_write};
  storage::Registry registry_{database_};
};

TEST_F(Overview, OfAnEmptyDatabaseSaysSo) {
  const test::Ran ran = reident({"overview", "--db", "reident.db"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out, "no window was tried yet\n");
}

TEST_F(Overview, ShowsTheErrorOfNowNextToThatOfTheApproval) {
  version("BDR", DecisionKind::approve);
  record("BDR", 40, 9);
  registry_.record_change({"SAT", "BDR"}, {1, start + 15 * minute, start + 60 * minute}, start);
  const json view = overview(0);
  EXPECT_EQ(view["act"], false);
  const json& row = view["equipment"][0];
  EXPECT_EQ(row["champion"], 1);
  EXPECT_EQ(row["since"], "2023-11-14T23:13:20Z");
  EXPECT_NEAR(row["mrse_percent"], 30, 1e-9);
  EXPECT_EQ(row["approved_mrse_percent"], 2.5);
  EXPECT_NEAR(row["simulator_mrse_percent"], 20, 1e-9);
  EXPECT_EQ(row["change"]["since"], "2023-11-14T22:28:20Z");
  EXPECT_TRUE(row["telemetry"].is_null()) << "none of its parameters has telemetry";
  EXPECT_EQ(row["windows_tried"], 1);
  EXPECT_THAT(reident({"overview", "--db", "reident.db"}).out,
              AllOf(HasSubstr("SAT/BDR          1"), HasSubstr("     30     2.5     20 "),
                    HasSubstr("changed 2023-11-14")));
}

TEST_F(Overview, TelemetryIsCompleteUntilTheParameterThatEndsFirst) {
  version("BDR", DecisionKind::approve);
  storage::Archive archive(database_);
  storage::ParameterDescriptor u, y;
  u.spacecraft = y.spacecraft = "SAT";
  u.name = "u", u.id = 1;
  y.name = "y", y.id = 2;
  archive.describe(std::vector{u, y});
  storage::TelemetryFrame frame;
  frame.spacecraft = "SAT";
  frame.source = "station";
  frame.generation_time = start;
  frame.samples = {{1, storage::Quality::good, 1}, {2, storage::Quality::good, 1}};
  storage::TelemetryFrame later = frame;
  later.generation_time += minute;
  later.samples = {{1, storage::Quality::good, 1}};
  archive.append(std::vector{frame, later});
  EXPECT_EQ(overview(0)["equipment"][0]["telemetry"], "2023-11-14T22:13:20Z");
}

TEST_F(Overview, TheWorstComesFirstAndSomebodyHasToAct) {
  for (const char* name : {"A", "B", "C", "D", "E"}) version(name, DecisionKind::approve);
  record("B", 20, 0.0625);  // as good as at its approval
  record("C", 20, 1);
  version("D", DecisionKind::wait);
  ask("D", 2);
  registry_.raise({"no_telemetry", {"SAT", "E"}, "None since noon.", start});
  registry_.raise({"champion_failed", {"SAT", "A"}, "It errs.", start});
  const json view = overview(1);
  EXPECT_THAT(names(view), ElementsAre("A", "E", "D", "C", "B"));
  EXPECT_EQ(view["equipment"][0]["failure"]["code"], "champion_failed");
  EXPECT_EQ(view["equipment"][2]["waiting"], json({2}));
  EXPECT_EQ(view["equipment"][2]["act"], true);
  EXPECT_EQ(view["equipment"][3]["act"], false);
  EXPECT_EQ(view["alarms"][1]["code"], "no_telemetry");
  registry_.decide("SAT", "D", 2, {DecisionKind::reject, "Ana", "no"}, start);
  registry_.clear("no_telemetry", {"SAT", "E"}, start);
  registry_.acknowledge("champion_failed", {"SAT", "A"}, "Ana", "rollback planned", start);
  EXPECT_EQ(overview(0)["alarms"][0]["seen_by"], "Ana");
}

TEST_F(Overview, FitsIntoEightyColumns) {
  version("BATTERY_DISCHARGE_1", DecisionKind::approve);
  record("BATTERY_DISCHARGE_1", 20, 1);
  registry_.put_on_hold("SAT", "BATTERY_DISCHARGE_1", {"Ana Souza", "training", start});
  registry_.raise({"simulators_old",
                   {"SAT", "BATTERY_DISCHARGE_1"},
                   "Not the champion, version 1, runs in trainer-1 (version 7), trainer-2.",
                   start});
  storage::SimulatorState simulator;
  simulator.simulator = "trainer-1";
  simulator.equipment = {"SAT", "BATTERY_DISCHARGE_1"};
  simulator.version = 7;
  registry_.record_simulator(simulator);
  const test::Ran ran = reident({"overview", "--db", "reident.db"});
  EXPECT_THAT(ran.out, AllOf(HasSubstr("  0/1\n"), HasSubstr("held by Ana Souza"),
                             HasSubstr("simulators_old"), Not(HasSubstr("\033"))));
  std::istringstream lines(ran.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(display_width(line), 80U) << line;
}

TEST_F(Overview, TheErrorOfAnApprovalByHandIsThatOfTheRecordThatSpokeForIt) {
  version("BDR", DecisionKind::wait);
  registry_.decide("SAT", "BDR", 1,
                   {DecisionKind::wait, "gate", "Ask an operator.", R"({"mrse_percent":4.5})"},
                   start + 90 * minute);
  registry_.decide("SAT", "BDR", 1, {DecisionKind::approve, "Ana Souza", "seen", ""},
                   start + 95 * minute);
  EXPECT_EQ(overview(0)["equipment"][0]["approved_mrse_percent"], 4.5);
}

TEST_F(Overview, OfAHundredEquipmentAndManyRecordsIsThereAtOnce) {
  for (int i = 0; i < 100; ++i) {
    const std::string name = "EQ" + std::to_string(100 + i);
    version(name, DecisionKind::approve);
    record(name, 100, 1);
  }
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(overview(0)["equipment"].size(), 100U);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
}

class Waiting : public Overview {};

TEST_F(Waiting, ListsWhatWaitsForAnOperatorAndWhatItSupersedes) {
  EXPECT_THAT(json_of({"waiting", "--db", "reident.db"})["waiting"], IsEmpty());
  for (int i = 0; i < 4; ++i) version("BDR", DecisionKind::wait);
  version("MEA", DecisionKind::wait);
  for (const std::int64_t number : {1, 3, 4}) ask("BDR", number);
  ask("MEA", 1);
  const test::Ran ran = reident({"waiting", "--json", "--db", "reident.db"});
  EXPECT_EQ(ran.status, 1);
  const json rows = json::parse(ran.out)["waiting"];
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[2]["version"], 4);
  EXPECT_EQ(rows[2]["supersedes"], json({1, 3}));
  EXPECT_EQ(rows[3]["equipment"], "MEA");
  EXPECT_EQ(rows[3]["supersedes"], json::array());
  EXPECT_EQ(rows[0]["evidence"]["reasons"][0]["code"], "bias_unverified");
  EXPECT_THAT(reident({"waiting", "BDR", "--db", "reident.db"}).out,
              AllOf(HasSubstr("SAT/BDR@4 "), HasSubstr("  1, 3 "), Not(HasSubstr("MEA"))));
  EXPECT_EQ(reident({"waiting", "PUMP", "--db", "reident.db"}).status, 0);
}

TEST_F(Waiting, IsSaidOfTheChampionThatItWouldReplace) {
  version("BDR", DecisionKind::approve);
  const auto said = [this] { return json_of({"why", "BDR", "--db", "reident.db"})["verdict"]; };
  EXPECT_THAT(std::string(said()), Not(HasSubstr("waits for an operator")));
  for (int i = 0; i < 3; ++i) version("BDR", DecisionKind::wait);
  version("MEA", DecisionKind::wait);
  for (const std::int64_t number : {2, 4}) ask("BDR", number);
  ask("MEA", 1);
  EXPECT_THAT(std::string(said()),
              HasSubstr("Version 4 waits for an operator's answer, as 1 before it. "));
}

class Configured : public test::CliTest {};

TEST_F(Configured, WithoutAnyWordTheOverviewIsShown) {
  write("reident.toml",
        "[archive]\ndatabase = \"kept.db\"\n[[spacecraft]]\nname = \"SAT\"\n"
        "[[spacecraft.equipment]]\nname = \"BDR\"\ninputs = [\"u\"]\noutputs = [\"y\"]\n"
        "sample_period = \"1s\"\nwindow = \"1h\"\n");
  {
    storage::Database service(folder() / "kept.db", storage::Database::Mode::read_write);
    const test::Ran ran = reident({});
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr("SAT/BDR       none"));
  }
  const test::Ran ran = reident({});
  EXPECT_EQ(ran.status, 1);
  EXPECT_THAT(ran.out, HasSubstr("no_service"));
}

}  // namespace
}  // namespace reident::cli::overview_test
