#include "service/daemon/archive_keeper.hpp"

#include "service/operations/protected_telemetry.hpp"
#include "service/support/log.hpp"
#include "service/support/time_text.hpp"

namespace reident {

ArchiveKeeper::ArchiveKeeper(const Config& config, ArchiveWriter& writer, Clock clock)
    : config_(config),
      rule_{config.keep, config.max_size},
      writer_(writer),
      clock_(std::move(clock)) {}

void ArchiveKeeper::look() {
  if (rule_.keeps_everything() || is_running_) return;
  const storage::Time now = clock_();
  // A clock that was set back is no reason to wait.
  if (last_begin_ && now >= *last_begin_ && now - *last_begin_ < interval) return;
  last_begin_ = now;
  is_running_ = true;
  post_step();
}

void ArchiveKeeper::post_step() {
  writer_.post(
      [this](storage::Registry& registry, storage::Archive& archive) { step(registry, archive); });
}

std::vector<storage::ProtectedRange> ArchiveKeeper::protection(
    const storage::Registry& registry, const storage::Archive& archive) const {
  std::vector<storage::ProtectedRange> all = telemetry_of_versions(archive, registry);
  const auto needed = telemetry_still_needed(archive, config_, clock_());
  all.insert(all.end(), needed.begin(), needed.end());
  return all;
}

void ArchiveKeeper::step(const storage::Registry& registry, storage::Archive& archive) {
  try {
    // Decisions are made on this thread alone: none falls between this look and the step.
    const std::int64_t decision = registry.last_decision();
    if (!retention_)
      retention_.emplace(archive, rule_, protection(registry, archive), clock_());
    else if (decision != last_decision_)
      retention_->protect(protection(registry, archive));
    last_decision_ = decision;
    if (retention_->step()) return post_step();
    conclude(retention_->report());
  } catch (const storage::Error& error) {
    log::warning("archive", "old telemetry could not be removed; tried again in some minutes",
                 {{"error", error.what()}});
  }
  retention_.reset();
  is_running_ = false;
}

void ArchiveKeeper::conclude(const storage::RetentionReport& report) {
  if (report.chunks > 0)
    log::info("archive", "old telemetry removed",
              {{"samples", report.samples},
               {"first", time_text(*report.first)},
               {"last", time_text(*report.last)},
               {"bytes_in_use", report.bytes_in_use},
               {"protected_chunks", report.protected_chunks}});
  if (report.too_large && !was_too_large_)
    log::warning("archive",
                 "more room is in use than max_size, and what is left may not be removed: it is "
                 "what versions were identified from, what the next windows need, or no telemetry",
                 {{"bytes_in_use", report.bytes_in_use},
                  {"max_size", *rule_.max_bytes},
                  {"protected_chunks", report.protected_chunks}});
  was_too_large_ = report.too_large;
}

}  // namespace reident
