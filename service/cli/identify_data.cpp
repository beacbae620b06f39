#include "service/cli/identify_data.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "identification/screening/sample_hold.hpp"
#include "service/cli/identify_record.hpp"
#include "service/cli/identify_regimes.hpp"
#include "service/cli/identify_screening.hpp"
#include "service/cli/identify_table.hpp"
#include "service/model/regime_inputs.hpp"
#include "service/support/text.hpp"
#include "service/telemetry_file/clock_names.hpp"
#include "service/telemetry_file/long_layout.hpp"

namespace reident::cli {
namespace {

using identification::Index;
using identification::Record;
using identification::RowRange;
using telemetry_file::TelemetryFile;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Columns by the names of the request, a name with commas in it taken apart where the file has no
/// such column. The order of the request stays; names among `derived` are no columns.
std::variant<std::vector<std::string>, Refusal> resolve(const TelemetryFile& reader,
                                                        const std::vector<std::string>& derived,
                                                        const std::vector<std::string>& names,
                                                        std::string_view flag) {
  std::vector<std::string> result;
  for (const std::string& name : names) {
    std::size_t begin = 0;
    while (begin <= name.size()) {
      const std::size_t end = contains(reader.columns(), name) || contains(derived, name)
                                  ? name.size()
                                  : std::min(name.find(',', begin), name.size());
      result.push_back(name.substr(begin, end - begin));
      begin = end + 1;
      if (contains(derived, result.back())) continue;
      const auto found = reader.find(result.back());
      if (const auto* error = std::get_if<csv::Error>(&found))
        return Refusal{fmt::format("{} {}", flag, error->message)};
    }
  }
  return result;
}

std::variant<std::vector<DerivedInput>, Refusal> parse_derived(
    const std::vector<std::string>& derive) {
  std::vector<DerivedInput> derived;
  for (const std::string& text : derive) {
    const std::size_t equals = std::min(text.find('='), text.size());
    const std::string name(trimmed(std::string_view(text).substr(0, equals)));
    if (name.empty() || equals == text.size())
      return Refusal{fmt::format(
          "--derive {} is no input; write it as NAME=EXPRESSION, such as P=u_in*i_in", text)};
    derived.push_back({name, std::string(trimmed(std::string_view(text).substr(equals + 1))), ""});
  }
  return derived;
}

/// What is wrong with the derived inputs, given the columns of the file and of the request.
std::optional<Refusal> refuse_derived(const std::vector<DerivedInput>& derived,
                                      const DataRequest& request, const TelemetryFile& reader) {
  for (const DerivedInput& input : derived)
    if (contains(reader.columns(), input.name))
      return Refusal{
          fmt::format("--derive {0}: the file has a column {0}; choose another name", input.name)};
  const auto mistakes = mistakes_in(derived, request.inputs, request.outputs);
  if (!mistakes.empty())
    return Refusal{fmt::format("--derive {}: {} {}", derived[mistakes.front().index].name,
                               mistakes.front().key, mistakes.front().message)};
  for (const DerivedInput& input : derived) {
    const InputExpressions alone({input.name}, derived);
    for (const std::string& operand : alone.parameters()) {
      const auto found = reader.find(operand);
      if (const auto* error = std::get_if<csv::Error>(&found))
        return Refusal{fmt::format("--derive {}: {}", input.name, error->message)};
    }
  }
  return std::nullopt;
}

std::variant<TelemetryFile, Refusal> open_file(const DataRequest& request) {
  std::error_code ignored;
  if (std::filesystem::is_character_file(request.file, ignored) ||
      std::filesystem::is_fifo(request.file, ignored))
    return Refusal{
        fmt::format("{} can be read only once; save it to a file first", request.file.string())};
  telemetry_file::ReadingOptions reading = request.reading;
  reading.any_epoch = true;                         // nothing is stored
  reading.continues_clock = false;                  // each segment has a clock (IdentifyTable)
  if (request.segment) reading.force_times = true;  // records may go on side by side
  reading.clock_may_go_back = true;
  for (const auto* names : {&request.inputs, &request.outputs})
    for (const std::string& name : *names)
      if (name.find(',') == std::string::npos) reading.dialect.wanted.push_back(name);
  auto opened = telemetry_file::open_as_table(request.file, reading, request.skip_bad_lines);
  if (const auto* error = std::get_if<csv::Error>(&opened)) return Refusal{error->message};
  return std::get<TelemetryFile>(std::move(opened));
}

Refusal refuse_without_inputs(const DataRequest& request, const std::vector<std::string>& columns) {
  std::vector<std::string> others;
  for (const std::string& column : columns)
    if (!contains(request.outputs, column) && column != request.reading.time.column)
      others.push_back(column);
  const std::string outputs = fmt::format("{}", fmt::join(request.outputs, ", "));
  if (others.empty())
    return Refusal{fmt::format(
        "--input is missing: a model computes {} from what drives it, and the file holds nothing "
        "else. Add telemetry of the cause, such as a current, a power or a command; of an output "
        "alone a simulation can only repeat the mean",
        outputs)};
  return Refusal{fmt::format(
      "--input is missing: a model computes {} from what drives it; name columns that do, of {}",
      outputs, fmt::join(others, ", "))};
}

/// Resolves the names of the request in place, and finds the time where it has one.
std::optional<Refusal> resolve_columns(const std::vector<DerivedInput>& derived,
                                       DataRequest& request, TelemetryFile& reader) {
  std::vector<std::string> derived_names;
  for (const DerivedInput& input : derived) derived_names.push_back(input.name);
  for (const auto& [flag, names] :
       {std::pair("--input:", &request.inputs), std::pair("--output:", &request.outputs)}) {
    auto resolved = resolve(reader, derived_names, *names, flag);
    if (auto* refusal = std::get_if<Refusal>(&resolved)) return *refusal;
    *names = std::get<std::vector<std::string>>(std::move(resolved));
  }
  std::set<std::string> seen;
  for (const std::string& name : request.inputs)
    if (!seen.insert(name).second)
      return Refusal{fmt::format("--input names {} twice; name each column once", name)};
  for (const std::string& name : request.outputs)
    if (!seen.insert(name).second)
      return Refusal{
          fmt::format("--output names {}, which is named already; a column is an input "
                      "or an output, once",
                      name)};
  if (auto refusal = refuse_derived(derived, request, reader)) return refusal;
  const auto& time = request.reading.time.column;
  if (request.inputs.empty()) return refuse_without_inputs(request, reader.columns());
  if (!time) return std::nullopt;
  if (seen.contains(*time))
    return Refusal{fmt::format("--time {} is an input or output too; leave it out there", *time)};
  if (!reader.has_rows()) return Refusal{"the file has no row of data below its header"};
  if (const auto error = reader.find_time())
    return Refusal{fmt::format("--time: {}", error->message)};
  return std::nullopt;
}

/// "A:B" as half-open rows of the file; an end that is left out is the file's.
std::variant<RowRange, Refusal> parse_rows(std::string_view flag, std::string_view text,
                                           Index rows) {
  const std::size_t colon = text.find(':');
  const auto bound = [](std::string_view digits, Index absent) -> std::optional<Index> {
    return digits.empty() ? std::optional<Index>(absent) : whole_number(digits);
  };
  std::optional<Index> begin, end;
  if (colon != std::string_view::npos) {
    begin = bound(text.substr(0, colon), 0);
    end = bound(text.substr(colon + 1), rows);
  }
  if (!begin || !end)
    return Refusal{
        fmt::format("{} {} is no range of rows; write it as A:B, such as 0:{}", flag, text, rows)};
  if (*end > rows || *begin >= *end)
    return Refusal{
        fmt::format("{} {} {}; the file has rows 0 to {}, so that 0 <= A < B <= {}", flag, text,
                    *begin >= *end ? "holds no row" : "ends after the last row", rows - 1, rows)};
  return RowRange{*begin, *end};
}

/// Rows of the file to identify from and to validate on.
struct FileRanges {
  RowRange identify, validate;
};

std::variant<FileRanges, Refusal> parse_ranges(const DataRequest& request, Index rows) {
  std::optional<RowRange> identify, validate;
  for (const auto& [flag, text, range] : {std::tuple("--identify", &request.identify, &identify),
                                          std::tuple("--validate", &request.validate, &validate)}) {
    if (!*text) continue;
    const auto parsed = parse_rows(flag, **text, rows);
    if (const auto* refusal = std::get_if<Refusal>(&parsed)) return *refusal;
    *range = std::get<RowRange>(parsed);
  }
  if (!identify && !validate) {
    const Index third = rows * 2 / 3;
    if (third == 0) return Refusal{fmt::format("the file has {} row; a model needs many", rows)};
    return FileRanges{{0, third}, {third, rows}};
  }
  if (!validate) validate = RowRange{identify->end, rows};
  if (!identify) identify = RowRange{0, validate->begin};
  if (validate->size() == 0)
    return Refusal{"--identify leaves no row after it to validate on; give --validate A:B"};
  if (identify->size() == 0)
    return Refusal{"--validate leaves no row before it to identify from; give --identify A:B"};
  return FileRanges{*identify, *validate};
}

/// Puts the derived inputs in the place of the columns that they follow from.
std::optional<Refusal> derive_inputs(InputExpressions& expressions, IdentifyData& data) {
  const Index before = data.record.rows();
  data.record = expressions.evaluate(std::move(data.record));
  if (before != 0 && data.record.rows() == 0)
    return Refusal{fmt::format(
        "a derived input has no finite value in any of the {} rows; mend its --derive", before)};
  if (const Index lost = before - data.record.rows(); lost != 0)
    data.warnings.push_back(
        fmt::format("at {} of {} rows a derived input has no finite value; they were left out and "
                    "the record is split there",
                    lost, before));
  return std::nullopt;
}

/// How to have one row of so many: rows without times are all taken, whatever their period.
std::string thinning(Index rows, double period_s, bool has_time) {
  const double period = static_cast<double>(rows) * period_s;
  return has_time ? fmt::format("--period {:g} takes one row of each", period)
                  : fmt::format(
                        "name the times of the rows with --time, and --period {:g} takes one "
                        "row of each; or keep one row of {} in the file",
                        period, rows);
}

void warn_of_held_rows(IdentifyData& data, bool has_time) {
  const Index rows = rows_per_sample(data.record);
  if (rows > 1)
    return data.warnings.push_back(
        fmt::format("each value stands for {} rows in every column: {}, which is all that it holds",
                    rows, thinning(rows, data.record.period_s, has_time)));
  Record alone{data.record.period_s,
               identification::Matrix(data.record.rows(), 0),
               {},
               data.record.segments};
  for (std::size_t q = 0; q < data.outputs.size(); ++q) {
    alone.y = data.record.y.col(static_cast<Index>(q));
    if (const Index held = rows_per_sample(alone); held > 1)
      data.warnings.push_back(fmt::format(
          "each value of {} stands for {} rows, in which other columns move: the model has the "
          "repeats in it, as a delay of {:g} rows on average and modes that are not the "
          "equipment's; {}, and what the others do between is lost",
          data.outputs[q], held, static_cast<double>(held - 1) / 2,
          thinning(held, data.record.period_s, has_time)));
  }
}

/// Where neither the time nor a period was given.
void warn_of_unused_time(const DataRequest& request, const std::vector<std::string>& columns,
                         IdentifyData& data) {
  for (const std::string& column : columns)
    if (telemetry_file::is_named_like_a_time(column) && !contains(request.inputs, column) &&
        !contains(request.outputs, column)) {
      data.warnings.push_back(
          fmt::format("column {} may be the time of the rows and is not used, they are taken to be "
                      "1 s apart; say --time {} or --period",
                      column, column));
      return;
    }
}

/// Without a time column ticks are rows of the file.
void warn_of_late_start(IdentifyData& data, Index asked) {
  const auto parts = segments_within(data.record, data.identify);
  if (!parts.empty() && parts.front().first_tick != asked)
    data.warnings.push_back(
        fmt::format("identification row {} is incomplete: x0 is the state at "
                    "row {}",
                    asked, parts.front().first_tick));
}

/// Adds the inputs of the regimes to those of the request.
std::optional<Refusal> add_regimes(DataRequest& request, const TelemetryFile& file,
                                   IdentifyData& data) {
  if (request.regimes.empty()) return std::nullopt;
  auto again = open_file(request);  // the values of columns have to be known before rows are read
  if (const auto* refusal = std::get_if<Refusal>(&again)) return *refusal;
  auto regimes = regimes_of(std::get<TelemetryFile>(again), request.regimes);
  if (const auto* refusal = std::get_if<Refusal>(&regimes)) return *refusal;
  data.regimes = std::get<std::vector<std::string>>(std::move(regimes));
  const std::size_t before = request.inputs.size();
  add_regime_inputs(data.regimes, request.inputs, data.derived);
  data.regime_inputs = static_cast<int>(request.inputs.size() - before);
  const std::set<std::string> names(request.inputs.begin(), request.inputs.end());
  if (names.size() < request.inputs.size())
    return Refusal{"--regime names a regime twice; name each once"};
  const auto mistakes = mistakes_in(data.derived, request.inputs, request.outputs);
  if (!mistakes.empty())
    return Refusal{fmt::format("--regime: {} {}", data.derived[mistakes.front().index].name,
                               mistakes.front().message)};
  const InputExpressions expressions(request.inputs, data.derived);
  for (const std::string& operand : expressions.parameters()) {
    const auto found = file.find(operand);
    if (const auto* error = std::get_if<csv::Error>(&found))
      return Refusal{fmt::format("--regime: {}", error->message)};
  }
  return std::nullopt;
}

}  // namespace

std::variant<IdentifyData, Refusal> read_data(const DataRequest& asked) {
  DataRequest request = asked;
  auto derived = parse_derived(request.derive);
  if (const auto* refusal = std::get_if<Refusal>(&derived)) return *refusal;
  IdentifyData data;
  data.derived = std::get<std::vector<DerivedInput>>(std::move(derived));
  auto opened = open_file(request);
  if (const auto* refusal = std::get_if<Refusal>(&opened)) return *refusal;
  auto& file = std::get<TelemetryFile>(opened);
  if (auto refusal = resolve_columns(data.derived, request, file)) return *refusal;
  if (auto refusal = add_regimes(request, file, data)) return *refusal;
  InputExpressions expressions(request.inputs, data.derived);
  std::vector<std::string> columns = expressions.parameters();
  const std::size_t inputs = columns.size();
  columns.insert(columns.end(), request.outputs.begin(), request.outputs.end());
  const bool has_time = request.reading.time.column.has_value();
  TableRequest wanted{
      columns, {}, has_time, request.skip_bad_lines, request.reading.clock_may_go_back};
  if (request.segment) {
    const auto position = file.find(*request.segment);
    if (const auto* error = std::get_if<csv::Error>(&position))
      return Refusal{"--segment: " + error->message};
    wanted.segment = std::get<std::size_t>(position);
  }
  auto read = read_identify_table(file, wanted);
  if (const auto* refusal = std::get_if<Refusal>(&read)) return *refusal;
  const auto& table = std::get<IdentifyTable>(read);
  const auto ranges = parse_ranges(request, static_cast<Index>(table.rows));
  if (const auto* refusal = std::get_if<Refusal>(&ranges)) return *refusal;
  const auto& [identify, validate] = std::get<FileRanges>(ranges);

  data.inputs = request.inputs;
  data.outputs = request.outputs;
  data.found = file.found();
  data.warnings = table.warnings;
  if (!has_time && !request.period_s) warn_of_unused_time(request, file.columns(), data);
  if (std::max(identify.begin, validate.begin) < std::min(identify.end, validate.end))
    data.warnings.push_back(
        "the validation rows overlap the identification rows: the validation error is not an error "
        "on unseen data");
  auto gridded = put_on_grid(table, inputs,
                             {request.period_s, request.hold_ns, request.phase_ns,
                              has_time ? *request.reading.time.column : ""});
  if (const auto* refusal = std::get_if<Refusal>(&gridded)) return *refusal;
  auto& grid = std::get<GridRecord>(gridded);
  data.record = std::move(grid.record);
  data.advice = grid.advice;
  data.phase_ns = grid.phase_ns;
  data.warnings.insert(data.warnings.end(), grid.warnings.begin(), grid.warnings.end());
  data.file_ticks = std::move(grid.tick_of_row);
  if (request.screening) data.left_out = leave_out_faults(data.record, columns);
  warn_of_held_rows(data, has_time);
  if (auto refusal = derive_inputs(expressions, data)) return *refusal;
  const auto record_row = [&](Index row) {
    return first_row_at(data.record, data.file_ticks[static_cast<std::size_t>(row)]);
  };
  data.identify = {record_row(identify.begin), record_row(identify.end)};
  data.validate = {record_row(validate.begin), record_row(validate.end)};
  if (data.validate.size() == 0 && !data.advice.empty())
    return Refusal{"the validation rows hold no complete tick: " + data.advice};
  if (data.validate.size() == 0)
    return Refusal{
        fmt::format("the validation rows hold none with every column valid; choose others with "
                    "--validate A:B{}{}",
                    data.left_out.empty() ? "" : "; ", fmt::join(left_out_sentences(data), "; "))};
  if (!has_time) warn_of_late_start(data, identify.begin);
  return data;
}

Index file_row(const IdentifyData& data, Index row) {
  return std::lower_bound(data.file_ticks.begin(), data.file_ticks.end(),
                          tick_of_row(data.record, row)) -
         data.file_ticks.begin();
}

}  // namespace reident::cli
