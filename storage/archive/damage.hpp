// Samples in the file that cannot be decoded any more. Private to storage.
#pragma once

#include <cstdint>
#include <span>

#include "storage/chunks/chunk.hpp"
#include "storage/database/sqlite.hpp"

namespace reident::storage {

/// Where undecodable bytes lie, as their row says.
struct SampleRange {
  std::int64_t series = 0;
  Time first = 0;
  Time last = 0;
  std::size_t samples = 0;
  std::int64_t shard = 0;  // 0: in the database itself
};

/// What a reader throws: the parameter, the time, what is wrong and the remedy.
Error damage(sqlite::Connection& connection, const SampleRange& where, const ChunkError& error);

/// What the writer does: keeps the bytes in the table `damaged_chunk`, out of the way of what
/// comes. The caller removes the row that they were in. Throws for bytes of a newer format.
void set_aside(sqlite::Connection& connection, const SampleRange& where,
               std::span<const std::uint8_t> bytes, const ChunkError& error);

}  // namespace reident::storage
