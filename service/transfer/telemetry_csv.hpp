// Telemetry as CSV text: what `reident export` writes and `reident import` takes.
//
// Long layout, one sample a row, columns in any order:
//
//   spacecraft,parameter,origin,source,time,value,quality,unit
//
// Wide layout, one time a row: a column with the time and one for each parameter. Which one a
// file has is found by telemetry_file/long_layout. A value that is written and read again has the
// same bits, but for the payload of a NaN. Nothing here throws but std::bad_alloc.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::transfer {

/// In the order in which they are written.
inline constexpr std::array<std::string_view, 8> long_columns = {
    "spacecraft", "parameter", "origin", "source", "time", "value", "quality", "unit"};

/// Each takes the words that storage::name gives, with '_' or a blank between them. Empty for
/// anything else.
std::optional<storage::Quality> parse_quality(std::string_view cell);
std::optional<storage::Origin> parse_origin(std::string_view cell);

/// Each appends to `line`. A value has the fewest digits that give its bits back, a time as many
/// decimals of a second as it needs, a text quotes where CSV needs them.
void append_value(std::string& line, double value);
void append_time(std::string& line, storage::Time time);
void append_text(std::string& line, std::string_view text);

}  // namespace reident::transfer
