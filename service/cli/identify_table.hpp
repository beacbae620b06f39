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
  std::vector<std::int64_t> time_ns;  // ascending in each part; empty without a time column
  /// Part of each row, from 0 and ascending: of the column that names it, and one more where a
  /// clock was started again. No value of one part serves another.
  std::vector<std::size_t> part;
  std::vector<std::uint64_t> line;  // of the file, by row
  std::size_t rows = 0;
  std::vector<std::string> warnings;  // cells that are no numbers, rows left out, clocks set back
};

struct TableRequest {
  std::vector<std::string> columns;
  std::optional<std::size_t> segment;  // position of the column whose words name parts
  bool has_time = false;               // the time of the file is found
  bool skip_bad_lines = false;
  bool clock_may_go_back = false;
};

/// Reads columns of a file. Rows of one part are put together, and those that are not in the order
/// of time are put there; a clock that was set back goes on where it left off. Refuses columns
/// without a number, and cells that are neither numbers nor missing values where they are many or
/// lie all at one end of the values.
std::variant<IdentifyTable, Refusal> read_identify_table(telemetry_file::TelemetryFile& file,
                                                         const TableRequest& request);

}  // namespace reident::cli
