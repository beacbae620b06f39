#include "service/sweep/tasks.hpp"

#include <map>
#include <memory>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "service/operations/backfill.hpp"
#include "service/support/mutex.hpp"
#include "service/support/program_identity.hpp"
#include "service/support/version.hpp"
#include "service/sweep/comparison.hpp"
#include "service/sweep/task_file.hpp"
#include "service/windows/ticks.hpp"
#include "storage/archive/archive.hpp"

namespace reident::sweep {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using storage::Database;
using storage::Time;

fs::path result_file(const Plan& plan, TaskId task) {
  return task.kind == TaskKind::candidates ? plan.file_of_candidates(task.number)
                                           : plan.file_of_judgement(task.number);
}

fs::path failure_file(const Plan& plan, TaskId task) {
  return plan.folder / "failed" / fmt::format("{}-{}.json", name(task.kind), task.number);
}

/// Whether the registry is there as it was when the judgement ended.
bool is_whole(const fs::path& registry, const ordered_json& result) {
  std::error_code failed;
  const std::uintmax_t bytes = fs::file_size(registry, failed);
  return !failed && bytes == result.value("registry_bytes", std::uintmax_t{0});
}

const EquipmentConfig& equipment_of(const Plan& plan, const CandidateTask& task) {
  const PlannedSpacecraft& spacecraft = plan.spacecraft[task.spacecraft];
  for (const SpacecraftConfig& one : plan.configurations[spacecraft.configuration].spacecraft)
    if (one.name == spacecraft.name)
      for (const EquipmentConfig& equipment : one.equipment)
        if (equipment.name == task.equipment) return equipment;
  throw std::runtime_error(
      fmt::format("the plan names {}/{}, which its configuration does not have", spacecraft.name,
                  task.equipment));
}

std::optional<ordered_json> find_candidates(const Plan& plan, std::size_t number,
                                            const std::function<bool()>& stop) {
  const CandidateTask& task = plan.candidates[number];
  const PlannedSpacecraft& spacecraft = plan.spacecraft[task.spacecraft];
  const Config& config = plan.configurations[spacecraft.configuration];
  Database database(config.database, Database::Mode::read_only);
  const storage::Archive archive(database);
  const EquipmentConfig equipment =
      with_phase(equipment_of(plan, task), spacecraft.name, archive, storage::Registry(database));
  WindowCache kept = window_cache_of(spacecraft.name, equipment);
  ordered_json windows = ordered_json::array();
  for (const Time end : window_ends(archive, spacecraft.name, equipment, task.range)) {
    if (stop()) return std::nullopt;
    const RefreshRequest request{
        spacecraft.name, equipment, {end - equipment.window, end}, "backfill", config.digest};
    const PreparedWindow prepared =
        prepare_window(archive, request, kept, {}, [] { return false; });
    windows.push_back({{"begin_ns", request.window.begin},
                       {"end_ns", end},
                       {"found", to_json(found_window(prepared))}});
  }
  return ordered_json{{"plan", plan.digest}, {"task", number}, {"windows", std::move(windows)}};
}

/// What the tasks of a spacecraft found, of which only those that are asked for now are in memory.
class FoundWindows {
 public:
  FoundWindows(const Plan& plan, std::size_t spacecraft) : plan_(plan) {
    for (std::size_t i = 0; i < plan.candidates.size(); ++i)
      if (const CandidateTask& task = plan.candidates[i]; task.spacecraft == spacecraft) {
        if (!fs::exists(plan.file_of_candidates(i))) refuse_without(i);
        tasks_[{task.equipment, task.range.end}] = i;
      }
  }

  std::optional<FoundWindow> find(const RefreshRequest& request) {
    const auto found = tasks_.lower_bound({request.equipment.name, request.window.end});
    if (found == tasks_.end() || found->first.first != request.equipment.name) return std::nullopt;
    const std::shared_ptr<const ordered_json> result = result_of_task(found->second);
    for (const ordered_json& window : result->at("windows"))
      if (window.at("begin_ns") == request.window.begin &&
          window.at("end_ns") == request.window.end)
        return found_window_from_json(window.at("found"));
    return std::nullopt;
  }

 private:
  static constexpr std::size_t most_loaded = 8;

  [[noreturn]] static void refuse_without(std::size_t task) {
    throw std::runtime_error(fmt::format(
        "the result of candidates task {} is not there, or is damaged: run that task again", task));
  }

  std::shared_ptr<const ordered_json> result_of_task(std::size_t task) {
    const MutexLock lock(mutex_);
    if (const auto known = loaded_.find(task); known != loaded_.end()) return known->second;
    auto result = result_of(plan_, {TaskKind::candidates, task});
    if (!result) refuse_without(task);
    if (loaded_.size() >= most_loaded) loaded_.erase(loaded_.begin());
    return loaded_[task] = std::make_shared<const ordered_json>(*std::move(result));
  }

