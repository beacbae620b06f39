#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "service/operations/backfill.hpp"
#include "service/operations/refresh.hpp"
#include "service/sweep/comparison.hpp"
#include "service/sweep/engines.hpp"
#include "service/sweep/plan.hpp"
#include "service/sweep/report.hpp"
#include "service/sweep/task_file.hpp"
#include "service/sweep/tasks.hpp"
#include "tests/service/daemon_fixture.hpp"

namespace reident::test::sweep_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using sweep::Plan;
using sweep::TaskKind;

bool never() {
  return false;
}

class Sweep : public DaemonTest {
 protected:
  /// An hour and a half of telemetry, whose gain changes in the middle.
  void fill() const {
    storage::Database database = open();
    storage::Archive archive(database);
    archive.describe(descriptors());
    archive.append(telemetry(day, 2700));
    archive.append(telemetry(day + 45 * minute, 2701, 1.5));
  }

  fs::path configuration() const {
    fs::path file = path().parent_path() / "reident.toml";
    std::ofstream(file) << R"(
[archive]
database = "reident.db"
[[spacecraft]]
name = "SAT"
[[spacecraft.equipment]]
name = "PLANT"
inputs = ["u", "v"]
outputs = ["y"]
sample_period = "1s"
window = "10min"
slide = "2min"
cycle = "1min"
bias = "approve"
baseline_mrse = 50
)";
    return file;
  }

  fs::path folder(const std::string& name) const { return path().parent_path() / name; }

  sweep::Question question(std::vector<std::string> changes = {}) const {
    return {{configuration()}, std::move(changes), {0, day + 100'000 * second}, false};
  }

  Plan plan(const std::string& name, std::vector<std::string> changes = {}) const {
    return make_plan(question(std::move(changes)), folder(name), [] { return true; });
  }

  /// In the order from the last to the first.
  static void run_all(const Plan& plan) {
    WorkerPool workers(1);
    for (std::size_t i = plan.candidates.size(); i-- > 0;)
      EXPECT_TRUE(run_task(plan, {TaskKind::candidates, i}, workers, never));
    for (std::size_t i = 0; i < plan.spacecraft.size(); ++i)
      EXPECT_TRUE(run_task(plan, {TaskKind::judgement, i}, workers, never));
  }
};

TEST_F(Sweep, GoesOnFromAFoundWindowAsFromOneOfItsOwn) {
  storage::Database database = open();
  storage::Archive archive(database);
  archive.describe(descriptors());
  std::vector<storage::TelemetryFrame> frames = telemetry(day, 1800);
  const std::vector late{frames[400]};
  frames.erase(frames.begin() + 400);
  archive.append(frames);
  const storage::Registry registry(database);
  const RefreshRequest request{
      "SAT", plant(), {day + 5 * minute, day + 15 * minute}, "slide", "digest"};
  WindowCache kept = window_cache_of("SAT", plant());
  PreparedWindow own = prepare_window(archive, request, kept, {}, never);
  const std::string text = to_json(found_window(own)).dump();
  WindowCache other = window_cache_of("SAT", plant());
  auto restored =
      restored_window(archive, request, other, found_window_from_json(ordered_json::parse(text)));
  ASSERT_TRUE(restored);
  const RefreshResult one = judge(registry, request, std::move(own));
  const RefreshResult two = judge(registry, request, *std::move(restored));
  ASSERT_TRUE(one.candidate);
  EXPECT_EQ(one.version.model_json, two.version.model_json);
  EXPECT_EQ(one.version.digest, two.version.digest);
  EXPECT_EQ(one.version.provenance_json, two.version.provenance_json);
  const auto evidence = [](const RefreshResult& result) {
    auto json = ordered_json::parse(result.attempt.evidence_json);
    json.erase("timing_ms");
    return json.dump();
  };
  EXPECT_EQ(evidence(one), evidence(two));

  archive.append(late);
  WindowCache again = window_cache_of("SAT", plant());
  EXPECT_FALSE(
      restored_window(archive, request, again, found_window_from_json(ordered_json::parse(text))))
      << "the samples of the window are others";
}

TEST_F(Sweep, GivesTheBitsOfOneMachine) {
  fill();
  const Plan tasks = plan("tasks");
  ASSERT_GT(tasks.candidates.size(), 3U);
  run_all(tasks);

  const Config config = tasks.configurations[0];
  storage::Database one(folder("one.db"), storage::Database::Mode::read_write);
  WorkerPool workers(2);
  const BackfillProgress progress = backfill(
      one, config, {"SAT", "", tasks.spacecraft[0].range, {}}, workers,
      [](storage::Time reached) { return reached; }, [](const BackfillProgress&) { return true; });
  EXPECT_GT(progress.approved, 1U);
  const storage::Registry registry(one);
  for (const storage::Decision& decision : registry.decisions("SAT", "PLANT"))
    EXPECT_GE(decision.time, registry.version("SAT", "PLANT", decision.version)->window.end);
  const auto report = report_of(tasks);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->at("windows"), progress.windows);
  EXPECT_EQ(report->at("spacecraft")[0].at("registry_sha256"), sweep::registry_digest(one));
}

