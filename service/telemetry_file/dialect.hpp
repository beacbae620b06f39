// How a file of telemetry is laid out: found from its first rows, or given.
//
// The words are those of the description that every program prints, such as "semicolons, header in
// line 3, units in line 4". What is ambiguous is an error that shows the first line and the option.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "service/telemetry_file/row_reader.hpp"

namespace reident::telemetry_file {

/// What is given is not looked for.
struct DialectOptions {
  std::optional<char> separator;             // a blank: any number of blanks and tabs
  std::optional<std::uint64_t> header_line;  // 0: there is no header
  std::optional<std::uint64_t> units_line;   // below the header; 0: there are none
  std::optional<char> line_end;              // LF or CR
  std::vector<std::string> names;            // of the columns, in place of those of the file
  std::optional<std::string> comment;        // what lines begin with that are no rows
  std::vector<std::string> wanted;           // names that the header must have, where they decide
};

struct Dialect {
  Layout layout;
  std::vector<std::string> columns;  // names in the order of the file; no two equal but empty ones
  std::vector<std::string> units;    // from the row of units; as many as columns, or none
  std::vector<std::string> without_cells;  // names at the header's end that no row has a cell of
  std::uint64_t header_line = 0;           // 0: none
  std::uint64_t units_line = 0;            // 0: none
  std::uint64_t first_line = 1;            // of the rows
  std::uint64_t first_position = 0;        // in bytes of the text
  std::vector<NumberedLine> above;         // the header: titles, metadata, comments
};

/// Finds the dialect of the text that `head` is the beginning of; `name` stands for the file. An
/// error where the text is empty, has no header, or has two columns of one name.
std::variant<Dialect, Error> find_dialect(const RowReader::Head& head,
                                          const DialectOptions& options, const std::string& name);

/// "semicolons, header in line 3, units in line 4".
std::string describe(const Dialect& dialect);

}  // namespace reident::telemetry_file
