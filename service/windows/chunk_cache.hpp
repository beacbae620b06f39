// Rows on the grid kept in chunks of time that do not depend on the window, so that a window that
// slides reads only what is new.
#pragma once

#include <cstdint>
#include <functional>
#include <map>

#include "service/windows/packed_rows.hpp"

namespace reident {

/// Chunk k has the ticks [k chunk_ticks, (k + 1) chunk_ticks). Chunks that a range cuts at its ends
/// are read and not kept. One thread at a time; memory is that of the last range, packed.
class ChunkCache {
 public:
  static constexpr std::int64_t chunk_ticks = 512;

  /// Returns the rows at these ticks, from the archive. What it throws is thrown by over().
  using Read = std::function<identification::Record(identification::TickRange)>;

  /// Returns the rows at `ticks`; what lies before is forgotten. Reads each range that is not
  /// kept once. The bits are those of one read of all: a row must depend on its tick alone.
  identification::Record over(identification::TickRange ticks, const Read& read);

  /// Forgets every chunk that `ticks` touches: it is read again.
  void forget(identification::TickRange ticks);
  void clear() { chunks_.clear(); }

 private:
  /// Reads `ticks` and keeps the whole chunks of them.
  identification::Record read_and_keep(identification::TickRange ticks, const Read& read);

  std::map<std::int64_t, PackedRows> chunks_;  // whole ones, by number
};

}  // namespace reident
