// The two kinds of tasks of a sweep. Candidates need no order: they are what takes long. The
// judgement of a spacecraft takes them in the order of time, as its service would have.
//
// Each reads the archives and writes files of its own alone. It may run anywhere, at any time and
// more than once: the plan and the telemetry determine every bit of the result but timings.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "service/support/parallel.hpp"
#include "service/sweep/plan.hpp"

namespace reident::sweep {

enum class TaskKind { candidates, judgement };
/// "candidates" or "judgement".
std::string_view name(TaskKind kind);

struct TaskId {
  TaskKind kind = TaskKind::candidates;
  std::size_t number = 0;  // in Plan::candidates or Plan::spacecraft
};

/// Does the task, unless its result is there. `stop` is asked after each window. Returns false
/// where it was stopped, and then nothing is left of it. Where it fails, the reason is kept in the
/// folder, where that can be written, and thrown: storage::Error, or std::runtime_error, also for a
/// judgement whose candidates are not there. Throws std::invalid_argument for a number that there
/// is not, and where another version of the program made the plan.
bool run_task(const Plan& plan, TaskId task, WorkerPool& workers,
              const std::function<bool()>& stop);

/// The result of the task; absent where it is not there whole, or is another plan's.
std::optional<nlohmann::ordered_json> result_of(const Plan& plan, TaskId task);

/// How far the tasks of one kind are.
struct TaskStates {
  std::size_t done = 0;
  std::vector<std::size_t> left;  // without a result, ascending
  struct Failure {
    std::size_t task;
    std::string reason;
  };
  std::vector<Failure> failures;  // of those left
};
TaskStates states(const Plan& plan, TaskKind kind);

}  // namespace reident::sweep
