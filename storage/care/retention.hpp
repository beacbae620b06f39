// How long telemetry is kept, and in how much room.
//
// What is removed are whole chunks, the oldest first, of every series. Chunks that hold a sample of
// a protected stretch stay, and so do samples that are not in chunks yet. What was removed is kept
// in the table `removal`. Pages that become free are used again; the file does not shrink.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "storage/archive/archive.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// Without either everything is kept.
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
  std::optional<std::uint32_t> parameter;  // absent: of every parameter
  TimeRange range;
};

struct RetentionReport {
  std::uint64_t chunks = 0;  // removed, or to be removed
  std::uint64_t samples = 0;
  std::uint64_t bytes = 0;              // of the chunks
  std::optional<Time> first{}, last{};  // generation times of the samples
  std::uint64_t protected_chunks = 0;   // passed over
  std::uint64_t bytes_in_use = 0;       // of the file's pages, at the end
  bool too_large = false;  // still more than the rule allows, with nothing left that may go
};

/// What a rule would remove now; works on a database opened for reading. Samples that are not in
/// chunks yet are left out, and the room that would be left is an estimate.
RetentionReport plan_retention(Database& database, const RetentionRule& rule,
                               const std::vector<ProtectedRange>& protection, Time now);

class ChunkWalk;

/// Removes by one rule, a bounded step at a time, so that others write in between. On the thread of
/// the archive, which must be the writer's and outlive it.
class Retention {
 public:
  /// Looks at the series that there are; those that come later have nothing old.
  Retention(Archive& archive, const RetentionRule& rule,
            const std::vector<ProtectedRange>& protection, Time now);
  ~Retention();

  /// One transaction, of at most `chunks_of_step` chunks. False when nothing is left to remove.
  bool step();
  /// More is protected from now on.
  void protect(const std::vector<ProtectedRange>& protection);
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
