// From committed telemetry to windows: the scheduler behind its lock, fed by the archive's writer
// and asked by the identification threads.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "service/config/config.hpp"
#include "service/daemon/archive_writer.hpp"
#include "service/daemon/window_scheduler.hpp"
#include "service/support/mutex.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

/// Nanoseconds; given in from outside so that tests own it. A service has two: UTC, nanoseconds
/// since 1970, which may be set forward and back, and `uptime`, by which it waits.
using Clock = std::function<storage::Time()>;

class WindowFeed : public ArchiveListener {
 public:
  struct Job {
    WindowScheduler::Job window;
    const std::string* spacecraft = nullptr;
    const EquipmentConfig* equipment = nullptr;
    /// Where samples of the equipment were stored since its last job: what is kept of them is old.
    std::vector<storage::TimeRange> changed;
  };

  /// The configuration must outlive the feed.
  WindowFeed(const Config& config, Clock clock, Clock uptime);

  /// Takes up what an earlier run left: windows that were never tried although their telemetry is
  /// stored, and those that late telemetry has touched since. Call once, before the threads start.
  void recover(const storage::Archive& archive, const storage::Registry& registry);

  void stored(const std::vector<storage::TelemetryFrame>& frames,
              const storage::AppendReport& report) override;
  void described(const std::vector<storage::ParameterDescriptor>& descriptors,
                 const storage::Archive& archive) override;

  /// Asks for a window of an equipment: the one given, or that which ends where its telemetry ends
  /// by now. Returns its end; absent where no telemetry of such an equipment has come.
  std::optional<storage::Time> ask(const std::string& spacecraft, const std::string& equipment,
                                   const std::string& cause,
                                   std::optional<storage::TimeRange> window = std::nullopt);

  /// Waits for a window that is due. Absent after stop().
  std::optional<Job> next();
  /// A window that is due now; absent where none is.
  std::optional<Job> next_due();
  void finished(const Job& job, bool completed);
  /// While paused there is no window and no telemetry to wait for; what comes is remembered.
  void pause(bool is_paused);
  /// The other service of the pair has tried a window.
  void tried_elsewhere(const storage::EquipmentName& equipment, storage::TimeRange window);
  void stop();

  /// Forgets the archive's marks of late telemetry that no window has to be looked at for any more.
  /// Call on the writer's thread.
  void forget_settled(const std::string& spacecraft, storage::Archive& archive);

  /// Waits until telemetry was stored since the last call with the same `seen`, which begins at 0.
  /// False after stop().
  bool wait_for_telemetry(std::uint64_t& seen);
  /// Where the telemetry of an equipment, by its position in the configuration, ends by now; or the
  /// end of the first window that has still to be tried, so that a version meets all telemetry that
  /// follows it in the same order, however fast that comes.
  storage::Time tried_until(std::size_t equipment) const;

  std::size_t pending() const;
  storage::Time newest_telemetry() const;
  /// Frames whose generation time was ahead of the clock by more than the configuration allows.
  std::uint64_t clock_jumps() const { return clock_jumps_; }

 private:
  struct Equipment {
    std::string spacecraft;
    const EquipmentConfig* config = nullptr;
    std::vector<std::string> parameters;    // that its signals are, or are computed from
    storage::Time tried_until = INT64_MIN;  // end of the latest window tried in earlier runs
  };
  using EquipmentIds = std::vector<std::size_t>;
  /// Equipment that a parameter belongs to, by spacecraft and parameter id.
  using Membership = std::map<std::string, std::unordered_map<std::uint32_t, EquipmentIds>>;

  std::optional<Job> take_due(storage::Time now) REIDENT_REQUIRES(mutex_);
  const EquipmentIds* members(const std::string& spacecraft, std::uint32_t parameter) const
      REIDENT_REQUIRES(mutex_);
  /// Makes the parameter known to the equipment that names it, and touches the windows that were
  /// stored before it was described.
  void join(const storage::ParameterDescriptor& descriptor, const storage::Archive& archive)
      REIDENT_REQUIRES(mutex_);
  /// Touches each range of `slide` in `range` that holds a stored sample of the parameter. Where
  /// the archive cannot be read the log says so: neither start nor ingest depends on it.
  void touch_stored(std::size_t equipment, const std::string& spacecraft, std::uint32_t parameter,
                    storage::TimeRange range, const storage::Archive& archive)
      REIDENT_REQUIRES(mutex_);
  void touch_each_slide(std::size_t equipment, const std::string& spacecraft,
                        std::uint32_t parameter, storage::TimeRange range,
                        const storage::Archive& archive) REIDENT_REQUIRES(mutex_);
  /// Remembers in few ranges, which may cover more than was stored.
  static void remember(std::vector<storage::TimeRange>& changed, storage::TimeRange range);
  bool is_jump(storage::Time time, storage::Time now) const {
    return time > now && time - now > max_clock_lead_;
  }

  const Clock clock_, uptime_;
  const Duration max_clock_lead_;
  std::vector<Equipment> equipment_;
  std::atomic<std::uint64_t> clock_jumps_ = 0;

  mutable Mutex mutex_;
  CondVar changed_;
  WindowScheduler scheduler_ REIDENT_GUARDED_BY(mutex_);
  /// By equipment: where samples were stored since its last job.
  std::vector<std::vector<storage::TimeRange>> altered_ REIDENT_GUARDED_BY(mutex_);
  Membership membership_ REIDENT_GUARDED_BY(mutex_);
  storage::Time newest_ REIDENT_GUARDED_BY(mutex_) = 0;
  std::uint64_t batches_ REIDENT_GUARDED_BY(mutex_) = 0;
  bool paused_ REIDENT_GUARDED_BY(mutex_) = false;
  bool stopped_ REIDENT_GUARDED_BY(mutex_) = false;
};

}  // namespace reident
