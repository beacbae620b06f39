// The chunks of all series in the file, for the writer. Private to storage.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "storage/archive/chunk_bytes.hpp"
#include "storage/chunks/chunk.hpp"
#include "storage/chunks/sample_gaps.hpp"
#include "storage/database/sqlite.hpp"
#include "storage/types/sample_columns.hpp"

namespace reident::storage {

/// A row of the table `chunk`.
struct ChunkRow {
  std::int64_t series = 0;
  Time first = 0;
  Time last = 0;
  std::size_t samples = 0;
  Sampling sampling;
  ChunkPlace place;
};

class ChunkStore {
 public:
  explicit ChunkStore(sqlite::Connection& connection)
      : connection_(connection), bytes_(connection) {}

  /// The chunk with the greatest first time not above, or below, `time`.
  std::optional<ChunkRow> at_or_before(std::int64_t series, Time time);
  std::optional<ChunkRow> before(std::int64_t series, Time time);
  /// The chunk with the least first time above `time`.
  std::optional<ChunkRow> after(std::int64_t series, Time time);

  /// What a chunk holds at `time`. The chunk that was looked into last stays decoded.
  std::optional<Held> find(std::int64_t series, Time time);

  ChunkEncoder& encoder() { return encoder_; }

  /// Appends a chunk's samples; `row.samples` of them, or none where it is damaged and set aside.
  /// Throws ShardError where it is in a shard that cannot be read, as find() does.
  void take(const ChunkRow& row, SampleColumns& samples);

  /// Puts `samples`, cut into `pieces` chunks of nearly one size, in the place of `old`, neighbours
  /// ascending in time. Between the chunks on either side there is nothing else.
  void replace(std::int64_t series, std::span<const ChunkRow> old, const SampleColumns& samples,
               std::span<const std::size_t> piece_ends);

  /// Says that the bytes of a chunk, which are the same, are in a shard now.
  void move(const ChunkRow& row, ChunkPlace to);

  /// Removes a chunk with its samples. Where it was there is a gap, if its neighbours say so.
  void discard(const ChunkRow& row);

 private:
  std::optional<ChunkRow> one(std::string_view condition, std::int64_t series, Time time);
  Sampling insert(std::int64_t series, const SampleColumns& samples, std::size_t begin,
                  std::size_t end);
  void remove(const ChunkRow& row);
  void remove_bytes(ChunkPlace place);
  bool has_decoded(std::int64_t series, Time time) const;

  sqlite::Connection& connection_;
  ChunkBytes bytes_;
  ChunkEncoder encoder_;
  ChunkDecoder decoder_;
  SamplingMeter meter_;
  std::optional<ChunkPlace> looked_into_;  // of the chunk that `decoded_` holds
  std::int64_t decoded_series_ = 0;
  SampleColumns decoded_;
};

}  // namespace reident::storage
