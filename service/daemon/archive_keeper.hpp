// Removes telemetry by the configured rule while the service runs.
#pragma once

#include <atomic>
#include <optional>

#include "service/config/config.hpp"
#include "service/daemon/archive_writer.hpp"
#include "service/daemon/window_feed.hpp"
#include "storage/care/retention.hpp"

namespace reident {

class ArchiveKeeper {
 public:
  /// Configuration and writer must outlive the keeper, and the keeper the writer's thread.
  ArchiveKeeper(const Config& config, ArchiveWriter& writer, Clock clock);

  /// Starts a retention where one is due: at the start of the service, and `interval` after the
  /// last one began. A retention is posted to the writer step by step, so that telemetry is stored
  /// in between.
  void look();

  static constexpr Duration interval = 5LL * 60 * 1'000'000'000;

 private:
  void post_step();
  void step(const storage::Registry& registry, storage::Archive& archive);
  std::vector<storage::ProtectedRange> protection(const storage::Registry& registry,
                                                  const storage::Archive& archive) const;
  void conclude(const storage::RetentionReport& report);

  const Config& config_;
  const storage::RetentionRule rule_;
  ArchiveWriter& writer_;
  const Clock clock_;
  std::optional<storage::Time> last_begin_;
  std::atomic<bool> is_running_ = false;

  // State of the retention, on the writer's thread.
  std::optional<storage::Retention> retention_;
  std::int64_t last_decision_ = 0;  // that the retention's protection knows of
  bool was_too_large_ = false;
};

}  // namespace reident
