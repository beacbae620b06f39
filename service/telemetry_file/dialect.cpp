#include "service/telemetry_file/dialect.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "service/support/text.hpp"
#include "service/telemetry_file/clock_names.hpp"
#include "service/telemetry_file/head_lines.hpp"
#include "service/telemetry_file/row_shape.hpp"

namespace reident::telemetry_file {
namespace {

constexpr std::size_t rows_above_a_header = 5;  // of metadata that look like data

/// Which columns of the rows hold values.
std::vector<bool> value_columns(const HeadLines& lines, const std::string& comment,
                                std::size_t usual) {
  std::vector<const HeadLine*> rows;  // each text once: a header may come again
  std::set<std::string_view> seen;
  for (const HeadLine& line : lines)
    if (!is_comment(line, comment) && line.cells.size() >= usual && seen.insert(line.text).second)
      rows.push_back(&line);
  std::vector<std::size_t> values(usual), cells(usual);
  for (std::size_t i = rows.size() / 2; i < rows.size(); ++i)
    for (std::size_t c = 0; c < usual; ++c) {
      if (trimmed(rows[i]->cells[c]).empty()) continue;
      ++cells[c];
      if (looks_like_value(rows[i]->cells[c])) ++values[c];
    }
  std::vector<bool> result(usual);
  for (std::size_t c = 0; c < usual; ++c) result[c] = values[c] * 2 > cells[c];
  return result;
}

/// Whether a line is a row: a value stands in a column of values.
bool is_row(const HeadLine& line, const std::vector<bool>& values) {
  for (std::size_t c = 0; c < values.size() && c < line.cells.size(); ++c)
    if (values[c] && looks_like_value(line.cells[c])) return true;
  return false;
}

/// Where a name stands in the column that all rows begin with, numbers are names of parameters.
bool names_parameters(const HeadLine& line, const std::vector<bool>& values) {
  const auto first = std::find(values.begin(), values.end(), true);
  if (first == values.end()) return true;
  const std::string& cell = line.cells[static_cast<std::size_t>(first - values.begin())];
  return !trimmed(cell).empty() && !looks_like_value(cell) &&
         trimmed(cell).find_first_of("0123456789#") == std::string_view::npos;
}

/// HeadLines by their number among those of the usual number of cells.
class Head {
 public:
  Head(const HeadLines& lines, const std::string& comment, std::size_t usual)
      : lines_(lines),
        comment_(comment),
        usual_(usual),
        values_(value_columns(lines, comment, usual)) {}

  bool has_cells(std::size_t i) const {
    const HeadLine& line = lines_[i];
    if (is_blank(line) || is_comment(line, comment_)) return false;
    const std::size_t count = line.cells.size();
    return count == usual_ || (count == usual_ + 1 && trimmed(line.cells.back()).empty());
  }
  /// A line of names, units or descriptions.
  bool is_text(std::size_t i, bool is_first) const {
    if (!has_cells(i)) return false;
    if (std::find(values_.begin(), values_.end(), true) == values_.end()) return is_first;
    if (!is_row(lines_[i], values_)) return true;
    return is_first && names_parameters(lines_[i], values_);
  }
  /// The first line of the rows: behind the last lines of text at the top.
  std::size_t first_row() const {
    std::size_t rows = 0, last_text = lines_.size();
    std::set<std::string_view> seen;
    bool is_first = true;
    for (std::size_t i = 0; i < lines_.size() && rows <= rows_above_a_header; ++i) {
      if (!has_cells(i)) continue;
      if (is_text(i, is_first)) {
        if (seen.insert(lines_[i].text).second) last_text = i;
      } else {
        ++rows;
      }
      is_first = false;
    }
    for (std::size_t i = last_text == lines_.size() ? 0 : last_text + 1; i < lines_.size(); ++i)
      if (has_cells(i) ||
          (!is_blank(lines_[i]) && !is_comment(lines_[i], comment_) && last_text != lines_.size()))
        return i;
    return lines_.size();
  }
  /// The lines of text right above the rows, the upper one first.
  std::vector<std::size_t> block_above(std::size_t first_row) const {
    std::vector<std::size_t> block;
    for (std::size_t i = first_row; i-- > 0;) {
      if (is_blank(lines_[i]) || is_comment(lines_[i], comment_)) {
        if (block.empty()) continue;
        break;
      }
      if (!is_text(i, true)) break;
      block.insert(block.begin(), i);
    }
    return block;
  }

