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
constexpr std::array<std::string_view, 20> parameter_names = {
    "parameter", "parametername", "param",  "mnemonic", "field",  "tagname",   "tag",
    "pointname", "point",         "signal", "channel",  "metric", "sensor",    "variable",
    "item",      "nodeid",        "series", "name",     "key",    "messstelle"};
constexpr std::array<std::string_view, 8> value_names = {"value",  "engvalue", "wert",   "messwert",
                                                         "valeur", "valor",    "valore", "val"};

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

struct Table {
  std::vector<std::string> parameters;
  std::map<std::int64_t, std::vector<std::string>> rows;  // cells by parameter, short of the last
};

std::variant<Table, Error> table_of(TelemetryFile& file, LongLayout layout) {
  Table table;
  std::map<std::string, std::size_t, std::less<>> positions;
  for (auto step = file.next(); step != TelemetryFile::Step::end; step = file.next()) {
    if (step == TelemetryFile::Step::error) return file.error();
    const std::string_view name = trimmed(file.cells()[layout.parameter]);
    if (name.empty()) return file.cell_error(layout.parameter, "names no parameter; mend the line");
    auto at = positions.find(name);
    if (at == positions.end()) {
      at = positions.emplace(name, table.parameters.size()).first;
      table.parameters.emplace_back(name);
    }
    auto& cells = table.rows[file.time_ns()];
    if (cells.size() <= at->second) cells.resize(at->second + 1);
    cells[at->second] = cell_text(file, layout.value);
  }
  return table;
}

std::string text_of(const Table& table, const std::string& time_name, bool is_absolute) {
  std::string text = in_quotes(time_name);
  for (const std::string& parameter : table.parameters) text += "," + in_quotes(parameter);
  text += '\n';
  for (const auto& [time, cells] : table.rows) {
    text += is_absolute ? time_text(time) : fmt::format("{}e-9", time);
    for (std::size_t c = 0; c < table.parameters.size(); ++c)
      text += c < cells.size() ? "," + cells[c] : ",";
    text += '\n';
  }
  return text;
}

}  // namespace

std::optional<LongLayout> find_long_layout(const std::vector<std::string>& columns) {
  const auto value = column_of(columns, value_names),
             parameter = column_of(columns, parameter_names);
  return value && parameter ? std::optional(LongLayout{*parameter, *value}) : std::nullopt;
}

std::optional<LongLayout> find_long_layout(const TelemetryFile& file) {
  const auto layout = find_long_layout(file.columns());
  if (!layout || file.columns()[layout->parameter] == "parameter") return layout;
  const auto kind = file.format(layout->parameter).kind;
  const bool are_words = kind == CellFormat::Kind::text || kind == CellFormat::Kind::state;
  return are_words ? layout : std::nullopt;
}

std::variant<TelemetryFile, Error> open_as_table(const std::filesystem::path& path,
                                                 const ReadingOptions& options) {
  auto opened = TelemetryFile::open(path, options);
  if (std::holds_alternative<Error>(opened)) return opened;
  auto& file = std::get<TelemetryFile>(opened);
  const auto layout = find_long_layout(file);
  if (!layout || !file.has_rows()) return opened;
  if (auto error = file.find_time(true)) return *std::move(error);
  auto read = table_of(file, *layout);
  if (auto* error = std::get_if<Error>(&read)) return std::move(*error);
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
  const bool is_absolute = file.clock().is_absolute();
  plain.time.format = is_absolute ? TimeFormat::text : TimeFormat::elapsed;
  if (!is_absolute) plain.time.unit_ns = second_ns;  // whatever the name says
  return TelemetryFile::of_text(text_of(std::get<Table>(read), time_name, is_absolute),
                                path.string() + " as a table", plain,
                                file.found() + "; one sample a row");
}

}  // namespace reident::telemetry_file
