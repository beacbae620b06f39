#include "service/cli/identify_data.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "identification/samples/grid.hpp"
#include "identification/screening/sample_hold.hpp"
#include "service/cli/identify_screening.hpp"
#include "service/support/csv.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli {
namespace {

using identification::Index;
using identification::Record;
using identification::RowRange;

// The daemon's default: a sample serves this many periods.
constexpr std::int64_t sample_hold_periods = 3;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Columns by the names of the request, a name with commas in it taken apart where the file has no
/// such column. The order of the request stays; names among `derived` are no columns.
std::variant<std::vector<std::string>, Refusal> resolve(const csv::Reader& reader,
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
                                      const DataRequest& request, const csv::Reader& reader) {
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

/// Resolves the names of the request in place.
std::optional<Refusal> resolve_columns(const std::vector<DerivedInput>& derived,
                                       DataRequest& request) {
  std::error_code ignored;
  if (std::filesystem::is_character_file(request.file, ignored) ||
      std::filesystem::is_fifo(request.file, ignored))
    return Refusal{
        fmt::format("{} can be read only once; save it to a file first", request.file.string())};
  auto opened = csv::Reader::open(request.file);
  if (const auto* error = std::get_if<csv::Error>(&opened)) return Refusal{error->message};
  const auto& reader = std::get<csv::Reader>(opened);
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
  if (!request.time) return std::nullopt;
  if (seen.contains(*request.time))
    return Refusal{
        fmt::format("--time {} is an input or output too; leave it out there", *request.time)};
  const auto found = reader.find(*request.time);
  if (const auto* error = std::get_if<csv::Error>(&found))
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

std::optional<Refusal> refuse_empty_columns(const csv::Table& table,
                                            const std::vector<std::string>& columns) {
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (std::none_of(table.values[c].begin(), table.values[c].end(),
                     [](double value) { return std::isfinite(value); }))
      return Refusal{
          fmt::format("column {} holds no number; name a column of numbers", columns[c])};
  return std::nullopt;
}

bool complete(const csv::Table& table, std::size_t row) {
  return std::all_of(table.values.begin(), table.values.end(),
                     [row](const auto& column) { return std::isfinite(column[row]); });
}

/// Rows one period apart; those with a missing cell are holes. Ticks are rows of the file.
Record record_of_rows(const csv::Table& table, std::size_t inputs, double period_s) {
  std::vector<std::size_t> kept;
  Record record;
  record.period_s = period_s;
  for (std::size_t row = 0; row < table.rows; ++row) {
    if (!complete(table, row)) continue;
    const auto at = static_cast<Index>(kept.size());
    if (kept.empty() || kept.back() + 1 != row)
      record.segments.push_back({at, at, static_cast<std::int64_t>(row)});
    record.segments.back().end = at + 1;
    kept.push_back(row);
  }
  const auto rows = static_cast<Index>(kept.size());
  record.u.resize(rows, static_cast<Index>(inputs));
  record.y.resize(rows, static_cast<Index>(table.values.size() - inputs));
  for (std::size_t c = 0; c < table.values.size(); ++c)
    for (Index r = 0; r < rows; ++r) {
      const double value = table.values[c][kept[static_cast<std::size_t>(r)]];
      if (c < inputs)
        record.u(r, static_cast<Index>(c)) = value;
      else
        record.y(r, static_cast<Index>(c - inputs)) = value;
    }
  return record;
}

/// Steps of the time column that are not zero, or why it cannot be used.
std::variant<std::vector<std::int64_t>, Refusal> steps_of(const std::vector<std::int64_t>& time_ns,
                                                          const std::string& column) {
  std::vector<std::int64_t> steps;
  for (std::size_t row = 1; row < time_ns.size(); ++row) {
    if (time_ns[row] < time_ns[row - 1])
      return Refusal{
          fmt::format("--time {}: row {} is earlier than the row before it; sort the "
                      "file by its time",
                      column, row)};
    if (time_ns[row] > time_ns[row - 1]) steps.push_back(time_ns[row] - time_ns[row - 1]);
  }
  if (steps.empty())
    return Refusal{
        fmt::format("--time {} never moves; name a column that holds the time of each "
                    "row",
                    column)};
  return steps;
}

std::int64_t median(std::vector<std::int64_t> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::variant<std::int64_t, Refusal> period_of(const DataRequest& request,
                                              const std::vector<std::int64_t>& steps,
                                              std::vector<std::string>& warnings) {
  const std::int64_t usual = median(steps);
  if (!request.period_s) {
    warnings.push_back(
        fmt::format("the rows were put on a grid of {}, the median step of {}; "
                    "--period chooses another",
                    duration_text(usual), *request.time));
    return usual;
  }
  const auto period = static_cast<std::int64_t>(std::llround(*request.period_s * 1e9));
  const std::int64_t least = (usual + sample_hold_periods - 1) / sample_hold_periods;
  if (period < least)
    return Refusal{
        fmt::format("--period {} is too short for {}, whose median step is {}: a sample "
                    "serves {} periods; make it at least {}",
                    *request.period_s, *request.time, duration_text(usual), sample_hold_periods,
                    duration_text(least))};
  return period;
}

Record record_of_times(const csv::Table& table, std::size_t inputs, std::int64_t period_ns) {
  const std::vector<std::uint8_t> usable(table.rows, 1);
  std::vector<identification::ChannelSamples> channels;
  for (const std::vector<double>& column : table.values)
    channels.push_back({table.time_ns, column, usable});
  const std::span all(channels);
  return make_record(all.first(inputs), all.subspan(inputs), table.time_ns.front(),
                     table.time_ns.back() + 1, {period_ns, sample_hold_periods * period_ns});
}

/// First tick at or after the time of a row of the file; after the last row's, the end.
std::int64_t tick_of_row(const csv::Table& table, Index row, std::int64_t period_ns) {
  const bool at_end = row == static_cast<Index>(table.rows);
  const std::int64_t time =
      at_end ? table.time_ns.back() + 1 : table.time_ns[static_cast<std::size_t>(row)];
  return time / period_ns + (time % period_ns > 0 ? 1 : 0);
}

void warn_of_missing(const csv::Table& table, std::vector<std::string>& warnings) {
  std::size_t missing = 0;
  for (std::size_t row = 0; row < table.rows; ++row) missing += complete(table, row) ? 0u : 1u;
  if (missing != 0)
    warnings.push_back(
        fmt::format("{} of {} rows have a missing or non-numeric cell and were left "
                    "out; the record is split there",
                    missing, table.rows));
}

/// Puts the derived inputs in the place of the columns that they follow from.
void derive_inputs(InputExpressions& expressions, IdentifyData& data) {
  const Index before = data.record.rows();
  data.record = expressions.evaluate(std::move(data.record));
  if (const Index lost = before - data.record.rows(); lost != 0)
    data.warnings.push_back(
        fmt::format("at {} of {} rows a derived input has no finite value; they were left out and "
                    "the record is split there",
                    lost, before));
}

void warn_of_held_rows(IdentifyData& data) {
  const Index rows = rows_per_sample(data.record);
  if (rows > 1)
    data.warnings.push_back(fmt::format(
        "each value stands for {0} rows in every column: --period {1:g} takes every {0}th row, "
        "which is all that the file holds",
        rows, static_cast<double>(rows) * data.record.period_s));
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

}  // namespace

std::variant<IdentifyData, Refusal> read_data(const DataRequest& asked) {
  DataRequest request = asked;
  auto derived = parse_derived(request.derive);
  if (const auto* refusal = std::get_if<Refusal>(&derived)) return *refusal;
  IdentifyData data;
  data.derived = std::get<std::vector<DerivedInput>>(std::move(derived));
  if (auto refusal = resolve_columns(data.derived, request)) return *refusal;
  InputExpressions expressions(request.inputs, data.derived);
  std::vector<std::string> columns = expressions.parameters();
  const std::size_t inputs = columns.size();
  columns.insert(columns.end(), request.outputs.begin(), request.outputs.end());
  auto read = csv::read_table(request.file, columns, request.time);
  if (const auto* error = std::get_if<csv::Error>(&read)) return Refusal{error->message};
  const auto& table = std::get<csv::Table>(read);
  if (table.rows == 0) return Refusal{"the file has no row of data below its header"};
  if (auto refusal = refuse_empty_columns(table, columns)) return *refusal;
  const auto ranges = parse_ranges(request, static_cast<Index>(table.rows));
  if (const auto* refusal = std::get_if<Refusal>(&ranges)) return *refusal;
  const auto& [identify, validate] = std::get<FileRanges>(ranges);

  data.inputs = request.inputs;
  data.outputs = request.outputs;
  warn_of_missing(table, data.warnings);
  if (std::max(identify.begin, validate.begin) < std::min(identify.end, validate.end))
    data.warnings.push_back(
        "the validation rows overlap the identification rows: the validation error is not an error "
        "on unseen data");
  std::int64_t period_ns = 0;
  if (request.time) {
    const auto steps = steps_of(table.time_ns, *request.time);
    if (const auto* refusal = std::get_if<Refusal>(&steps)) return *refusal;
    const auto period =
        period_of(request, std::get<std::vector<std::int64_t>>(steps), data.warnings);
    if (const auto* refusal = std::get_if<Refusal>(&period)) return *refusal;
    period_ns = std::get<std::int64_t>(period);
    data.record = record_of_times(table, inputs, period_ns);
  } else {
    data.record = record_of_rows(table, inputs, request.period_s.value_or(1));
  }
  const auto tick_of = [&](Index row) {
    return request.time ? tick_of_row(table, row, period_ns) : std::int64_t{row};
  };
  for (Index row = 0; row < static_cast<Index>(table.rows); ++row)
    data.file_ticks.push_back(tick_of(row));
  if (request.screening) data.left_out = leave_out_faults(data.record, columns);
  warn_of_held_rows(data);
  derive_inputs(expressions, data);
  const auto record_row = [&](Index row) { return first_row_at(data.record, tick_of(row)); };
  data.identify = {record_row(identify.begin), record_row(identify.end)};
  data.validate = {record_row(validate.begin), record_row(validate.end)};
  if (data.validate.size() == 0)
    return Refusal{
        fmt::format("the validation rows hold none with every column valid; choose others with "
                    "--validate A:B{}{}",
                    data.left_out.empty() ? "" : "; ", fmt::join(left_out_sentences(data), "; "))};
  if (!request.time) warn_of_late_start(data, identify.begin);
  return data;
}

}  // namespace reident::cli
