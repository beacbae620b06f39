// The trust suite: scenarios of life and faults through the real service on a simulated clock.

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <random>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/support/allocator.hpp"
#include "service/support/log.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/trust/outcome_folder.hpp"
#include "tests/trust/picture.hpp"
#include "tests/trust/power.hpp"
#include "tests/trust/recipe.hpp"
#include "tests/trust/report.hpp"
#include "tests/trust/suite_config.hpp"

namespace {

using namespace reident;
using namespace reident::trust;

struct Options {
  bool list = false, quick = false, handful = false, recipe = false, power = false;
  std::vector<int> scenarios;
  std::string family = "both";
  std::vector<satcs::Family> families;
  std::string life, fault;
  std::string plot;                   // a file, of one scenario
  std::string report;                 // a folder
  std::string month;                  // a file
  std::string dds;                    // a file
  std::string databases;              // a folder
  std::string keep;                   // a folder
  std::string outcomes;               // a folder
  std::string keys;                   // in TOML
  std::optional<std::uint64_t> draw;  // absent: a fresh one
  unsigned jobs = 2;
  int sequences = 200;
  std::vector<double> ratios = power_ratios;
};

bool is_wanted(const LifeGroup& group, int first_number, const Scenario& scenario,
               const Options& options) {
  if (!options.scenarios.empty())
    return std::find(options.scenarios.begin(), options.scenarios.end(), scenario.number) !=
           options.scenarios.end();
  if (options.handful && !is_of_the_handful(scenario)) return false;
  constexpr std::uint64_t quick_step = 12;  // every sixth life: each has two seeds
  if (options.quick && (group.seed % quick_step != 2 || scenario.number > first_number + 1))
    return false;
  if (!options.life.empty() && group.life != options.life) return false;
  return options.fault.empty() || scenario.fault == options.fault;
}

using Configs = std::map<satcs::Family, Config>;

std::vector<LifeGroup> wanted_groups(const Configs& configs, const Options& options) {
  std::vector<LifeGroup> groups;
  for (const satcs::Family family : options.families)
    for (LifeGroup& group :
         all_groups(configs.at(family).spacecraft.front(), *options.draw, family))
      groups.push_back(std::move(group));
  const auto& numbers = options.scenarios;
  if (std::find(numbers.begin(), numbers.end(), 0) != numbers.end())
    groups.insert(groups.begin(), short_group());
  for (LifeGroup& group : groups) {
    const std::vector<Scenario> all = std::exchange(group.scenarios, {});
    for (const Scenario& scenario : all)
      if (is_wanted(group, all.front().number, scenario, options))
        group.scenarios.push_back(scenario);
  }
  std::erase_if(groups, [](const LifeGroup& group) { return group.scenarios.empty(); });
  return groups;
}

void list(const std::vector<LifeGroup>& groups) {
  for (const LifeGroup& group : groups)
    for (const Scenario& scenario : group.scenarios)
      fmt::print("{:4} {} with {}\n", scenario.number, group.life, scenario.fault);
}

/// A line of JSON each: what runs the scenario with the real processes.
void print_recipes(const std::vector<LifeGroup>& groups, const std::string& keys) {
  for (const LifeGroup& group : groups)
    for (const Scenario& scenario : group.scenarios) {
      const Recipe recipe = recipe_of(group, scenario);
      const nlohmann::ordered_json json{
          {"scenario", scenario.number},
          {"configuration", suite_toml(group.equipment, group.family, keys)},
          {"simulator", recipe.simulator},
          {"spacecraft", recipe.spacecraft}};
      fmt::print("{}\n", json.dump());
    }
}

std::vector<ScenarioOutcome> run(const LifeGroup& group, const Config& config,
                                 const std::filesystem::path& folder, const Options& options) {
  if (!options.databases.empty()) return score_databases(group, config, options.databases);
  return options.keep.empty() ? run_group(group, config, folder)
                              : run_group(group, config, options.keep, Databases::kept);
}

/// Runs what the folder does not have yet, and keeps it there.
std::vector<ScenarioOutcome> run_the_rest(LifeGroup group, const OutcomeFolder& kept,
                                          const auto& run_one) {
  std::vector<ScenarioOutcome> outcomes;
  std::erase_if(group.scenarios, [&](const Scenario& scenario) {
    auto found = kept.find(group, scenario);
    if (found) outcomes.push_back(*std::move(found));
    return found.has_value();
  });
  if (!group.scenarios.empty())
    for (ScenarioOutcome& outcome : run_one(group)) {
      kept.keep(outcome);
      outcomes.push_back(std::move(outcome));
    }
  std::ranges::sort(outcomes, {}, &ScenarioOutcome::number);
  return outcomes;
}

/// Groups side by side on `jobs` threads; the outcomes in the order of the scenarios' numbers.
std::vector<ScenarioOutcome> run(const std::vector<LifeGroup>& groups, const Configs& configs,
                                 const Options& options) {
  const test::TemporaryFolder folder;
  std::optional<OutcomeFolder> kept;
  if (!options.outcomes.empty()) kept.emplace(options.outcomes, *options.draw, options.keys);
  std::vector<std::vector<ScenarioOutcome>> outcomes(groups.size());
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr error;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < groups.size(); i = next++) {
        const auto run_one = [&](const LifeGroup& group) {
          return run(group, configs.at(group.family), folder.path(), options);
        };
        outcomes[i] = kept ? run_the_rest(groups[i], *kept, run_one) : run_one(groups[i]);
        const std::lock_guard lock(mutex);
        for (const ScenarioOutcome& outcome : outcomes[i]) fmt::print(stderr, "{}", story(outcome));
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      error = std::current_exception();
      next = groups.size();
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < options.jobs; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
  std::vector<ScenarioOutcome> all;
  for (auto& group : outcomes)
    all.insert(all.end(), std::make_move_iterator(group.begin()),
               std::make_move_iterator(group.end()));
  return all;
}

/// A draw that nobody has seen, unless one is chosen: rules fit those that they were made on.
std::uint64_t fresh_draw() {
  return std::random_device()() % 1'000'000 + 1;
}

/// The power curves as part of the last line, with the figure that is asked for.
void add_power(const std::vector<PowerPoint>& points, nlohmann::ordered_json& figures) {
  for (const PowerPoint& point : points)
    if (point.kind == ErrorKind::white && point.ratio == 0.75)
      figures["power_quarter_orbits"] =
          point.median() ? nlohmann::ordered_json(*point.median()) : nlohmann::ordered_json();
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("--family", options.family,
                 "run the power subsystem's scenarios, the platform's (from 1001), or both")
      ->check(CLI::IsMember({"power", "platform", "both"}))
      ->capture_default_str();
  app.add_flag("--list", options.list, "list the scenarios that are chosen, and run none");
  app.add_flag("--quick", options.quick, "run two scenarios of every sixth life");
  app.add_flag("--handful", options.handful, "run every 71st scenario alone");
  app.add_option(
      "--scenario", options.scenarios,
      "run these scenarios alone, by number; 0 is a short one that is no part of the suite");
  app.add_option(
      "--draw", options.draw,
      "seeds, dates and times of the plans; 0 is that of the regression tests; by default "
      "a draw that nobody has seen, which is printed");
  app.add_flag("--power", options.power,
               "run none; print how soon the rule tells a better version, by the ratio of errors");
  app.add_option("--sequences", options.sequences, "of --power: for each kind and ratio")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--ratio", options.ratios,
                 "of --power: the version's error over the champion's; 1: no change is right")
      ->check(CLI::Range(0.001, 1.0))
      ->capture_default_str();
  app.add_option("--life", options.life, "run the scenarios of this life alone");
  app.add_option("--fault", options.fault, "run the scenarios of this fault alone");
  app.add_option("--plot", options.plot, "write an SVG picture of the one scenario that is run");
  app.add_option("--report", options.report,
                 "write report.md and pictures of the worst cases into this folder");
  app.add_option("--month", options.month,
                 "what tests/trust/month.py printed: its month_seconds goes into the last line")
      ->check(CLI::ExistingFile);
  app.add_option("--dds", options.dds,
                 "what tests/trust/over_dds.py printed: its figures go into the last line")
      ->check(CLI::ExistingFile);
  app.add_flag("--recipe", options.recipe,
               "run none; print, as one JSON object each, the configuration of reidentd and the "
               "arguments of satcs-reference (the simulator, then the spacecraft) that make the "
               "scenarios that are chosen");
  app.add_option("--databases", options.databases,
                 "run none; score what reidentd made of them, NUMBER.db of each in this folder")
      ->check(CLI::ExistingDirectory);
  app.add_option("--keep", options.keep,
                 "leave the database of each scenario in this folder, NUMBER/reident.db, for "
                 "reident history, show and why");
  app.add_option("--outcomes", options.outcomes,
                 "keep what became of each scenario in this folder, and do not run again what it "
                 "has: a run that was interrupted goes on");
  app.add_option("--set", options.keys,
                 "keys of every equipment, as in reident.toml: --set 'bias = \"approve\"'");
  app.add_option("--jobs", options.jobs, "groups side by side")->check(CLI::Range(1, 64));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The trust suite: life and faults through the real service", "reident_trust");
  keep_freed_memory();
  Options options;
  add_options(app, options);
  CLI11_PARSE(app, argc, argv);
  for (const satcs::Family one : {satcs::Family::power, satcs::Family::platform})
    if (options.family == "both" || name(one) == options.family) options.families.push_back(one);
  const bool is_chosen = options.draw.has_value();
  if (!is_chosen)
    options.draw = options.databases.empty() && options.scenarios.empty() ? fresh_draw() : 0;
  try {
    log::set_level("error");
    if (options.power) {
      nlohmann::ordered_json figures{{"draw", *options.draw}};
      const auto points = power_curves(*options.draw, options.sequences, options.ratios);
      add_power(points, figures);
      fmt::print("{}{}\n", power_table(points), figures.dump());
      return 0;
    }
    Configs configs;
    for (const satcs::Family family : {satcs::Family::power, satcs::Family::platform})
      configs.emplace(family, suite_config(family, options.keys));
    const std::vector<LifeGroup> groups = wanted_groups(configs, options);
    if (options.list) {
      list(groups);
      return 0;
    }
    if (options.recipe) {
      print_recipes(groups, options.keys);
      return 0;
    }
    if (!is_chosen)
      fmt::print(stderr, "draw {}: --draw {} gives the same scenarios\n", *options.draw,
                 *options.draw);
    const std::vector<ScenarioOutcome> outcomes = run(groups, configs, options);
    if (!options.plot.empty()) {
      if (outcomes.size() != 1) throw std::runtime_error("--plot needs one --scenario");
      std::ofstream file(options.plot);
      file << picture(outcomes.front());
      if (!file.flush()) throw std::runtime_error(options.plot + ": cannot be written");
    }
    nlohmann::ordered_json figures{{"draw", *options.draw}};
    figures.update(figures_json(outcomes));
    if (!options.report.empty()) {
      const auto points = power_curves(*options.draw, options.sequences);
      add_power(points, figures);
      write_report(outcomes, "## Power\n\n" + power_table(points), options.report);
    }
    if (!options.month.empty()) {
      std::ifstream file(options.month);
      figures["month_seconds"] = nlohmann::json::parse(file).at("month_seconds");
    }
    if (!options.dds.empty()) {
      std::ifstream file(options.dds);
      figures["over_dds"] = nlohmann::json::parse(file);
    }
    fmt::print("{}", tables(outcomes));
    fmt::print("{}\n", figures.dump());
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "reident_trust: {}\n", error.what());
    return 1;
  }
}
