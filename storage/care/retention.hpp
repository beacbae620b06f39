// How long telemetry is kept, and in how much room.
//
// What is removed are whole chunks, the oldest first, of every series. Chunks that hold time of a
// protected range stay, and so do samples that are not in chunks yet. What was removed is
// recorded in the table `removal`. Pages that become free are used again; the file does not shrink.
// A shard of which nothing is left is removed when the next retention begins.
// What has to be protected is the caller's to say: storage cannot read models.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "storage/archive/archive.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// How much is kept. Without either limit everything is.
struct RetentionRule {
  /// Telemetry older than this [ns] goes. Age is counted back from the spacecraft's newest sample,
  /// or from the clock where that is earlier: what nothing newer follows stays.
  std::optional<Time> keep{};
  /// The oldest telemetry goes until the pages in use are not more bytes than this.
  std::optional<std::uint64_t> max_bytes{};

  bool keeps_everything() const { return !keep && !max_bytes; }
};

/// Telemetry that stays, of both origins.
struct ProtectedRange {
  std::string spacecraft;
  /// Absent: of every parameter.
  std::optional<std::uint32_t> parameter;
  TimeRange range;
};

/// What was removed, or would be. Counts of a Retention add up over its steps.
struct RetentionReport {
  /// Chunks that were removed or would be, with their samples and bytes.
  std::uint64_t chunks = 0;
  std::uint64_t samples = 0;
  std::uint64_t bytes = 0;
  std::optional<Time> first{}, last{};  // generation times of the samples
  /// Chunks that were passed over because they are protected.
  std::uint64_t protected_chunks = 0;
  std::uint64_t bytes_in_use = 0;  // of the file's pages, at the end
  /// Still more than the rule allows, with nothing left that may go.
  bool too_large = false;
};

/// Returns what a rule would remove now, and removes nothing; works on a database opened for
/// reading. `now` is the clock [ns]. Samples that are not in chunks yet are left out, and the room
/// that would be left is an estimate.
RetentionReport plan_retention(Database& database, const RetentionRule& rule,
                               const std::vector<ProtectedRange>& protection, Time now);

class ChunkWalk;

/// Removes by one rule, a bounded step at a time, so that others write in between. It belongs to
/// the archive's thread. The archive's database is opened for writing, and the archive outlives it.
class Retention {
 public:
  /// Takes up the series that there are; those that come later have nothing old. `now` is the clock
  /// [ns]; ages are counted back from it or from the newest sample, as RetentionRule says.
  Retention(Archive& archive, const RetentionRule& rule,
            const std::vector<ProtectedRange>& protection, Time now);
  ~Retention();

  /// Removes at most `chunks_of_step` chunks in one transaction. False when nothing is left to
  /// remove. Throws Error where the file or the disk refuses; then nothing of the step is removed.
  bool step();
  /// Protects these ranges too, from now on.
  void protect(const std::vector<ProtectedRange>& protection);
  /// What the steps so far removed.
  const RetentionReport& report() const { return report_; }

  static constexpr std::size_t chunks_of_step = 256;

 private:
  Archive& archive_;
  const RetentionRule rule_;
  const Time now_;
  std::unique_ptr<ChunkWalk> walk_;
  RetentionReport report_;
};

}  // namespace reident::storage
