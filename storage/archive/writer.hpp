// What the writer knows of the file beyond the file itself. Private to storage.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "storage/archive/archive.hpp"
#include "storage/archive/chunk_store.hpp"
#include "storage/archive/compaction.hpp"
#include "storage/archive/postponed_samples.hpp"
#include "storage/archive/recent_tier.hpp"

namespace reident::storage {

class Writer {
 public:
  /// Within a transaction of the caller.
  Writer(sqlite::Connection& connection, const ArchiveOptions& options);
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  RecentTier& recent() { return recent_; }
  ChunkStore& chunks() { return chunks_; }
  PostponedSamples& postponed() { return postponed_; }

  /// True until a transaction is rolled back after the writer was made.
  bool is_current() const { return rollbacks_ == connection_.rollbacks(); }

  /// The share of compaction that an append of so many samples does, within its transaction.
  void compact_some(std::size_t samples_appended);
  /// A step towards having everything in chunks. False when all is.
  bool compact_all_step();

  /// What was set aside as damaged since the last call, in words.
  std::vector<std::string> take_damages();

 private:
  void begin_round();

  sqlite::Connection& connection_;
  const ArchiveOptions options_;
  const std::uint64_t rollbacks_;
  std::int64_t damage_seen_;
  RecentTier recent_;
  ChunkStore chunks_;
  PostponedSamples postponed_;
  Compaction compaction_;
};

}  // namespace reident::storage
