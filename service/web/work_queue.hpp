// What waits for a thread, so much at most: who comes later is sent away at once.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "service/support/mutex.hpp"

namespace reident::web {

/// Any number of threads put work in and take it out.
template <class Work>
class WorkQueue {
 public:
  explicit WorkQueue(std::size_t most) : most_(most) {}

  /// False, with the work not taken, where so much waits already.
  bool offer(Work&& work) {
    const MutexLock lock(mutex_);
    if (waiting_.size() >= most_) return false;
    waiting_.push_back(std::move(work));
    more_.notify_one();
    return true;
  }

  /// Waits for work. Absent once the queue is closed, whatever still waits.
  std::optional<Work> next() {
    const MutexLock lock(mutex_);
    while (!closed_ && waiting_.empty()) more_.wait(mutex_);
    if (closed_) return std::nullopt;
    std::optional<Work> work(std::move(waiting_.front()));
    waiting_.pop_front();
    return work;
  }

  void close() {
    const MutexLock lock(mutex_);
    closed_ = true;
    more_.notify_all();
  }
  bool is_closed() const {
    const MutexLock lock(mutex_);
    return closed_;
  }

 private:
  const std::size_t most_;
  mutable Mutex mutex_;
  CondVar more_;
  bool closed_ REIDENT_GUARDED_BY(mutex_) = false;
  std::deque<Work> waiting_ REIDENT_GUARDED_BY(mutex_);
};

}  // namespace reident::web
