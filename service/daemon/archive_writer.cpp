#include "service/daemon/archive_writer.hpp"

#include <chrono>
#include <thread>

#include "service/support/log.hpp"

namespace reident {
namespace {

using namespace std::chrono_literals;

// Larger transactions are no faster, and what comes next waits for them longer.
constexpr std::size_t batch_bytes = std::size_t{5} << 20;
constexpr auto idle_wait = 2s;   // for the first event of a batch; post() ends it earlier
constexpr auto retry_wait = 1s;  // between two tries of a batch that the disk refused

void log_late_start(const storage::AppendReport::LateStart& start) {
  if (start.first == 0)
    log::info("archive", "the first sequence number of a source here is not 1",
              {{"spacecraft", start.spacecraft},
               {"source", start.source},
               {"first_sequence", start.came}});
  else
    log::warning("archive", "the first frames of a source have not come; have them sent again",
                 {{"spacecraft", start.spacecraft},
                  {"source", start.source},
                  {"first_sequence", start.came},
                  {"missing", start.came - start.first}});
}

}  // namespace

std::size_t QueuedBytes<TelemetryEvent>::operator()(const TelemetryEvent& event) const {
  const auto* frame = std::get_if<storage::TelemetryFrame>(&event);
  return sizeof(TelemetryEvent) +
         (frame ? frame->samples.capacity() * sizeof(storage::Sample) : std::size_t{0});
}

ArchiveWriter::ArchiveWriter(storage::Database&& database, const storage::ArchiveOptions& options,
                             BoundedQueue<TelemetryEvent>& queue, std::size_t batch_frames,
                             Duration batch_delay, ArchiveListener& listener)
    : database_(std::move(database)),
      archive_(database_, options),
      registry_(database_),
      queue_(queue),
      batch_frames_(batch_frames),
      batch_delay_(batch_delay),
      listener_(listener) {}

std::future<void> ArchiveWriter::post(
    std::function<void(storage::Registry&, storage::Archive&)> task) {
  Task packaged(std::move(task));
  auto future = packaged.get_future();
  {
    MutexLock lock(mutex_);
    if (ended_) return future;  // `packaged` goes and breaks the promise
    tasks_.push_back(std::move(packaged));
    tasks_changed_.notify_one();
  }
  queue_.wake();
  return future;
}

ArchiveWriter::Counts ArchiveWriter::counts() const {
  MutexLock lock(mutex_);
  return counts_;
}

void ArchiveWriter::run_tasks() {
  std::deque<Task> tasks;
  {
    MutexLock lock(mutex_);
    tasks.swap(tasks_);
  }
  for (Task& task : tasks) task(registry_, archive_);
}

std::vector<TelemetryEvent> ArchiveWriter::next_batch() {
  std::vector<TelemetryEvent> batch;
  in_hand_ = queue_.pop(batch, {batch_frames_, batch_bytes}, idle_wait,
                        std::chrono::nanoseconds(batch_delay_));
  return batch;
}

void ArchiveWriter::commit(const std::vector<storage::TelemetryFrame>& frames,
                           const std::vector<storage::ParameterDescriptor>& descriptors) {
  if (!descriptors.empty()) {
    archive_.describe(descriptors);
    listener_.described(descriptors, archive_);
  }
  if (frames.empty()) return;
  const storage::AppendReport report = archive_.append(frames);
  for (const std::string& damage : report.damages)
    log::error("archive", "set damaged samples aside", {{"error", damage}});
  for (const auto& start : report.late_starts) log_late_start(start);
  std::uint64_t missing = 0;
  for (const storage::SourceCounts& source : archive_.sources()) missing += source.missing;
  {
    MutexLock lock(mutex_);
    counts_.stored += report.stored;
    counts_.duplicates += report.duplicates;
    counts_.conflicts += report.conflicts;
    counts_.late += report.late;
    counts_.sequence_missing = missing;
    if (!report.damages.empty()) counts_.last_damage = report.damages.back();
    if (counts_.postponed.empty() && !report.postponed.empty())
      log::error("archive", "late samples wait for a shard", {{"error", report.postponed}});
    counts_.postponed = report.postponed;
  }
  listener_.stored(frames, report);
}

void ArchiveWriter::store(std::vector<TelemetryEvent>&& batch, const std::atomic<bool>& give_up) {
  std::vector<storage::TelemetryFrame> frames;
  std::vector<storage::ParameterDescriptor> descriptors;
  for (TelemetryEvent& event : batch) {
    if (auto* frame = std::get_if<storage::TelemetryFrame>(&event))
      frames.push_back(std::move(*frame));
    else
      descriptors.push_back(std::get<storage::ParameterDescriptor>(std::move(event)));
  }
  while (true) {
    came_round_ = true;
    try {
      commit(frames, descriptors);
      MutexLock lock(mutex_);
      if (!counts_.last_error.empty())
        log::info("archive", "storing again", {{"frames", frames.size()}});
      counts_.last_error.clear();
      return;
    } catch (const storage::Error& error) {
      MutexLock lock(mutex_);
      if (counts_.last_error.empty())
        log::error("archive", "cannot store telemetry; it is kept and tried again each second",
                   {{"error", error.what()}, {"frames", frames.size()}});
      counts_.last_error = error.what();
      if (give_up) {
        counts_.lost += frames.size();
        return;
      }
      tasks_changed_.wait_for(mutex_, retry_wait);
    }
    run_tasks();  // alarms say what is wrong, retention makes room
  }
}

void ArchiveWriter::run(const std::atomic<bool>& give_up) {
  struct End {
    ArchiveWriter& writer;
    ~End() {
      std::deque<Task> left;
      MutexLock lock(writer.mutex_);
      writer.ended_ = true;
      left.swap(writer.tasks_);
    }
  } end{*this};
  while (!queue_.drained()) {
    came_round_ = true;
    run_tasks();
    auto batch = next_batch();
    if (!batch.empty()) store(std::move(batch), give_up);
    in_hand_ = 0;
  }
  run_tasks();
}

}  // namespace reident