TEST_F(Sweep, ComparesWithWhatReallyWas) {
  fill();
  {
    storage::Database database = open();
    const Config config = std::get<Config>(load_config(configuration()));
    WorkerPool workers(2);
    backfill(
        database, config, {"", "", question().range, {}}, workers,
        [](storage::Time) { return day - second; }, [](const BackfillProgress&) { return true; });
  }
  const Plan same = plan("same");
  run_all(same);
  const ordered_json report = *report_of(same);
  const ordered_json& plant = report.at("spacecraft")[0].at("equipment")[0];
  EXPECT_GE(plant.at("was").at("publications").size(), 2U);
  EXPECT_EQ(plant.at("would"), plant.at("was")) << "nothing was changed";
  EXPECT_GE(plant.at("would").at("regret"), 1.0);
  EXPECT_EQ(report.at("error_ratio"), 1.0);
  EXPECT_EQ(plant.at("note"), "");

  sweep::Question part = question();
  part.range = {day + 40 * minute, day + 70 * minute};
  const Plan later = make_plan(part, folder("later"), [] { return true; });
  run_all(later);
  const ordered_json from = report_of(later)->at("spacecraft")[0].at("equipment")[0];
  EXPECT_EQ(from.at("was").at("publications")[0].at("version"),
            plant.at("was").at("publications")[0].at("version"))
      << "it ran already";
  EXPECT_THAT(from.at("note").get<std::string>(), testing::HasSubstr("begins without"));
  sweep::Question until = question();
  until.range.end = day + 60 * minute;
  const Plan shorter = make_plan(until, folder("shorter"), [] { return true; });
  run_all(shorter);
  const ordered_json half = report_of(shorter)->at("spacecraft")[0].at("equipment")[0];
  EXPECT_EQ(half.at("would"), half.at("was")) << "of the same time";
  const Plan other = plan("other", {"inputs=[\"u\"]"});
  run_all(other);
  const ordered_json signals = *report_of(other);
  EXPECT_TRUE(signals.at("was_regret").is_null()) << "of other telemetry";
  EXPECT_EQ(signals.at("would_regret"), signals.at("was_regret"));

  const Plan strict = plan("strict", {"PLANT.max_mrse=0.0001"});
  run_all(strict);
  const ordered_json none = report_of(strict)->at("spacecraft")[0].at("equipment")[0];
  EXPECT_EQ(none.at("would").at("publications"), ordered_json::array());
  EXPECT_THAT(none.at("outcomes").get<std::string>(), testing::HasSubstr("error_above_limit"));
  EXPECT_EQ(none.at("was").at("publications"), plant.at("was").at("publications"));
  EXPECT_TRUE(none.at("common").at("was_mrse_percent").is_null());
  EXPECT_GT(none.at("was").at("mrse_percent"), 0.0);
}

