#include "service/telemetry_file/dialect.hpp"

#include <algorithm>
#include <map>

#include "service/support/text.hpp"
#include "service/telemetry_file/head_lines.hpp"
#include "service/telemetry_file/header_finder.hpp"
#include "service/telemetry_file/row_shape.hpp"

namespace reident::telemetry_file {
namespace {

std::optional<Error> take_names(Dialect& dialect, const DialectOptions& options,
                                std::vector<std::string> cells, const std::string& name) {
  for (std::string& cell : cells) {
    for (char& c : cell)
      if (c == '\n' || c == '\r') c = ' ';
    cell = std::string(trimmed(cell));
  }
  if (std::all_of(cells.begin(), cells.end(), [](const std::string& cell) {
        return cell.size() > 2 && cell.front() == '\'' && cell.back() == '\'';
      }))
    for (std::string& cell : cells) cell = cell.substr(1, cell.size() - 2);
  const std::size_t usual = dialect.layout.cells;
  if (!options.names.empty()) {
    if (options.names.size() != usual)
      return at_line(name, dialect.first_line,
                     "--names gives " + std::to_string(options.names.size()) +
                         " names, the rows have " + std::to_string(usual) + " cells");
    cells = options.names;
  }
  for (; cells.size() > usual; cells.pop_back())
    if (!cells.back().empty())
      dialect.without_cells.insert(dialect.without_cells.begin(), cells.back());
  auto sorted = cells;
  std::sort(sorted.begin(), sorted.end());
  for (auto twin = std::adjacent_find(sorted.begin(), sorted.end()); twin != sorted.end();
       twin = std::adjacent_find(twin + 1, sorted.end()))
    if (!twin->empty())
      return at_line(name, std::max<std::uint64_t>(dialect.header_line, 1),
                     "two columns are called '" + *twin +
                         "'; give each column its own name, in the file or with --names");
  dialect.columns = std::move(cells);
  return std::nullopt;
}

/// Takes the line of units that was given in place of the one that was found.
std::optional<Error> take_units(const HeadLines& lines, std::optional<std::uint64_t> wanted,
                                const std::string& name, HeaderPlace& found) {
  if (!wanted) return std::nullopt;
  found.units.reset();
  if (*wanted == 0) return std::nullopt;
  const auto units = static_cast<std::size_t>(*wanted) - 1;
  const std::string option = "--units " + std::to_string(*wanted);
  if (units >= lines.size()) return whole_file(name, option + " is behind the last line");
  if (!found.header || units <= *found.header || lines[units].cells.empty())
    return whole_file(name, option + " is not a line below the header");
  found.units = units;
  found.first_row = std::max(found.first_row, units + 1);
  return std::nullopt;
}

/// The separator in a first line "sep=;".
std::optional<char> told_separator(const HeadLines& lines) {
  if (lines.empty()) return std::nullopt;
  const std::string_view text = trimmed(lines[0].text);
  if (text.size() == 5 && (text.starts_with("sep=") || text.starts_with("SEP="))) return text[4];
  if (lines[0].text == "sep=\t") return '\t';
  return std::nullopt;
}

/// A text whose lines are one cell each is no table, or one that something unusual separates.
std::optional<Error> refuse_one_cell(const HeadLines& lines, const Layout& layout,
                                     const DialectOptions& options, const std::string& name) {
  const auto first = std::find_if_not(lines.begin(), lines.end(), [&](const HeadLine& line) {
    return is_blank(line) || is_comment(line, layout.comment);
  });
  if (first == lines.end()) return std::nullopt;
  const std::string_view text = trimmed(first->text);
  if (text.starts_with('<') || text.starts_with('{') || text.starts_with("[{") || text == "[")
    return at_line(name, first->number,
                   "the text is HTML, XML or JSON and no table of cells; write it as CSV first, as "
                   "jq -r '[.time, .value] | @csv' does of JSON with these members");
  for (const std::string_view word : {"INSERT INTO ", "CREATE TABLE ", "insert into "})
    if (text.starts_with(word))
      return at_line(name, first->number,
                     "the text is SQL and no table of cells; run it in a database, and have that "
                     "write CSV: sqlite3 -csv -header FILE 'SELECT ...'");
  if (layout.cells == 0 && options.names.empty())
    return at_line(name, first->number,
                   "no line can be cut into cells, since their quotes are not paired ('" +
                       std::string(text.substr(0, 40)) + "'); mend the quotes");
  const bool is_quoted = text.size() > 2 && text.front() == '"' && text.back() == '"' &&
                         text.find_first_of(",;\t|") != std::string_view::npos;
  if (layout.cells == 1 && is_quoted && options.names.size() != 1)
    return at_line(name, first->number,
                   "the line is one quoted cell ('" + std::string(text.substr(0, 40)) +
                       "'); remove the quotes around the lines");
  if (layout.cells > 1 || options.separator || options.names.size() == 1 || lines.size() < 3)
    return std::nullopt;
  return at_line(name, first->number,
                 "no comma, semicolon, tab, bar or blank cuts the lines into cells ('" +
                     std::string(text.substr(0, 40)) + "'); name what does with --separator");
}

}  // namespace

std::variant<Dialect, Error> find_dialect(const RowReader::Head& head,
                                          const DialectOptions& options, const std::string& name) {
  Dialect dialect;
  Layout& layout = dialect.layout;
  layout.line_end = options.line_end.value_or(find_line_end(head.text));
  HeadLines lines = lines_of(head, layout.line_end);
  if (std::all_of(lines.begin(), lines.end(), is_blank))
    return whole_file(name,
                      "the file is empty; a header row with the names of the columns is needed");
  std::optional<char> separator = options.separator;
  const auto told = told_separator(lines);
  if (told && !separator) separator = told;
  if (told) lines[0].text = {};
  layout.comment = options.comment ? *options.comment : find_comment(lines);
  if (!head.is_all && std::all_of(lines.begin(), lines.end(), [&](const HeadLine& line) {
        return is_blank(line) || is_comment(line, layout.comment);
      }))
    return at_line(name, lines.back().number,
                   "up to here stand comments alone, more than are looked through; cut them off");
  layout.separator = separator ? *separator : find_separator(lines, layout.comment);
  split(lines, layout.separator);
  if (is_of_blanks(layout.separator))
    layout.places = find_places(lines, layout.separator, layout.comment);
  layout.cells = usual_cells(lines, layout.comment);
  if (auto error = refuse_one_cell(lines, layout, options, name)) return *std::move(error);
  if (!options.names.empty() && layout.cells == 0) layout.cells = options.names.size();
  join_cells(lines, layout);
  auto found = find_header(lines, layout, options, name);
  if (const auto* error = std::get_if<Error>(&found)) return *error;
  if (auto error = take_units(lines, options.units_line, name, std::get<HeaderPlace>(found)))
    return *std::move(error);
  const auto& [first_row, header, units] = std::get<HeaderPlace>(found);
  std::vector<std::string> cells;
  if (header) {
    const HeadLine& line = lines[*header];
    cells = line.cells;
    dialect.header_line = line.number;
    layout.header = line.text;
    if (is_comment(line, layout.comment)) layout.header.clear();
  } else {
    for (std::size_t c = 0; c < layout.cells; ++c)
      cells.push_back("column " + std::to_string(c + 1));
  }
  if (cells.size() + 1 == layout.cells) layout.cells = cells.size();
  for (const HeadLine& line : lines)
    if (line.number < (header ? dialect.header_line : first_row + 1) && !is_blank(line))
      dialect.above.push_back({line.number, std::string(line.text)});
  if (first_row < lines.size()) {
    dialect.first_line = lines[first_row].number;
    dialect.first_position = lines[first_row].position;
  } else {
    dialect.first_line = lines.back().number + 1;
    dialect.first_position = lines.back().position + lines.back().text.size();
    const std::string_view rest = head.text.substr(dialect.first_position);
    dialect.first_position += rest.starts_with("\r\n") ? 2U : rest.empty() ? 0U : 1U;
  }
  if (auto error = take_names(dialect, options, std::move(cells), name)) return *std::move(error);
  layout.cells = dialect.columns.size();
  if (layout.places.size() != layout.cells + (layout.joins_date ? 1 : 0)) layout.places.clear();
  if (units) {
    dialect.units_line = lines[*units].number;
    for (const std::string& cell : lines[*units].cells) dialect.units.emplace_back(trimmed(cell));
    dialect.units.resize(dialect.columns.size());
    for (std::string& unit : dialect.units)
      if (unit.size() > 2 && (unit.front() == '[' || unit.front() == '('))
        unit = unit.substr(1, unit.size() - 2);
  }
  return dialect;
}

std::string describe(const Dialect& dialect) {
  static const std::map<char, std::string> words = {
      {',', "commas"}, {';', "semicolons"}, {'\t', "tabs"},
      {'|', "bars"},   {' ', "blanks"},     {two_blanks, "two blanks or more"}};
  const auto word = words.find(dialect.layout.separator);
  std::string text = word == words.end()
                         ? "separated by '" + std::string(1, dialect.layout.separator) + "'"
                         : word->second;
  if (!dialect.layout.places.empty()) text += " between columns of fixed width";
  const std::string rows_from =
      dialect.first_line > 1 ? ", rows from line " + std::to_string(dialect.first_line) : "";
  text += dialect.header_line == 0 ? ", no header" + rows_from
                                   : ", header in line " + std::to_string(dialect.header_line);
  if (dialect.units_line != 0) text += ", units in line " + std::to_string(dialect.units_line);
  if (!dialect.without_cells.empty()) text += ", no cells of " + joined(dialect.without_cells);
  if (dialect.layout.line_end == '\r') text += ", lines end in CR";
  if (!dialect.layout.comment.empty()) text += ", comments begin with " + dialect.layout.comment;
  return text;
}

}  // namespace reident::telemetry_file
