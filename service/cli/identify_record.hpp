// The columns of a file on a uniform grid, as the daemon puts telemetry there.
#pragma once

#include <optional>

#include "identification/samples/record.hpp"
#include "service/cli/identify_table.hpp"

namespace reident::cli {

struct GridRequest {
  std::optional<double> period_s;        // default: 1, or the usual step of the slowest column
  std::optional<std::int64_t> hold_ns;   // how long a value serves; default: 3 periods
  std::optional<std::int64_t> phase_ns;  // of ticks behind the multiples; default: what suits
  std::string time_name;                 // of the time column, for messages
};

struct GridRecord {
  identification::Record record;
  std::int64_t phase_ns = 0;  // of the ticks of the first part behind the multiples of the period
  /// First tick at or behind each row of the table, and the tick behind the last: rows + 1 ticks.
  std::vector<std::int64_t> tick_of_row;
  /// Which column has gaps that its values do not reach across, how long they are and which --hold
  /// would mend it; empty where ticks are complete.
  std::string advice;
  std::vector<std::string> warnings;
};

/// Puts the table on a grid; the first `inputs` columns are inputs. A blank says nothing: the value
/// before it serves on. Without times a row is a tick.
std::variant<GridRecord, Refusal> put_on_grid(const IdentifyTable& table, std::size_t inputs,
                                              const GridRequest& request);

}  // namespace reident::cli
