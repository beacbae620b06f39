// The rows of a CSV file as a record to identify from.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "identification/samples/record.hpp"
#include "identification/samples/tick_ranges.hpp"
#include "service/cli/command.hpp"
#include "service/model/derived_inputs.hpp"
#include "service/telemetry_file/telemetry_file.hpp"

namespace reident::cli {

struct DataRequest {
  std::filesystem::path file;
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  std::vector<std::string> derive;   // "NAME=EXPRESSION", inputs that follow from columns
  std::vector<std::string> regimes;  // columns or conditions (identify_regimes.hpp)
  /// How the file is read. Without a time column rows are one period apart.
  telemetry_file::ReadingOptions reading;
  bool skip_bad_lines = false;
  std::optional<std::string> segment;    // column whose words say which rows are one record
  std::optional<double> period_s;        // default: 1, or the usual step of the slowest column
  std::optional<std::int64_t> hold_ns;   // how long a value serves; default: 3 periods
  std::optional<std::int64_t> phase_ns;  // of ticks behind the multiples; default: what suits
  std::optional<std::string> identify;   // "A:B", rows of the file
  std::optional<std::string> validate;
  bool screening = true;  // leave rows out (LeftOut)
};

/// Rows that are not in the record because a column shows a fault there, or a model does.
struct LeftOut {
  std::string column;
  std::string_view fault;  // its name, for programs
  std::string_view words;  // what the column does there
  identification::TickSet ticks;
  bool operator==(const LeftOut&) const = default;
};

struct IdentifyData {
  identification::Record record;
  identification::RowRange identify;         // rows of the record
  identification::RowRange validate;         // at least one row
  std::vector<std::string> inputs, outputs;  // columns of u and y
  std::vector<DerivedInput> derived;         // of the inputs; units are not known
  std::vector<std::string> regimes;          // conditions
  int regime_inputs = 0;                     // the last so many inputs are those of the regimes
  std::vector<std::int64_t> file_ticks;      // of the rows of the file
  std::int64_t phase_ns = 0;                 // of ticks behind the multiples of the period
  std::vector<LeftOut> left_out;
  std::vector<std::string> warnings;
  std::string found;   // how the file is read
  std::string advice;  // where few ticks are complete: which --hold would mend it
};

std::variant<IdentifyData, Refusal> read_data(const DataRequest& request);

/// Returns the first row of the file at the tick of this row of the record, or behind it.
identification::Index file_row(const IdentifyData& data, identification::Index row);

}  // namespace reident::cli
