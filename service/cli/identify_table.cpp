#include "service/cli/identify_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli {
namespace {

using telemetry_file::Cell;
using telemetry_file::CellFormat;
using telemetry_file::ClockStep;
using telemetry_file::Damage;
using telemetry_file::TelemetryFile;

constexpr std::size_t examples = 3;
constexpr std::size_t few = 3;         // cells that are no numbers, whatever the rows
constexpr double few_share = 0.01;     // of the rows
constexpr double end_of_values = 0.2;  // of the values in their order
constexpr std::size_t late_rows = 16;  // a row that came late belongs between as many

/// Cells of one column that are neither numbers nor missing.
struct BadCells {
  std::size_t count = 0;
  std::string first;  // "'x' in line 7, ..."
  std::vector<std::size_t> rows;
};

void note(BadCells& bad, const TelemetryFile& file, std::size_t position, std::size_t row) {
  bad.rows.push_back(row);
  if (bad.count++ >= examples) return;
  const std::string cell(trimmed(file.cells()[position]).substr(0, 40));
  bad.first +=
      fmt::format("{}'{}' in line {}", bad.first.empty() ? "" : ", ", cell, file.line(position));
}

/// Whether the values around bad cells are all among the greatest or all among the least.
bool lie_at_one_end(const BadCells& bad, const IdentifyTable::Column& column) {
  if (bad.count < few) return false;
  std::vector<double> sorted;
  for (const double value : column.value)
    if (std::isfinite(value)) sorted.push_back(value);
  if (sorted.empty()) return false;
  std::sort(sorted.begin(), sorted.end());
  const auto share = [&](double value) {
    return static_cast<double>(std::lower_bound(sorted.begin(), sorted.end(), value) -
                               sorted.begin()) /
           static_cast<double>(sorted.size());
  };
  std::size_t low = 0, high = 0;
  for (std::size_t row : bad.rows) {
    while (row > 0 && !std::isfinite(column.value[row])) --row;
    if (!std::isfinite(column.value[row])) continue;
    if (share(column.value[row]) <= end_of_values) ++low;
    if (share(column.value[row]) >= 1 - end_of_values) ++high;
  }
  return low == bad.count || high == bad.count;
}

std::optional<Refusal> judge(const IdentifyTable& table, std::size_t c, const BadCells& bad,
                             std::vector<std::string>& warnings) {
  if (bad.count == 0) return std::nullopt;
  const std::string& name = table.names[c];
  const std::string what =
      fmt::format("column {}: {} of {} cells are neither numbers nor blank: {}", name, bad.count,
                  table.rows, bad.first);
  const auto limit =
      std::max(few, static_cast<std::size_t>(few_share * static_cast<double>(table.rows)));
  const bool at_one_end = lie_at_one_end(bad, table.columns[c]);
  if (bad.count > limit || at_one_end)
    return Refusal{
        fmt::format("{}{}; mend them, or say with --missing that they stand for no value, with "
                    "--map-states {}:... "
                    "what states are, or leave such rows out with --skip-bad-lines",
                    what, bad.count <= limit ? ", all at one end of the values" : "", name)};
  warnings.push_back(what + "; they were left out");
  return std::nullopt;
}

std::optional<Refusal> refuse_words(const TelemetryFile& file, const std::string& name,
                                    std::size_t position) {
  const CellFormat& format = file.format(position);
  if (format.kind == CellFormat::Kind::empty)
    return Refusal{fmt::format("column {} holds no number; name a column of numbers", name)};
  if (format.kind != CellFormat::Kind::text) return std::nullopt;
  if (!format.may_be_states)
    return Refusal{fmt::format(
        "column {} holds no number, the first cell is {}; name a column of numbers, or write its "
        "cells as plain numbers",
        name, file.first_word(position))};
  std::string states;
  for (std::size_t i = 0; i < format.words.size(); ++i)
    states += fmt::format("{}{}={}", i == 0 ? "" : ",", format.words[i], i);
  return Refusal{fmt::format(
      "column {} holds no number, the first cell is {}; name a column of numbers, or make "
      "numbers of states, as with --map-states {}:{}",
      name, file.first_word(position), name, states)};
}

/// The part of each row by the words of a column, and its time where the clock was set back: each
/// part has a clock of its own.
class Parts {
 public:
  explicit Parts(bool is_absolute) : is_absolute_(is_absolute) {}

  /// Returns the part of the row that was read, and adds its time to the table where it has one.
  std::size_t add(const TelemetryFile& file, const TableRequest& request, IdentifyTable& table) {
    const std::string word =
        request.segment ? std::string(trimmed(file.cells()[*request.segment])) : std::string();
    Clock& clock = clocks_.try_emplace(word, Clock{next_part_}).first->second;
    if (clock.part == next_part_) ++next_part_;
    if (request.has_time) table.time_ns.push_back(next(clock, file, table.warnings));
    return clock.part;
  }

 private:
  struct Clock {
    std::size_t part;
    std::int64_t ahead_ns = 0;
    std::vector<std::int64_t> times_ns = {};  // of the last rows

    /// Whether a row of this time came late: it belongs between the last rows.
    bool misses(std::int64_t time_ns) const {
      return time_ns > std::ranges::min(times_ns) && !std::ranges::count(times_ns, time_ns);
    }
    void note(std::int64_t time_ns) {
      if (times_ns.size() == late_rows) times_ns.erase(times_ns.begin());
      times_ns.push_back(time_ns);
    }
  };

