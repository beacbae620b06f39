// What is wrong with the telemetry that comes, or does not come: alarms, and a line in the log for
// telemetry that nobody uses.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "service/config/config.hpp"
#include "service/daemon/archive_writer.hpp"
#include "service/daemon/window_feed.hpp"
#include "service/support/mutex.hpp"

namespace reident {

/// Hears the archive's writer and passes on what it hears.
class TelemetryWatch : public ArchiveListener {
 public:
  /// Configuration and listener must outlive it.
  TelemetryWatch(const Config& config, Clock clock, Clock uptime, ArchiveListener& next);

  /// Takes up the parameters that earlier runs heard of, and when they wrote their last entry [ns];
  /// 0 where there is none. Call once, before the threads start.
  void recover(const storage::Archive& archive, storage::Time last_entry);
  /// A window was tried at a time, by this service or the other one of its pair.
  void tried(storage::Time time);

  void stored(const std::vector<storage::TelemetryFrame>& frames,
              const storage::AppendReport& report) override;
  void described(const std::vector<storage::ParameterDescriptor>& descriptors,
                 const storage::Archive& archive) override;

  /// What is wrong now: `no_telemetry` of an equipment for longer than its slide, `unknown_names`
  /// of an equipment or of a spacecraft that is not configured (of none where these are many),
  /// `clock` of a spacecraft whose telemetry is ahead, or of none where the clock is before the
  /// last entry. Their texts stay the same as long as nothing changes. For any thread.
  std::vector<storage::Alarm> alarms();

 private:
  struct Equipment {
    storage::EquipmentName name;
    const EquipmentConfig* config;
    std::vector<std::string> parameters;
    storage::Time heard;       // when telemetry of it came last, or the service started
    storage::Time heard_at{};  // the same, of the uptime
  };
  struct Spacecraft {
    std::map<std::uint32_t, std::string> names;  // of parameters, by id
    storage::Time described = 0;                 // when a new name came last, of the uptime
    bool is_settled = false;                     // the log has had what nobody uses
    std::optional<Duration> lead;                // of the clock; absent where it is not ahead
  };

  void note(const storage::ParameterDescriptor& descriptor) REIDENT_REQUIRES(mutex_);
  bool is_configured(const std::string& spacecraft) const;
  std::string unknown_text(const Equipment& equipment, const Spacecraft& spacecraft) const
      REIDENT_REQUIRES(mutex_);
  void log_unused(const std::string& name, const Spacecraft& spacecraft) const
      REIDENT_REQUIRES(mutex_);

  const Config& config_;
  const Clock clock_, uptime_;
  ArchiveListener& next_;
  mutable Mutex mutex_;
  storage::Time last_entry_ REIDENT_GUARDED_BY(mutex_) = 0;
  std::vector<Equipment> equipment_ REIDENT_GUARDED_BY(mutex_);
  std::map<std::string, Spacecraft> spacecraft_ REIDENT_GUARDED_BY(mutex_);
};

}  // namespace reident
