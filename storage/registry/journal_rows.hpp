// Rows of the journal as bytes. Private to storage.
//
// A row is: the length of its table's name (one byte), the name, the number of values (one byte),
// the values. A value is its kind (n, i, r, t or b: nothing, integer, real, text, bytes), then 8
// bytes of an integer or a real, or the length in 4 bytes and the bytes. Little-endian.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "storage/database/sqlite.hpp"

namespace reident::storage {

struct JournalRow {
  std::string table;
  std::vector<sqlite::Value> values;  // in the order of the table's columns
};

void append_row(const JournalRow& row, std::vector<std::uint8_t>& bytes);

/// Throws Error (corrupt) where the bytes are no rows.
std::vector<JournalRow> read_rows(std::span<const std::uint8_t> bytes);

}  // namespace reident::storage