  std::int64_t next(Clock& clock, const TelemetryFile& file, std::vector<std::string>& warnings) {
    const std::int64_t time = file.time_ns();
    const auto& step = file.clock_step();
    // A step from one part to another is none of a clock.
    if (!clock.times_ns.empty() && time <= clock.times_ns.back() && step) {
      const bool is_sorted =
          step->kind == ClockStep::Kind::out_of_order && (is_absolute_ || clock.misses(time));
      if (step->missing_ns != 0)
        clock.ahead_ns += step->missing_ns;
      else if (!is_sorted)
        clock = {next_part_++};
      if (warnings_++ < examples)
        warnings.push_back(
            file.error_here(fmt::format("{}; {}", step->what,
                                        step->missing_ns != 0
                                            ? "the rows behind it go on where it left off"
                                        : is_sorted ? "rows are put in the order of time"
                                                    : "the rows behind it are a new segment"))
                .message);
    }
    clock.note(time);
    return time + clock.ahead_ns;
  }

  bool is_absolute_;
  std::size_t next_part_ = 0, warnings_ = 0;
  std::map<std::string, Clock, std::less<>> clocks_;
};

/// Puts the rows of each part together, in the order of time.
void sort_rows(IdentifyTable& table) {
  std::vector<std::size_t> order(table.rows);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto comes_before = [&](std::size_t a, std::size_t b) {
    if (table.part[a] != table.part[b]) return table.part[a] < table.part[b];
    return !table.time_ns.empty() && table.time_ns[a] < table.time_ns[b];
  };
  if (std::is_sorted(order.begin(), order.end(), comes_before)) return;
  std::stable_sort(order.begin(), order.end(), comes_before);
  const auto put = [&](auto& values) {
    if (values.empty()) return;
    auto sorted = values;
    for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = values[order[i]];
    values = std::move(sorted);
  };
  put(table.time_ns);
  put(table.part);
  put(table.line);
  for (IdentifyTable::Column& column : table.columns) {
    put(column.value);
    put(column.is_blank);
  }
}

/// Leaves the first of a column's values at one time, as an import does, and warns of others.
void leave_out_contradictions(IdentifyTable& table) {
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    auto& [value, is_blank] = table.columns[c];
    std::optional<double> first;
    std::size_t contradictions = 0, line = 0;
    for (std::size_t row = 0; row < table.time_ns.size(); ++row) {
      if (row > 0 &&
          (table.time_ns[row] != table.time_ns[row - 1] || table.part[row] != table.part[row - 1]))
        first.reset();
      if (!std::isfinite(value[row])) continue;
      if (!first) {
        first = value[row];
        continue;
      }
      if (value[row] != *first && contradictions++ == 0) line = table.line[row];
      value[row] = std::numeric_limits<double>::quiet_NaN();
      is_blank[row] = 1;
    }
    if (contradictions > 0)
      table.warnings.push_back(fmt::format(
          "column {}: other values at the time of an earlier one: {}, the first in line "
          "{}; the earlier one counts, as in an import",
          table.names[c], contradictions, line));
  }
}

}  // namespace

std::variant<IdentifyTable, Refusal> read_identify_table(TelemetryFile& file,
                                                         const TableRequest& request) {
  const auto& names = request.columns;
  IdentifyTable table;
  table.names = names;
  table.columns.resize(names.size());
  std::vector<std::size_t> positions;
  for (const std::string& name : names) {
    positions.push_back(std::get<std::size_t>(file.find(name)));
    if (!file.has_rows()) continue;
    if (auto refusal = refuse_words(file, name, positions.back())) return *std::move(refusal);
  }
  std::vector<BadCells> bad(names.size());
  telemetry_file::LeftOut left_out;
  Parts parts(request.has_time && file.clock().is_absolute());
  for (auto step = file.next(); step != TelemetryFile::Step::end; step = file.next()) {
    std::optional<csv::Error> error;
    Damage damage = Damage::value;
    if (step == TelemetryFile::Step::error) {
      error = file.error();
      damage = file.damage();
    } else if (request.skip_bad_lines) {
      for (std::size_t c = 0; c < positions.size() && !error; ++c)
        if (file.cell(positions[c]).kind == Cell::Kind::bad)
          error = file.cell_error(positions[c], "is no number");
    }
    if (error && (!request.skip_bad_lines || damage == Damage::none))
      return Refusal{error->message};
    if (error) {
      left_out.add(damage, *error);
      continue;
    }
    if (file.clock_step() && !request.clock_may_go_back && !request.segment)
      return Refusal{
          file.error_here(file.clock_step()->what + "; go on with --clock-back go-on").message};
    table.part.push_back(parts.add(file, request, table));
    table.line.push_back(file.line());
    for (std::size_t c = 0; c < positions.size(); ++c) {
      const Cell cell = file.cell(positions[c]);
      const bool is_number = cell.kind == Cell::Kind::number && std::isfinite(cell.value);
      table.columns[c].value.push_back(is_number ? cell.value
                                                 : std::numeric_limits<double>::quiet_NaN());
      table.columns[c].is_blank.push_back(cell.kind == Cell::Kind::blank ? 1 : 0);
      if (cell.kind == Cell::Kind::bad) note(bad[c], file, positions[c], table.rows);
    }
    ++table.rows;
  }
  for (const std::string& remark : file.remarks()) table.warnings.push_back(remark);
  for (const std::string& sentence : left_out.sentences()) table.warnings.push_back(sentence);
  if (table.rows == 0) return Refusal{"the file has no row of data below its header"};
  for (std::size_t c = 0; c < names.size(); ++c)
    if (auto refusal = judge(table, c, bad[c], table.warnings)) return *std::move(refusal);
  sort_rows(table);
  leave_out_contradictions(table);
  return table;
}

}  // namespace reident::cli
