// A queue between one producer thread and one consumer thread that waits instead of dropping.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "service/support/mutex.hpp"

namespace reident {

/// What an item counts as where a queue is bounded in bytes.
template <class T>
struct QueuedBytes {
  std::size_t operator()(const T&) const { return sizeof(T); }
};

template <class T>
class BoundedQueue {
 public:
  static constexpr std::size_t unbounded = std::numeric_limits<std::size_t>::max();

  /// Holds at most `capacity` items, and no more than `bytes` of them but for a single one.
  explicit BoundedQueue(std::size_t capacity, std::size_t bytes = unbounded)
      : capacity_(capacity), bytes_(bytes) {}

  /// Waits for room. False, with the item not taken, when the queue is closed.
  bool push(T&& item) {
    MutexLock lock(mutex_);
    return push_locked(std::move(item));
  }

  /// The same for each of `items`, which is empty afterwards. The consumer is woken once for all of
  /// them where there is room.
  bool push(std::vector<T>& items) {
    MutexLock lock(mutex_);
    for (T& item : items)
      if (!push_locked(std::move(item))) break;
    items.clear();
    return !closed_;
  }

  /// Moves up to `max` items to the end of `out`; waits up to `timeout` for the first of them, and
  /// then up to `gather` for the others, unless the producer has to wait. Returns how many there
  /// were.
  std::size_t pop(std::vector<T>& out, std::size_t max, std::chrono::nanoseconds timeout,
                  std::chrono::nanoseconds gather = std::chrono::nanoseconds(0)) {
    MutexLock lock(mutex_);
    wait_for_items(1, timeout);
    if (!items_.empty()) wait_for_items(max, gather);
    woken_ = false;
    std::size_t taken = 0;
    for (; taken < max && !items_.empty(); ++taken) {
      held_bytes_ -= QueuedBytes<T>()(items_.front());
      out.push_back(std::move(items_.front()));
      items_.pop_front();
    }
    if (taken > 0) {
      held_back_ = false;
      room_.notify_all();
    }
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
  bool has_room_for(std::size_t bytes) const REIDENT_REQUIRES(mutex_) {
    return items_.empty() ||
           (items_.size() < capacity_ && held_bytes_ <= bytes_ && bytes <= bytes_ - held_bytes_);
  }

  bool push_locked(T&& item) REIDENT_REQUIRES(mutex_) {
    const std::size_t bytes = QueuedBytes<T>()(item);
    if (!has_room_for(bytes) && !closed_) ++waits_;
    while (!has_room_for(bytes) && !closed_) {
      held_back_ = true;
      ready_.notify_one();
      room_.wait(mutex_);
    }
    if (closed_) return false;
    items_.push_back(std::move(item));
    held_bytes_ += bytes;
    // A consumer that gathers sleeps on until it has what it wants.
    if (items_.size() == wanted_) ready_.notify_one();
    return true;
  }

  void wait_for_items(std::size_t count, std::chrono::nanoseconds timeout)
      REIDENT_REQUIRES(mutex_) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    wanted_ = count;
    while (items_.size() < count && !held_back_ && !closed_ && !woken_) {
      const auto left = deadline - std::chrono::steady_clock::now();
      if (left <= std::chrono::nanoseconds(0)) break;
      ready_.wait_for(mutex_, left);
    }
    wanted_ = 0;
  }

  const std::size_t capacity_;
  const std::size_t bytes_;
  mutable Mutex mutex_;
  CondVar room_, ready_;
  std::deque<T> items_ REIDENT_GUARDED_BY(mutex_);
  std::size_t held_bytes_ REIDENT_GUARDED_BY(mutex_) = 0;
  std::size_t wanted_ REIDENT_GUARDED_BY(mutex_) = 0;  // items that pop waits for
  std::uint64_t waits_ REIDENT_GUARDED_BY(mutex_) = 0;
  bool held_back_ REIDENT_GUARDED_BY(mutex_) = false;  // push waits for room
  bool closed_ REIDENT_GUARDED_BY(mutex_) = false;
  bool woken_ REIDENT_GUARDED_BY(mutex_) = false;
};

}  // namespace reident
