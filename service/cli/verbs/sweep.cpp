#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/file_errors.hpp"
#include "service/cli/output/sweep_report.hpp"
#include "service/cli/time_options.hpp"
#include "service/cli/verb.hpp"
#include "service/support/mutex.hpp"
#include "service/support/progress.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/terminal.hpp"
#include "service/sweep/engines.hpp"
#include "service/sweep/plan.hpp"
#include "service/sweep/report.hpp"
#include "service/sweep/tasks.hpp"

namespace reident::cli::sweep_verb {
namespace {

using nlohmann::ordered_json;
using sweep::Plan;
using sweep::TaskKind;

constexpr std::size_t rows_of_screen = 15;
constexpr std::size_t most_failures_shown = 5;

struct Arguments {
  std::string folder;
  std::vector<std::string> configs, changes;
  TimeOptions time;
  bool copy = false, slurm = false, status = false, long_list = false, json = false;
  std::optional<std::string> kubernetes;
  std::optional<std::size_t> task, judge;
};

Plan plan_of(const Arguments& arguments, const StopSignal& stop) {
  if (arguments.configs.empty()) return sweep::read_plan(arguments.folder);
  const auto range =
      chosen_range(arguments.time, {0, std::numeric_limits<storage::Time>::max() / 2});
  if (const auto* refusal = std::get_if<Refusal>(&range))
    throw std::invalid_argument(refusal->message);
  return sweep::make_plan({{arguments.configs.begin(), arguments.configs.end()},
                           arguments.changes,
                           std::get<storage::TimeRange>(range),
                           arguments.copy},
                          arguments.folder, [&] { return !stop.token().stop_requested(); });
}

ordered_json json_of(const sweep::TaskStates& states) {
  ordered_json failures = ordered_json::array();
  for (const auto& [task, reason] : states.failures)
    failures.push_back({{"task", task}, {"reason", reason}});
  return {{"done", states.done}, {"left", states.left.size()}, {"failures", failures}};
}

/// Returns whether all tasks of the kind are done.
bool print_states(const Plan& plan, TaskKind kind) {
  const sweep::TaskStates now = sweep::states(plan, kind);
  fmt::print("{}: {} of {} tasks done, {} failed\n", name(kind), now.done,
             now.done + now.left.size(), now.failures.size());
  for (std::size_t i = 0; i < std::min(most_failures_shown, now.failures.size()); ++i)
    fmt::print("  task {}: {}\n", now.failures[i].task, now.failures[i].reason);
  if (now.failures.size() > most_failures_shown)
    fmt::print("  and {} more; --status --json lists all\n",
               now.failures.size() - most_failures_shown);
  return now.left.empty();
}

int print_status(const Plan& plan, bool json) {
  if (json) {
    const auto candidates = sweep::states(plan, TaskKind::candidates);
    const auto judgements = sweep::states(plan, TaskKind::judgement);
    fmt::print("{}\n", ordered_json({{"candidates", json_of(candidates)},
                                     {"judgement", json_of(judgements)}})
                           .dump());
    return candidates.left.empty() && judgements.left.empty() ? exit_done : exit_failed;
  }
  const bool found = print_states(plan, TaskKind::candidates);
  const bool judged = print_states(plan, TaskKind::judgement);
  return found && judged ? exit_done : exit_failed;
}

int print_report(const Plan& plan, const Arguments& arguments) {
  const auto report = sweep::report_of(plan);
  if (!report) return print_status(plan, arguments.json);
  if (arguments.json) {
    fmt::print("{}\n", report->dump());
    return exit_done;
  }
  const std::size_t width = terminal_width();
  if (arguments.long_list) fmt::print("{}\n", sweep_publications(*report, width));
  fmt::print("{}", sweep_table(*report, arguments.long_list ? 0 : rows_of_screen, width));
  return exit_done;
}

/// Does the tasks, on all cores. One that fails does not keep the others. Returns why the first of
/// them failed.
std::string run_here(const Plan& plan, TaskKind kind, const std::vector<std::size_t>& tasks,
                     WorkerPool& workers, const StopSignal& stop) {
  Mutex mutex;
  std::size_t ended = 0;
  std::string reason;
  Progress bar;
  workers.for_each(tasks.size(), [&](std::size_t i) {
    if (stop.token().stop_requested()) return;
    try {
      run_task(plan, {kind, tasks[i]}, workers, [&] { return stop.token().stop_requested(); });
    } catch (const std::invalid_argument&) {
      throw;
    } catch (const std::exception& error) {
      const MutexLock lock(mutex);
      if (reason.empty()) reason = error.what();
    }
    const MutexLock lock(mutex);
    bar.update(static_cast<double>(++ended) / static_cast<double>(tasks.size()),
               fmt::format("{} {}/{}", name(kind), ended, tasks.size()));
  });
  bar.clear();
  return reason;
}

int run_here(const Plan& plan, const Arguments& arguments, const StopSignal& stop) {
  WorkerPool workers(usable_cores());
  std::string reason = run_here(plan, TaskKind::candidates,
                                sweep::states(plan, TaskKind::candidates).left, workers, stop);
  std::vector<std::size_t> judgements = sweep::states(plan, TaskKind::judgement).left;
  for (const std::size_t task : sweep::states(plan, TaskKind::candidates).left)
    std::erase(judgements, plan.candidates[task].spacecraft);
  const std::string other = run_here(plan, TaskKind::judgement, judgements, workers, stop);
  if (reason.empty()) reason = other;
  if (!reason.empty()) print_error("reident: a task failed: {}", reason);
  if (stop.token().stop_requested())
    print_error("reident: stopped; reident sweep {} goes on where it ended", plan.folder.string());
  return print_report(plan, arguments);
}

int run_one(const Plan& plan, sweep::TaskId task, const StopSignal& stop) {
  WorkerPool workers(usable_cores());
  return run_task(plan, task, workers, [&] { return stop.token().stop_requested(); }) ? exit_done
                                                                                      : exit_failed;
}

int submit(const Plan& plan, const Arguments& arguments) {
  const std::vector<std::string> jobs = submit_to_slurm(plan);
  if (jobs.empty()) return print_report(plan, arguments);
  for (const std::string& job : jobs)
    fmt::print("{}\n", arguments.json ? ordered_json({{"job", job}}).dump() : "job " + job);
  if (!arguments.json)
    fmt::print("reident sweep {} --status shows how far they are\n", plan.folder.string());
  return exit_done;
}

int run(const Arguments& arguments) {
  const StopSignal stop;
  return refusing_what_cannot_be([&] {
    try {
      const Plan plan = plan_of(arguments, stop);
      if (arguments.task) return run_one(plan, {TaskKind::candidates, *arguments.task}, stop);
      if (arguments.judge) return run_one(plan, {TaskKind::judgement, *arguments.judge}, stop);
      if (arguments.status) return print_status(plan, arguments.json);
      if (arguments.slurm) return submit(plan, arguments);
      if (arguments.kubernetes) {
        fmt::print("{}", kubernetes_manifest(plan, *arguments.kubernetes));
        return int{exit_done};
      }
      return run_here(plan, arguments, stop);
    } catch (const std::invalid_argument& error) {
      return refuse({error.what()});
    }
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("folder", arguments->folder, "what is planned and found; made where missing")
      ->required();
  command.add_option("--config", arguments->configs,
                     "configurations of the services whose archives are asked; without one the "
                     "sweep that the folder holds goes on");
  auto* set = command.add_option("--set", arguments->changes,
                                 "what would be different: KEY=VALUE for all equipment, or "
                                 "EQUIPMENT.KEY=VALUE, as window=800min");
  add_time_options(command, arguments->time, "windows that end");
  command.add_flag("--copy", arguments->copy,
                   "copy the archives into the folder first: services may write meanwhile");
  for (CLI::Option* option : {set, command.get_option("--from"), command.get_option("--to"),
                              command.get_option("--copy")})
    option->needs("--config");
  auto* slurm = command.add_flag("--slurm", arguments->slurm,
                                 "submit the tasks that are left to Slurm, as two job arrays");
  auto* kubernetes = command.add_option("--kubernetes", arguments->kubernetes,
                                        "print a manifest of two indexed Jobs with this image");
  auto* status = command.add_flag("--status", arguments->status, "only show how far the tasks are");
  auto* task = command.add_option("--task", arguments->task,
                                  "only find the candidates of the task with this number");
  auto* judge =
      command.add_option("--judge", arguments->judge, "only judge the spacecraft with this number");
  for (CLI::Option* option : {slurm, kubernetes, status, task, judge})
    for (CLI::Option* other : {slurm, kubernetes, status, task, judge})
      if (option != other) option->excludes(other);
  command.add_flag("--long", arguments->long_list, "every equipment, and every publication");
  command.add_flag("--json", arguments->json, "one JSON object with all figures");
  command.footer(
      "Archives are only read. The registries as they would be are in FOLDER/judged.\n"
      "Example:\n  reident sweep /data/longer --config SAT-1.toml SAT-2.toml --set window=800min "
      "--copy");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"sweep", "Ask what would have been published with another configuration, over years",
     WorksOn::database, declare});

}  // namespace

}  // namespace reident::cli::sweep_verb
