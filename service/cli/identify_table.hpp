// The columns of a file that a model is identified from, as numbers.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "service/cli/command.hpp"
#include "service/telemetry_file/telemetry_file.hpp"

namespace reident::cli {

struct IdentifyTable {
  struct Column {
    std::vector<double> value;           // NaN where the cell is no number
    std::vector<std::uint8_t> is_blank;  // nothing was said at this row
  };
  std::vector<std::string> names;
  std::vector<Column> columns;
  std::vector<std::int64_t> time_ns;  // ascending; empty without a time column
  std::size_t rows = 0;
  std::vector<std::string> warnings;  // cells that are no numbers, rows left out, clocks set back
};

/// Reads `names` of a file whose time is found where `has_time`; rows that are not in the order of
/// time are put there, and a clock that was set back goes on where it left off. Refuses columns
/// without a number, and cells that are neither numbers nor missing values where they are many or
/// lie all at one end of the values.
std::variant<IdentifyTable, Refusal> read_identify_table(telemetry_file::TelemetryFile& file,
                                                         const std::vector<std::string>& names,
                                                         bool has_time, bool skip_bad_lines,
                                                         bool clock_may_go_back);

}  // namespace reident::cli
