// Threads that share out the tasks of loops whose iterations are independent.
#pragma once

#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

#include "service/support/mutex.hpp"

namespace reident {

/// Keeps its threads between calls. Any number of threads may call at the same time, and a task may
/// call again: each caller works on its own tasks, and the threads here help the oldest call that
/// has tasks left.
class WorkerPool {
 public:
  /// `threads` >= 1, the caller's included: starts threads - 1 of its own, or as many of them as
  /// the machine gives. They block the signals that the calling thread blocks.
  explicit WorkerPool(std::size_t threads);
  /// No call may be running.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Runs task(0), ..., task(count - 1) in any order, and returns when all are done. After a task
  /// throws no further one begins; when those that had begun have ended, the exception that a plain
  /// loop would have met is rethrown. `task` is called from several threads at the same time. A
  /// task must not wait for another one of the same call, since one thread may run them all.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& task);

 private:
  struct Call;

  void help_until_stopped();
  /// Runs tasks of the call until none is left to begin; unlocks while one runs.
  void run_tasks(Call& call) REIDENT_REQUIRES(mutex_);
  /// The oldest call that has tasks left to begin, or null.
  Call* oldest_call() const REIDENT_REQUIRES(mutex_);

  mutable Mutex mutex_;
  CondVar work_or_stop_;
  std::vector<Call*> calls_ REIDENT_GUARDED_BY(mutex_);  // oldest first
  bool stopped_ REIDENT_GUARDED_BY(mutex_) = false;
  std::vector<std::thread> threads_;
};

/// Returns how many cores the calling thread may use by its CPU affinity, as taskset, systemd's
/// CPUAffinity or a container's cpuset give it; at least 1.
std::size_t usable_cores();

}  // namespace reident