 private:
  const HeadLines& lines_;
  const std::string& comment_;
  std::size_t usual_;
  std::vector<bool> values_;
};

/// Whether a word says of what clock a column of times is, as MEZ, or how they are written.
bool is_of_a_clock(std::string_view word) {
  const std::string_view pattern = "dDmMyYhHsSaAjJ.-/: T";
  const bool is_pattern =
      word.find_first_not_of(pattern) == std::string_view::npos &&
      (word.find("yy") != std::string_view::npos || word.find("YY") != std::string_view::npos ||
       word.find("hh") != std::string_view::npos || word.find("HH") != std::string_view::npos);
  return is_pattern || zone_hint_of({}, word);
}

bool are_units(const HeadLine& line) {
  bool any = false;
  for (const std::string& cell : line.cells) {
    const std::string_view word = trimmed(cell);
    if (word.empty() || word == "-") continue;
    if (!is_unit_word(word) && !is_of_a_clock(word)) return false;
    any = true;
  }
  return any;
}

/// Whether no name has a blank in it, as those of programs.
bool are_identifiers(const HeadLine& line) {
  return std::none_of(line.cells.begin(), line.cells.end(), [](const std::string& cell) {
    return trimmed(cell).find(' ') != std::string_view::npos;
  });
}

bool are_names(const HeadLine& line) {
  std::set<std::string_view> seen;
  std::size_t empty = 0;
  for (const std::string& cell : line.cells) {
    if (trimmed(cell).empty())
      ++empty;
    else if (!seen.insert(trimmed(cell)).second)
      return false;
  }
  return empty <= 1;
}

/// The header among lines of text: the one with the names that are wanted; the one above units;
/// the upper of two, whose lower one describes, unless the upper one alone has blanks in its names.
std::size_t header_in(const HeadLines& lines, const std::vector<std::size_t>& block,
                      const std::vector<std::string>& wanted) {
  for (const std::size_t i : block) {
    const auto& cells = lines[i].cells;
    const bool has_all = std::all_of(wanted.begin(), wanted.end(), [&](const std::string& name) {
      return std::any_of(cells.begin(), cells.end(),
                         [&](const std::string& cell) { return trimmed(cell) == name; });
    });
    if (!wanted.empty() && has_all) return i;
  }
  std::vector<std::size_t> names;  // without the units
  for (const std::size_t i : block)
    if (!are_units(lines[i])) names.push_back(i);
  if (names.empty()) return block.front();
  const std::size_t last = names.back();
  if (names.size() == 1) return last;
  const HeadLine& above = lines[names[names.size() - 2]];
  const bool is_pair = names.size() == 2 && are_names(above) &&
                       above.text.find_first_of(":=") == std::string_view::npos &&
                       std::none_of(above.cells.begin(), above.cells.end(), looks_like_value);
  const bool describes =
      !are_identifiers(above) && are_identifiers(lines[last]) && are_names(lines[last]);
  return is_pair && !describes ? names.front() : last;
}

Error whole_file(const std::string& name, std::string_view what) {
  return {name + ": " + std::string(what)};
}
Error at_line(const std::string& name, std::uint64_t line, std::string_view what) {
  return {name + ":" + std::to_string(line) + ": " + std::string(what)};
}

std::optional<Error> take_names(Dialect& dialect, const DialectOptions& options,
                                std::vector<std::string> cells, const std::string& name) {
  for (std::string& cell : cells) {
    for (char& c : cell)
      if (c == '\n' || c == '\r') c = ' ';
    cell = std::string(trimmed(cell));
  }
  const std::size_t usual = dialect.layout.cells;
  if (!options.names.empty()) {
    if (options.names.size() != usual)
      return at_line(name, dialect.first_line,
                     "--names gives " + std::to_string(options.names.size()) +
                         " names, the rows have " + std::to_string(usual) + " cells");
    cells = options.names;
  }
  if (cells.size() == usual + 1 && cells.back().empty()) cells.pop_back();
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

/// The names in a comment right above the rows, as "# time, i_load".
std::optional<std::size_t> header_in_comment(HeadLines& lines, std::size_t first_row,
                                             char separator, const std::string& comment,
                                             std::size_t usual) {
  for (std::size_t i = first_row; i-- > 0;) {
    if (is_blank(lines[i])) continue;
    if (!is_comment(lines[i], comment)) return std::nullopt;
    std::string text(trimmed(lines[i].text.substr(comment.size())));
    std::vector<std::string_view> cells;
    if (split_cells(text, separator, cells)) return std::nullopt;
    HeadLine& line = lines[i];
    line.cells.assign(cells.begin(), cells.end());
    if (cells.size() == usual && are_names(line)) return i;
    return std::nullopt;
  }
  return std::nullopt;
}

/// A line right above the rows that holds names, more or less than there are cells.
const HeadLine* names_of_other_count(const HeadLines& lines, std::size_t first_row,
                                     const Layout& layout) {
  for (std::size_t i = std::min(first_row, lines.size()); i-- > 0;) {
    if (is_blank(lines[i]) || is_comment(lines[i], layout.comment)) continue;
    const auto& cells = lines[i].cells;
    const bool is_text = cells.size() > 1 && cells.size() != layout.cells &&
                         std::none_of(cells.begin(), cells.end(), looks_like_value);
    return is_text ? &lines[i] : nullptr;
  }
  return nullptr;
}

struct Found {
  std::size_t first_row = 0;
  std::optional<std::size_t> header, units;
};

std::variant<Found, Error> find_header(HeadLines& lines, const Dialect& dialect,
                                       const DialectOptions& options, const std::string& name) {
  const Layout& layout = dialect.layout;
  const Head head(lines, layout.comment, layout.cells);
  Found found;
  if (options.header_line) {
    const std::uint64_t wanted = *options.header_line;
    if (wanted > lines.size())
      return whole_file(name, "--header " + std::to_string(wanted) + " is behind the last line");
    if (wanted > 0) found.header = static_cast<std::size_t>(wanted) - 1;
    found.first_row = found.header ? *found.header + 1 : 0;
    while (found.first_row < lines.size() &&
           (!head.has_cells(found.first_row) || head.is_text(found.first_row, false))) {
      if (found.header && head.has_cells(found.first_row) && are_units(lines[found.first_row]))
        found.units = found.first_row;
      ++found.first_row;
    }
    return found;
  }
  found.first_row = head.first_row();
  const auto block = head.block_above(found.first_row);
  if (block.empty()) {
    found.header =
        header_in_comment(lines, found.first_row, layout.separator, layout.comment, layout.cells);
    if (found.header || !options.names.empty()) return found;
    const HeadLine& line = lines[std::min(found.first_row, lines.size() - 1)];
    if (const HeadLine* other = names_of_other_count(lines, found.first_row, layout))
      return at_line(
          name, other->number,
          "the line has " + std::to_string(other->cells.size()) + " names, the rows have " +
              std::to_string(layout.cells) +
              " cells; name all columns with --names NAME,NAME,..., or write the file with a "
              "separator that stands in no cell (a comma cannot separate decimal commas)");
    return at_line(name, line.number,
                   "the line holds values ('" + std::string(line.text.substr(0, 40)) +
                       "'), and no line above it names the columns; name them with --names "
                       "NAME,NAME,..., or say with --header N which line does");
  }
  found.header = header_in(lines, block, options.wanted);
  for (const std::size_t i : block)
    if (i > *found.header && are_units(lines[i])) found.units = i;
  return found;
}

/// Takes the line of units that was given in place of the one that was found.
std::optional<Error> take_units(const HeadLines& lines, std::optional<std::uint64_t> wanted,
                                const std::string& name, Found& found) {
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
                   "the text is HTML, XML or JSON and no table of cells; write it as CSV first");
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
  layout.separator = separator ? *separator : find_separator(lines, layout.comment);
  split(lines, layout.separator);
  if (layout.separator == ' ') layout.places = find_places(lines, layout.comment);
  layout.cells = usual_cells(lines, layout.comment);
  if (auto error = refuse_one_cell(lines, layout, options, name)) return *std::move(error);
  if (!options.names.empty() && layout.cells == 0) layout.cells = options.names.size();
  join_cells(lines, layout);
  auto found = find_header(lines, dialect, options, name);
  if (const auto* error = std::get_if<Error>(&found)) return *error;
  if (auto error = take_units(lines, options.units_line, name, std::get<Found>(found)))
    return *std::move(error);
  const auto& [first_row, header, units] = std::get<Found>(found);
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
      ++dialect.lines_above;
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
      {',', "commas"}, {';', "semicolons"}, {'\t', "tabs"}, {'|', "bars"}, {' ', "blanks"}};
  const auto word = words.find(dialect.layout.separator);
  std::string text = word == words.end()
                         ? "separated by '" + std::string(1, dialect.layout.separator) + "'"
                         : word->second;
  if (!dialect.layout.places.empty()) text += " between columns of fixed width";
  text += dialect.header_line == 0 ? ", no header"
                                   : ", header in line " + std::to_string(dialect.header_line);
  if (dialect.units_line != 0) text += ", units in line " + std::to_string(dialect.units_line);
  if (dialect.layout.line_end == '\r') text += ", lines end in CR";
  if (!dialect.layout.comment.empty()) text += ", comments begin with " + dialect.layout.comment;
  return text;
}

}  // namespace reident::telemetry_file
