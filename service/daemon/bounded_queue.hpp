// A queue between one producer thread and one consumer thread that waits instead of dropping.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "service/support/mutex.hpp"

namespace reident {

/// What an item counts as where a queue is bounded in bytes.
template <class T>
struct QueuedBytes {
  std::size_t operator()(const T&) const { return sizeof(T); }
};

/// So many items, and no more than `bytes` of them but for a single one.
struct QueueBound {
  QueueBound(std::size_t most_items,
             std::size_t most_bytes = std::numeric_limits<std::size_t>::max())
      : items(most_items), bytes(most_bytes) {}
  std::size_t items;
  std::size_t bytes;
};

template <class T>
class BoundedQueue {
 public:
  explicit BoundedQueue(QueueBound bound) : bound_(bound) {}

  /// Waits for room. False, with the item not taken, when the queue is closed.
  bool push(T&& item) {
    MutexLock lock(mutex_);
    return push_locked(std::move(item));
  }

  /// Pushes each of `items`, which is empty afterwards. The consumer is woken once for all of
  /// them where there is room.
  bool push(std::vector<T>& items) {
    MutexLock lock(mutex_);
    for (T& item : items)
      if (!push_locked(std::move(item))) break;
    items.clear();
    return !closed_;
  }

  /// Moves up to `most` to the end of `out`; waits up to `timeout` for the first item, and then up
  /// to `gather` for the others, unless the producer has to wait. Returns how many there were.
  std::size_t pop(std::vector<T>& out, QueueBound most, std::chrono::nanoseconds timeout,
                  std::chrono::nanoseconds gather = std::chrono::nanoseconds(0)) {
    MutexLock lock(mutex_);
    wait_for(1, timeout);
    if (!items_.empty()) wait_for(most, gather);
    woken_ = false;
    std::size_t taken = 0;
    for (std::size_t bytes = 0; taken < most.items && !items_.empty(); ++taken) {
      const std::size_t more = QueuedBytes<T>()(items_.front());
      if (taken > 0 && (bytes > most.bytes || more > most.bytes - bytes)) break;
      bytes += more;
      held_bytes_ -= more;
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
    return items_.empty() || (items_.size() < bound_.items && held_bytes_ <= bound_.bytes &&
                              bytes <= bound_.bytes - held_bytes_);
  }
  bool has(QueueBound wanted) const REIDENT_REQUIRES(mutex_) {
    return items_.size() >= wanted.items || held_bytes_ >= wanted.bytes;
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
    if (wanted_ && has(*wanted_)) {
      wanted_.reset();
      ready_.notify_one();
    }
    return true;
  }

  void wait_for(QueueBound wanted, std::chrono::nanoseconds timeout) REIDENT_REQUIRES(mutex_) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (!has(wanted) && !held_back_ && !closed_ && !woken_) {
      const auto left = deadline - std::chrono::steady_clock::now();
      if (left <= std::chrono::nanoseconds(0)) break;
      wanted_ = wanted;
      ready_.wait_for(mutex_, left);
    }
    wanted_.reset();
  }

  const QueueBound bound_;
  mutable Mutex mutex_;
  CondVar room_, ready_;
  std::deque<T> items_ REIDENT_GUARDED_BY(mutex_);
  std::size_t held_bytes_ REIDENT_GUARDED_BY(mutex_) = 0;
  std::optional<QueueBound> wanted_ REIDENT_GUARDED_BY(mutex_);  // what pop waits for
  std::uint64_t waits_ REIDENT_GUARDED_BY(mutex_) = 0;
  bool held_back_ REIDENT_GUARDED_BY(mutex_) = false;  // push waits for room
  bool closed_ REIDENT_GUARDED_BY(mutex_) = false;
  bool woken_ REIDENT_GUARDED_BY(mutex_) = false;
};

}  // namespace reident
