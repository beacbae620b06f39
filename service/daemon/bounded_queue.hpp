// A queue between one producer thread and one consumer thread that waits instead of dropping.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "service/support/mutex.hpp"

namespace reident {

template <class T>
class BoundedQueue {
 public:
  explicit BoundedQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Waits for room. False, with the item not taken, when the queue is closed.
  bool push(T&& item) {
    MutexLock lock(mutex_);
    if (items_.size() >= capacity_ && !closed_) ++waits_;
    while (items_.size() >= capacity_ && !closed_) room_.wait(mutex_);
    if (closed_) return false;
    items_.push_back(std::move(item));
    ready_.notify_one();
    return true;
  }

  /// Moves up to `max` items to the end of `out`; waits up to `timeout` for the first of them.
  /// Returns how many there were.
  std::size_t pop(std::vector<T>& out, std::size_t max, std::chrono::nanoseconds timeout) {
    MutexLock lock(mutex_);
    if (items_.empty() && !closed_ && !woken_) ready_.wait_for(mutex_, timeout);
    woken_ = false;
    std::size_t taken = 0;
    for (; taken < max && !items_.empty(); ++taken) {
      out.push_back(std::move(items_.front()));
      items_.pop_front();
    }
    if (taken > 0) room_.notify_all();
    return taken;
  }

  /// Ends the running or the next wait of pop.
  void wake() {
    MutexLock lock(mutex_);
    woken_ = true;
    ready_.notify_one();
  }

  /// No further item is accepted; what is queued can still be popped.
  void close() {
    MutexLock lock(mutex_);
    closed_ = true;
    room_.notify_all();
    ready_.notify_all();
  }

  std::size_t size() const {
    MutexLock lock(mutex_);
    return items_.size();
  }
  /// Times that push had to wait for room.
  std::uint64_t waits() const {
    MutexLock lock(mutex_);
    return waits_;
  }
  bool drained() const {
    MutexLock lock(mutex_);
    return closed_ && items_.empty();
  }

 private:
  const std::size_t capacity_;
  mutable Mutex mutex_;
  CondVar room_, ready_;
  std::deque<T> items_ REIDENT_GUARDED_BY(mutex_);
  std::uint64_t waits_ REIDENT_GUARDED_BY(mutex_) = 0;
  bool closed_ REIDENT_GUARDED_BY(mutex_) = false;
  bool woken_ REIDENT_GUARDED_BY(mutex_) = false;
};

}  // namespace reident
