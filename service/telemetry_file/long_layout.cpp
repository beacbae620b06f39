#include "service/telemetry_file/long_layout.hpp"

#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

/// From the surest on.
constexpr std::array<std::string_view, 25> parameter_names = {
    "parameter",    "parametername", "param",  "mnemonic", "field",  "tagname",    "tag",
    "pointname",    "point",         "signal", "channel",  "metric", "sensor",     "variable",
    "item",         "nodeid",        "series", "name",     "key",    "messstelle", "varname",
    "variablename", "entityid",      "entity", "pid"};
constexpr std::array<std::string_view, 15> value_names = {
    "value",    "engvalue", "engineeringvalue", "calibratedvalue", "eng",
    "varvalue", "wert",     "messwert",         "valeur",          "valor",
    "valore",   "val",      "reading",          "state",           "data"};

constexpr std::array<std::string_view, 10> unit_names = {
    "unit",     "units",  "einheit",         "einheiten",        "engunit",
    "engunits", "unidad", "engineeringunit", "engineeringunits", "uom"};

std::string letters_of(std::string_view name) {
  std::string letters;
  for (const char c : name)
    if (c >= 'A' && c <= 'Z')
      letters += static_cast<char>(c | 0x20);
    else if (c >= 'a' && c <= 'z')
      letters += c;
  return letters;
}

template <std::size_t count>
std::optional<std::size_t> column_of(const std::vector<std::string>& columns,
                                     const std::array<std::string_view, count>& names) {
  for (const std::string_view name : names)
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (letters_of(columns[c]) == name) return c;
  return std::nullopt;
}

std::string in_quotes(std::string_view cell) {
  std::string text = "\"";
  for (const char c : cell) text += c == '"' ? "\"\"" : std::string(1, c);
  return text + "\"";
}

/// What stands in one cell of the table, a number in its shortest spelling.
std::string cell_text(const TelemetryFile& file, std::size_t column) {
  const Cell cell = file.cell(column);
  if (cell.kind == Cell::Kind::number && !cell.is_flagged) return fmt::format("{}", cell.value);
  return in_quotes(trimmed(file.cells()[column]));
}

/// Samples of one time, each of another parameter.
struct Row {
  std::vector<std::string> cells;  // by parameter, short of the last
  std::vector<std::uint64_t> lines;
};

class Table {
 public:
  explicit Table(bool is_absolute) : is_absolute_(is_absolute) {}

  /// A second sample of a parameter at a time gets a row of its own.
  void add(const TelemetryFile& file, LongLayout layout) {
    const std::size_t column = position_of(trimmed(file.cells()[layout.parameter]));
    auto& rows = rows_[file.time_ns()];
    auto row = std::partition_point(rows.begin(), rows.end(), [column](const Row& one) {
      return column + 1 < one.lines.size() && one.lines[column + 1] != 0;
    });
    if (row == rows.end()) row = rows.insert(rows.end(), Row{});
    if (row->cells.size() <= column) {
      row->cells.resize(column + 1);
      row->lines.resize(column + 2);  // behind that of the time
    }
    row->cells[column] = cell_text(file, layout.value);
    row->lines[column + 1] = file.line();
  }

  std::string text(const std::string& time_name) const {
    std::string text = in_quotes(time_name);
    for (const std::string& parameter : parameters_) text += "," + in_quotes(parameter);
    text += '\n';
    for (const auto& [time, rows] : rows_)
      for (const Row& row : rows) {
        text += is_absolute_ ? time_text(time) : fmt::format("{}e-9", time);
        for (std::size_t c = 0; c < parameters_.size(); ++c)
          text += c < row.cells.size() ? "," + row.cells[c] : ",";
        text += '\n';
      }
    return text;
  }

  std::vector<std::vector<std::uint64_t>> lines() && {
    std::vector<std::vector<std::uint64_t>> lines;
    for (auto& [time, rows] : rows_)
      for (Row& row : rows) lines.push_back(std::move(row.lines));
    return lines;
  }

 private:
  std::size_t position_of(std::string_view name) {
    auto at = positions_.find(name);
    if (at == positions_.end()) {
      at = positions_.emplace(name, parameters_.size()).first;
      parameters_.emplace_back(name);
    }
    return at->second;
  }

  bool is_absolute_;
  std::vector<std::string> parameters_;
  std::map<std::string, std::size_t, std::less<>> positions_;
  std::map<std::int64_t, std::vector<Row>> rows_;
};