  const Plan& plan_;
  std::map<std::pair<std::string, Time>, std::size_t> tasks_;  // by the end of their last window
  Mutex mutex_;
  std::map<std::size_t, std::shared_ptr<const ordered_json>> loaded_ REIDENT_GUARDED_BY(mutex_);
};

/// A folder of this process alone, which goes with the object.
class OwnFolder {
 public:
  explicit OwnFolder(const fs::path& beside)
      : path_(beside.string() + "." + unique_program_name("reident")) {
    fs::create_directory(path_);
  }
  ~OwnFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::optional<ordered_json> judge_spacecraft(const Plan& plan, std::size_t number,
                                             WorkerPool& workers,
                                             const std::function<bool()>& stop) {
  const PlannedSpacecraft& spacecraft = plan.spacecraft[number];
  const Config& config = plan.configurations[spacecraft.configuration];
  FoundWindows found(plan, number);
  const OwnFolder folder(plan.registry_of(number));
  const fs::path file = folder.path() / "registry.db";
  ordered_json result = {{"plan", plan.digest}, {"name", spacecraft.name}};
  {
    Database registry(file, Database::Mode::read_write, storage::Durability::kill);
    BackfillRequest request;
    request.spacecraft = spacecraft.name;
    request.range = spacecraft.range;
    request.found = [&](const RefreshRequest& window) { return found.find(window); };
    // What is decided is decided when telemetry has reached it, whenever this runs.
    const BackfillProgress progress = backfill(
        registry, config, request, workers, [](Time reached) { return reached; },
        [&](const BackfillProgress&) { return !stop(); });
    if (progress.done < progress.windows) return std::nullopt;
    result["windows"] = progress.windows;
    result["approved"] = progress.approved;
    result["registry_sha256"] = registry_digest(registry);
    result["equipment"] = compare(registry, config, spacecraft.name, spacecraft.range);
  }
  result["registry_bytes"] = fs::file_size(file);
  fs::rename(file, plan.registry_of(number));
  return result;
}

/// Folders of judgements that were killed, and of twins that are not needed any more.
void clear_up_behind(const Plan& plan, TaskId judgement) {
  const fs::path registry = plan.registry_of(judgement.number);
  const std::string prefix = registry.filename().string() + ".";
  std::error_code ignored;
  for (fs::directory_iterator entry(registry.parent_path(), ignored), end; entry != end;
       entry.increment(ignored))
    if (entry->is_directory(ignored) && entry->path().filename().string().starts_with(prefix))
      fs::remove_all(entry->path(), ignored);
}

void keep_reason(const Plan& plan, TaskId task, const std::string& reason) {
  try {
    write_task_file(failure_file(plan, task), {{"reason", reason}, {"host", host_name()}});
  } catch (const std::runtime_error&) {
    // Where nothing can be written, whoever runs the task is told all the same.
  }
}

}  // namespace

std::string_view name(TaskKind kind) {
  return kind == TaskKind::candidates ? "candidates" : "judgement";
}

std::optional<ordered_json> result_of(const Plan& plan, TaskId task) {
  auto result = read_task_file(result_file(plan, task));
  if (!result || result->value("plan", "") != plan.digest) return std::nullopt;
  if (task.kind == TaskKind::judgement && !is_whole(plan.registry_of(task.number), *result))
    return std::nullopt;
  return result;
}

bool run_task(const Plan& plan, TaskId task, WorkerPool& workers,
              const std::function<bool()>& stop) {
  const std::size_t tasks =
      task.kind == TaskKind::candidates ? plan.candidates.size() : plan.spacecraft.size();
  if (task.number >= tasks)
    throw std::invalid_argument(fmt::format("there is no {} task {}: the sweep has 0 to {}",
                                            name(task.kind), task.number, tasks - 1));
  if (result_of(plan, task)) return true;
  if (plan.program_version != program_version())
    throw std::invalid_argument(
        fmt::format("the sweep in {} was planned by reident {}, and this is {}: results of two "
                    "programs do not go together; begin again in another folder",
                    plan.folder.string(), plan.program_version, program_version()));
  try {
    const auto result = task.kind == TaskKind::candidates
                            ? find_candidates(plan, task.number, stop)
                            : judge_spacecraft(plan, task.number, workers, stop);
    if (!result) return false;
    write_task_file(result_file(plan, task), *result);
  } catch (const std::exception& error) {
    if (result_of(plan, task)) return true;  // of a twin, which has cleared up behind itself
    keep_reason(plan, task, error.what());
    throw;
  }
  std::error_code ignored;
  fs::remove(failure_file(plan, task), ignored);
  if (task.kind == TaskKind::judgement) clear_up_behind(plan, task);
  return true;
}

TaskStates states(const Plan& plan, TaskKind kind) {
  TaskStates states;
  const std::size_t tasks =
      kind == TaskKind::candidates ? plan.candidates.size() : plan.spacecraft.size();
  for (std::size_t i = 0; i < tasks; ++i) {
    if (result_of(plan, {kind, i})) {
      ++states.done;
      continue;
    }
    states.left.push_back(i);
    if (const auto failure = read_task_file(failure_file(plan, {kind, i})))
      states.failures.push_back({i, failure->value("reason", "")});
  }
  return states;
}

}  // namespace reident::sweep
