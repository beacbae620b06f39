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

/// A mutex that is not recursive. Lock it by MutexLock; lock() and unlock() are for code that lets
/// go of it in the middle of a scope.
class REIDENT_THREAD_ANNOTATION(capability("mutex")) Mutex {
 public:
  void lock() REIDENT_THREAD_ANNOTATION(acquire_capability()) { mutex_.lock(); }
  void unlock() REIDENT_THREAD_ANNOTATION(release_capability()) { mutex_.unlock(); }

 private:
  std::mutex mutex_;
};

/// Holds the mutex, which has to outlive it, for a scope.
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
/// There is no wait with a predicate: a lambda would be analysed as code without the lock.
class CondVar {
 public:
  /// Returns with the mutex held, after a notification or without any.
  void wait(Mutex& mutex) REIDENT_REQUIRES(mutex) { condition_.wait(mutex); }
  /// Returns with the mutex held; false when `timeout` [ns] passed.
  bool wait_for(Mutex& mutex, std::chrono::nanoseconds timeout) REIDENT_REQUIRES(mutex) {
    return condition_.wait_for(mutex, timeout) == std::cv_status::no_timeout;
  }
  void notify_one() { condition_.notify_one(); }
  void notify_all() { condition_.notify_all(); }

 private:
  std::condition_variable_any condition_;
};

}  // namespace reident
