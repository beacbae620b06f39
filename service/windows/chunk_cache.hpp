// Rows on the grid kept in chunks of time that do not depend on the window, so that a window that
// slides reads only what is new.
#pragma once

#include <cstdint>
#include <functional>
#include <map>

#include "identification/samples/record.hpp"

namespace reident {

class ChunkCache {
 public:
  static constexpr std::int64_t chunk_ticks = 512;

  /// The rows at these ticks, from the archive.
  using Read = std::function<identification::Record(identification::TickRange)>;

  /// The rows at `ticks`; what lies before is forgotten. The bits are those of one read of all.
  identification::Record over(identification::TickRange ticks, const Read& read);

  void forget(identification::TickRange ticks);
  void clear() { chunks_.clear(); }

 private:
  /// Reads `ticks` and keeps the whole chunks of them.
  identification::Record read_and_keep(identification::TickRange ticks, const Read& read);

  std::map<std::int64_t, identification::Record> chunks_;
};

}  // namespace reident
