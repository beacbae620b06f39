#include "service/support/parallel.hpp"

#include <algorithm>
#include <cassert>
#include <exception>
#include <pthread.h>
#include <sched.h>
#include <system_error>
#include <thread>
#include <utility>

#include "service/support/mutex.hpp"

namespace reident {

/// Lives on its caller's stack; guarded by the pool's mutex.
struct WorkerPool::Call {
  Call(std::size_t task_count, const std::function<void(std::size_t)>& run)
      : task(run), count(task_count) {}
  bool has_tasks_left() const { return next < count; }

  const std::function<void(std::size_t)>& task;
  std::size_t count;
  std::size_t next = 0;  // tasks begin in order, so that of those that throw the first has begun
  std::size_t running = 0;
  std::size_t failed = 0;  // where `failure` is set: the task that threw it
  std::exception_ptr failure;
  CondVar none_running;
};

WorkerPool::WorkerPool(std::size_t threads) {
  assert(threads >= 1);
  threads_.reserve(threads - 1);
  try {
    while (threads_.size() + 1 < threads) threads_.emplace_back([this] { help_until_stopped(); });
  } catch (const std::system_error&) {  // no more threads: the work is done by those that there are
  }
}

WorkerPool::~WorkerPool() {
  {
    const MutexLock lock(mutex_);
    assert(calls_.empty());
    stopped_ = true;
    work_or_stop_.notify_all();
  }
  for (std::thread& thread : threads_) thread.join();
}

void WorkerPool::for_each(std::size_t count, const std::function<void(std::size_t)>& task) {
  Call call(count, task);
  {
    const MutexLock lock(mutex_);
    calls_.push_back(&call);
    if (count > 1) work_or_stop_.notify_all();
    run_tasks(call);
    while (call.running > 0) call.none_running.wait(mutex_);
    std::erase(calls_, &call);
  }
  if (call.failure) std::rethrow_exception(call.failure);
}

void WorkerPool::run_tasks(Call& call) {
  while (call.has_tasks_left()) {
    const std::size_t index = call.next++;
    ++call.running;
    mutex_.unlock();
    std::exception_ptr failure;
    try {
      call.task(index);
    } catch (...) {
      failure = std::current_exception();
    }
    mutex_.lock();
    if (failure && (!call.failure || index < call.failed)) {
      call.failed = index;
      call.failure = std::move(failure);
      call.next = call.count;
    }
    if (--call.running == 0) call.none_running.notify_one();
  }
}

WorkerPool::Call* WorkerPool::oldest_call() const {
  const auto found = std::find_if(calls_.begin(), calls_.end(),
                                  [](const Call* call) { return call->has_tasks_left(); });
  return found == calls_.end() ? nullptr : *found;
}

void WorkerPool::help_until_stopped() {
  pthread_setname_np(pthread_self(), "worker");  // for top, perf and debuggers
  const MutexLock lock(mutex_);
  while (!stopped_) {
    if (Call* call = oldest_call()) {
      run_tasks(*call);
    } else {
      work_or_stop_.wait(mutex_);
    }
  }
}

std::size_t usable_cores() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (::sched_getaffinity(0, sizeof allowed, &allowed) == 0)
    return std::max<std::size_t>(1, static_cast<std::size_t>(CPU_COUNT(&allowed)));
  return std::max<std::size_t>(1, std::thread::hardware_concurrency());  // above 1024 cores
}

}  // namespace reident