TEST_F(Sweep, DoesWorkOnceAndDamagedWorkAgain) {
  fill();
  const Plan tasks = plan("tasks");
  WorkerPool workers(1);
  EXPECT_THROW(run_task(tasks, {TaskKind::judgement, 0}, workers, never), std::runtime_error);
  EXPECT_EQ(states(tasks, TaskKind::judgement).failures.size(), 1U);
  run_all(tasks);
  EXPECT_EQ(states(tasks, TaskKind::judgement).failures.size(), 0U);
  const std::string judged = report_of(tasks)->dump();

  const fs::path file = tasks.file_of_candidates(1);
  const auto written = fs::last_write_time(file);
  EXPECT_TRUE(run_task(tasks, {TaskKind::candidates, 1}, workers, never));
  EXPECT_EQ(fs::last_write_time(file), written);
  const std::string result = sweep::read_task_file(file)->at("windows")[0]["found"]["model"].dump();
  fs::resize_file(file, fs::file_size(file) / 2);
  EXPECT_EQ(states(tasks, TaskKind::candidates).left, std::vector<std::size_t>{1});
  EXPECT_TRUE(run_task(tasks, {TaskKind::candidates, 1}, workers, never));
  EXPECT_EQ(sweep::read_task_file(file)->at("windows")[0]["found"]["model"].dump(), result);

  fs::remove(tasks.file_of_judgement(0));
  fs::create_directory(tasks.registry_of(0).string() + ".of-one-that-was-killed");
  EXPECT_TRUE(run_task(tasks, {TaskKind::judgement, 0}, workers, never));
  EXPECT_EQ(report_of(tasks)->dump(), judged);
  EXPECT_FALSE(fs::exists(tasks.registry_of(0).string() + ".of-one-that-was-killed"));
  fs::resize_file(tasks.registry_of(0), 100);
  EXPECT_EQ(states(tasks, TaskKind::judgement).left, std::vector<std::size_t>{0});
  EXPECT_FALSE(report_of(tasks));
  EXPECT_TRUE(run_task(tasks, {TaskKind::judgement, 0}, workers, never));
  EXPECT_EQ(report_of(tasks)->dump(), judged);
  EXPECT_FALSE(run_task(plan("stopped"), {TaskKind::candidates, 0}, workers, [] { return true; }));
}

TEST_F(Sweep, KeepsToItsQuestion) {
  fill();
  const Plan first = plan("tasks", {"window=12min"});
  EXPECT_EQ(first.configurations[0].spacecraft[0].equipment[0].window, 12 * minute);
  EXPECT_EQ(plan("tasks", {"window=12min"}).digest, first.digest);
  EXPECT_EQ(sweep::read_plan(folder("tasks")).digest, first.digest);
  EXPECT_THROW(plan("tasks", {"window=13min"}), std::invalid_argument);
  EXPECT_THROW(plan("other", {"windw=13min"}), std::invalid_argument);
  EXPECT_THROW(plan("other", {"PLANT.name=Y"}), std::invalid_argument);
  EXPECT_THROW(plan("other", {"NOBODY.window=13min"}), std::invalid_argument);
  EXPECT_THROW(sweep::read_plan(folder("nowhere")), std::invalid_argument);
  EXPECT_THROW(plan("reident.toml"), std::invalid_argument) << "a file";
  std::ofstream(folder("tasks") / "plan.json", std::ios::app) << "x";
  try {
    sweep::read_plan(folder("tasks"));
    FAIL() << "a damaged plan was read";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("damaged"));
  }
  fs::remove(folder("tasks") / "plan.json");
  EXPECT_EQ(plan("tasks", {"window=12min"}).digest, first.digest) << "results count";
  ordered_json older = *sweep::read_task_file(folder("tasks") / "plan.json");
  older["program_version"] = "0.0.1";
  sweep::write_task_file(folder("tasks") / "plan.json", older);
  WorkerPool workers(1);
  EXPECT_THROW(
      run_task(sweep::read_plan(folder("tasks")), {TaskKind::candidates, 0}, workers, never),
      std::invalid_argument);
  EXPECT_THROW(sweep::kubernetes_manifest(first, "image"), std::invalid_argument)
      << "pods see the folder alone";
}

TEST(SlurmArray, JoinsNeighbours) {
  EXPECT_EQ(sweep::array_of({0, 1, 2, 5, 7, 8}), "0-2,5,7-8");
  EXPECT_EQ(sweep::array_of({4}), "4");
}

}  // namespace
}  // namespace reident::test::sweep_test
