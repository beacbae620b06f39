// What a pair of services shares of the registry: terms, and rows in the order of their recording.
//
// A term is the time in which one service of a pair records. The journal numbers the rows of the
// registry from 1; the number is the row's position. A term begins with a row of its own, so that
// two journals that have the same term agree in all that lies before it, and in what both have of
// it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

struct Term {
  std::int64_t number = 0;
  /// Instance name of the one that records in it.
  std::string service;
  Time began = 0;
  /// Position of its own row, the first of the term.
  std::int64_t first = 0;
  bool operator==(const Term&) const = default;
};

/// Rows that follow each other, as bytes (storage/registry/journal_rows.hpp has the format).
struct JournalPart {
  std::int64_t after = 0;  // position of the row before the first one
  std::int64_t last = 0;   // position of the last one; `after` where there is none
  std::vector<std::uint8_t> rows;
};

/// The last position up to which two journals agree: 0 where they have no term in common. Terms
/// ascend; each journal ends at the position `last`.
std::int64_t common_end(const std::vector<Term>& ours, std::int64_t our_last,
                        const std::vector<Term>& theirs, std::int64_t their_last);

}  // namespace reident::storage
