// The one thread that writes the database: telemetry from the queue, and what others post.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <future>
#include <string>
#include <variant>
#include <vector>

#include "service/config/config.hpp"
#include "service/daemon/bounded_queue.hpp"
#include "service/support/mutex.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

using TelemetryEvent = std::variant<storage::TelemetryFrame, storage::ParameterDescriptor>;

/// A frame's samples are nearly all of it.
template <>
struct QueuedBytes<TelemetryEvent> {
  std::size_t operator()(const TelemetryEvent& event) const;
};

/// Hears, on the writer's thread, what has been committed.
class ArchiveListener {
 public:
  virtual ~ArchiveListener() = default;
  virtual void stored(const std::vector<storage::TelemetryFrame>& frames,
                      const storage::AppendReport& report) = 0;
  virtual void described(const std::vector<storage::ParameterDescriptor>& descriptors,
                         const storage::Archive& archive) = 0;
};

class ArchiveWriter {
 public:
  /// The queue and the listener must outlive the writer.
  ArchiveWriter(storage::Database&& database, const storage::ArchiveOptions& options,
                BoundedQueue<TelemetryEvent>& queue, std::size_t batch_frames, Duration batch_delay,
                ArchiveListener& listener);

  /// The thread's body: until the queue is closed and drained. While a batch cannot be stored (no
  /// room, an I/O error, a file that was taken away or is damaged) it is kept and tried again each
  /// second, and the queue's bound holds the sources back; `give_up` ends that, and the frames that
  /// then stay behind are counted in lost().
  void run(const std::atomic<bool>& give_up);

  /// Runs `task` on the writer's thread before the next batch; the future holds its exception. A
  /// task posted after run() returned is never run, and its future is broken.
  std::future<void> post(std::function<void(storage::Registry&, storage::Archive&)> task);

  struct Counts {
    std::uint64_t stored = 0;
    std::uint64_t duplicates = 0;
    std::uint64_t conflicts = 0;
    std::uint64_t late = 0;
    std::uint64_t lost = 0;              // frames given up at the end
    std::uint64_t sequence_missing = 0;  // of all sources, since the archive was made
    std::string last_error;              // empty when the last batch was stored
    std::string last_damage;             // what the archive set aside last since the start
    std::string postponed;               // the shard that late samples wait for, and the remedy
  };
  Counts counts() const;
  /// Events queued or taken from the queue and not yet committed.
  std::size_t backlog() const { return queue_.size() + in_hand_; }
  /// Whether the thread came round since the last call: to the next batch, or to one that the disk
  /// refused. One that hangs does not.
  bool goes_on() { return came_round_.exchange(false); }

 private:
  using Task = std::packaged_task<void(storage::Registry&, storage::Archive&)>;

  void run_tasks();
  /// Waits until the batch is full, the queue is, or `batch_delay` has passed since its first
  /// event.
  std::vector<TelemetryEvent> next_batch();
  void store(std::vector<TelemetryEvent>&& batch, const std::atomic<bool>& give_up);
  void commit(const std::vector<storage::TelemetryFrame>& frames,
              const std::vector<storage::ParameterDescriptor>& descriptors);

  storage::Database database_;
  storage::Archive archive_;
  storage::Registry registry_;
  BoundedQueue<TelemetryEvent>& queue_;
  const std::size_t batch_frames_;
  const Duration batch_delay_;
  ArchiveListener& listener_;
  std::atomic<std::size_t> in_hand_ = 0;
  std::atomic<bool> came_round_ = false;

  mutable Mutex mutex_;
  CondVar tasks_changed_;
  std::deque<Task> tasks_ REIDENT_GUARDED_BY(mutex_);
  bool ended_ REIDENT_GUARDED_BY(mutex_) = false;
  Counts counts_ REIDENT_GUARDED_BY(mutex_);
};

}  // namespace reident