/// What is wrong with the sample of a row that can be read.
std::optional<Error> check_sample(const TelemetryFile& file, LongLayout layout,
                                  UnitsOfParameters& units) {
  const std::string_view parameter = trimmed(file.cells()[layout.parameter]);
  if (parameter.empty())
    return file.cell_error(layout.parameter,
                           "names no parameter; mend the line, or leave such lines out with "
                           "--skip-bad-lines");
  if (!layout.unit) return std::nullopt;
  const auto wrong = units.check(parameter, trimmed(file.cells()[*layout.unit]), file.line());
  return wrong ? std::optional(file.error_here(*wrong)) : std::nullopt;
}

/// Reads all samples. Bad lines are an error, or left out and counted.
std::optional<Error> read_samples(TelemetryFile& file, LongLayout layout, bool skip_bad_lines,
                                  Table& table, LeftOut& left_out) {
  UnitsOfParameters units;
  for (auto step = file.next(); step != TelemetryFile::Step::end; step = file.next()) {
    std::optional<Error> error;
    Damage damage = Damage::value;
    if (step == TelemetryFile::Step::error) {
      error = file.error();
      damage = file.damage();
    } else {
      error = check_sample(file, layout, units);
    }
    if (!error)
      table.add(file, layout);
    else if (skip_bad_lines && damage != Damage::none)
      left_out.add(damage, *error);
    else
      return error;
  }
  return std::nullopt;
}

}  // namespace

std::optional<LongLayout> find_long_layout(const std::vector<std::string>& columns) {
  const auto value = column_of(columns, value_names),
             parameter = column_of(columns, parameter_names);
  if (!value || !parameter) return std::nullopt;
  return LongLayout{*parameter, *value, column_of(columns, unit_names)};
}

std::optional<LongLayout> find_long_layout(const TelemetryFile& file) {
  const auto layout = find_long_layout(file.columns());
  if (!layout || file.columns()[layout->parameter] == "parameter") return layout;
  const auto kind = file.format(layout->parameter).kind;
  const bool are_words = kind == CellFormat::Kind::text || kind == CellFormat::Kind::state;
  return are_words ? layout : std::nullopt;
}

std::optional<std::string> UnitsOfParameters::check(std::string_view parameter,
                                                    std::string_view unit, std::uint64_t line) {
  if (unit.empty() || (parameter == last_parameter_ && unit == last_unit_)) return std::nullopt;
  auto at = first_.find(parameter);
  if (at == first_.end()) at = first_.emplace(parameter, First{std::string(unit), line}).first;
  if (const First& first = at->second; first.unit != unit)
    return fmt::format(
        "parameter '{}' is in {} here and in {} in line {}; write all its samples in one unit, or "
        "those of one unit under another name",
        parameter, unit, first.unit, first.line);
  last_parameter_ = parameter;
  last_unit_ = unit;
  return std::nullopt;
}

std::variant<TelemetryFile, Error> open_as_table(const std::filesystem::path& path,
                                                 const ReadingOptions& options,
                                                 bool skip_bad_lines) {
  auto opened = TelemetryFile::open(path, options);
  if (std::holds_alternative<Error>(opened)) return opened;
  auto& file = std::get<TelemetryFile>(opened);
  const auto layout = find_long_layout(file);
  if (!layout || !file.has_rows()) return opened;
  if (auto error = file.find_time(true)) return *std::move(error);
  const bool is_absolute = file.clock().is_absolute();
  Table table(is_absolute);
  LeftOut left_out;
  if (auto error = read_samples(file, *layout, skip_bad_lines, table, left_out))
    return *std::move(error);
  ReadingOptions plain;
  plain.dialect.separator = ',';
  plain.dialect.header_line = 1;
  plain.dialect.comment = "";
  plain.cells = options.cells;
  plain.cells.style = NumberStyle{};
  const std::string& time_name = file.columns()[file.clock().columns().front()];
  plain.time.column = time_name;
  plain.force_times = options.force_times;
  plain.any_epoch = options.any_epoch;
  plain.latest_ns = options.latest_ns;
  plain.time.format = is_absolute ? TimeFormat::text : TimeFormat::elapsed;
  if (!is_absolute) plain.time.unit_ns = second_ns;  // whatever the name says
  MadeOf made_of{file.found() + "; one sample a row", file.remarks(), {}};
  for (std::string& sentence : left_out.sentences()) made_of.remarks.push_back(std::move(sentence));
  std::string text = table.text(time_name);
  made_of.lines = std::move(table).lines();
  return TelemetryFile::of_text(std::move(text), path.string(), plain, std::move(made_of));
}

}  // namespace reident::telemetry_file
