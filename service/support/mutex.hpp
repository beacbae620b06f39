// Mutex, lock and condition variable that clang's thread-safety analysis understands: what a mutex
// guards is said at the member (REIDENT_GUARDED_BY) and checked when the lint test compiles with
// clang. Under g++ the annotations are empty.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

#if defined(__clang__)
#define REIDENT_THREAD_ANNOTATION(x) __attribute__((x))
#else
#define REIDENT_THREAD_ANNOTATION(x)
#endif
#define REIDENT_GUARDED_BY(mutex) REIDENT_THREAD_ANNOTATION(guarded_by(mutex))
#define REIDENT_REQUIRES(mutex) REIDENT_THREAD_ANNOTATION(requires_capability(mutex))

namespace reident {

class REIDENT_THREAD_ANNOTATION(capability("mutex")) Mutex {
 public:
  void lock() REIDENT_THREAD_ANNOTATION(acquire_capability()) { mutex_.lock(); }
  void unlock() REIDENT_THREAD_ANNOTATION(release_capability()) { mutex_.unlock(); }

 private:
  std::mutex mutex_;
};

class REIDENT_THREAD_ANNOTATION(scoped_lockable) MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) REIDENT_THREAD_ANNOTATION(acquire_capability(mutex))
      : mutex_(mutex) {
    mutex_.lock();
  }
  ~MutexLock() REIDENT_THREAD_ANNOTATION(release_capability()) { mutex_.unlock(); }
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

 private:
  Mutex& mutex_;
};

/// Waits in a loop at the call site, so that the analysis sees the condition read under the lock.
class CondVar {
 public:
  void wait(Mutex& mutex) REIDENT_REQUIRES(mutex) { condition_.wait(mutex); }
  /// False when `timeout` passed.
  bool wait_for(Mutex& mutex, std::chrono::nanoseconds timeout) REIDENT_REQUIRES(mutex) {
    return condition_.wait_for(mutex, timeout) == std::cv_status::no_timeout;
  }
  void notify_one() { condition_.notify_one(); }
  void notify_all() { condition_.notify_all(); }

 private:
  std::condition_variable_any condition_;
};

}  // namespace reident
