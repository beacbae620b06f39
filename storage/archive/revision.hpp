// What changed in sealed time: enough to read a series as it was before. Private to storage.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "storage/chunks/chunk.hpp"
#include "storage/database/sqlite.hpp"
#include "storage/types/sample_columns.hpp"

namespace reident::storage {

/// What one batch changed of a series: times at which there was nothing, and what was replaced.
struct Revision {
  std::vector<Time> landed;
  SampleColumns replaced;
};

/// Writes what a batch changed, as chunks; at most most_samples of each.
void keep_revision(sqlite::Connection& connection, ChunkEncoder& encoder, std::int64_t series,
                   std::int64_t batch, const Revision& revision);

/// Takes back, of samples in `range`, what batches above `batch` changed.
void undo_revisions(sqlite::Connection& connection, ChunkDecoder& decoder, std::int64_t series,
                    std::int64_t batch, TimeRange range, WantedColumns wanted,
                    SampleColumns& samples);

}  // namespace reident::storage
