#include "service/telemetry_file/header_finder.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "service/support/text.hpp"
#include "service/telemetry_file/cell_format.hpp"
#include "service/telemetry_file/clock_names.hpp"
#include "service/telemetry_file/number_text.hpp"

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

/// Whether a line has cells and nothing in them: a row without values.
bool is_without_values(const HeadLine& line) {
  return std::ranges::all_of(line.cells, [](const std::string& cell) {
    const std::string_view word = trimmed(cell);
    const auto number = plain_number(word);
    return word.empty() || (number && std::isnan(*number)) || means_no_value(word);
  });
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
    if (!has_cells(i) || (!is_first && is_without_values(lines_[i]))) return false;
    if (std::find(values_.begin(), values_.end(), true) == values_.end()) return is_first;
    if (!is_row(lines_[i], values_)) return true;
    return is_first && names_parameters(lines_[i], values_);
  }
  /// Whether a line is none of metadata, as "Samples 20 20" above rows that begin with a number.
  bool has_first_value(std::size_t i) const {
    const auto first = std::find(values_.begin(), values_.end(), true);
    const auto column = static_cast<std::size_t>(first - values_.begin());
    return first == values_.end() || trimmed(lines_[i].cells[column]).empty() ||
           looks_like_value(lines_[i].cells[column]);
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
      } else if (has_first_value(i)) {
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
  /// The first line with a value where all rows have one: the first row where names are given.
  std::size_t first_of_values() const {
    const auto first = std::find(values_.begin(), values_.end(), true);
    const auto column = static_cast<std::size_t>(first - values_.begin());
    for (std::size_t i = 0; i < lines_.size() && first != values_.end(); ++i) {
      const HeadLine& line = lines_[i];
      if (is_blank(line) || is_comment(line, comment_) || line.cells.size() <= column) continue;
      if (looks_like_value(line.cells[column])) return i;
    }
    return first_row();
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
  std::size_t empty = 0, empty_at_end = 0;
  for (const std::string& cell : line.cells) {
    if (trimmed(cell).empty()) {
      ++empty_at_end;
      continue;
    }
    empty += std::exchange(empty_at_end, 0);
    if (!seen.insert(trimmed(cell)).second) return false;
  }
  return empty <= 1;
}

/// Whether a line is a title in the first of several cells.
bool is_title(const HeadLine& line) {
  return line.cells.size() > 2 &&
         std::count_if(line.cells.begin(), line.cells.end(),
                       [](const std::string& cell) { return !trimmed(cell).empty(); }) == 1;
}

/// Whether a line says a zone, as "Zeitzone;MEZ", and names no columns.
bool says_zone(const HeadLine& line) {
  const auto filled = std::count_if(line.cells.begin(), line.cells.end(),
                                    [](const auto& cell) { return !trimmed(cell).empty(); });
  const auto hint = zone_hint_of_line(line.text);
  if (!hint || line.cells.empty()) return false;
  return filled == 1 ? !hint->is_local : filled == 2 && is_zone_key(line.cells.front());
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
  const auto is_no_header = [&](std::size_t i) {
    return is_title(lines[i]) || says_zone(lines[i]);
  };
  if (!std::all_of(names.begin(), names.end(), is_no_header)) std::erase_if(names, is_no_header);
  // A line such as "Avg", "Avg" below the names describes them.
  if (std::any_of(names.begin(), names.end(), [&](std::size_t i) { return are_names(lines[i]); }))
    std::erase_if(names, [&](std::size_t i) { return !are_names(lines[i]); });
  const std::size_t last = names.back();
  if (names.size() == 1) return last;
  const HeadLine& above = lines[names[names.size() - 2]];
  const bool is_pair = names.size() == 2 && are_names(above) &&
                       above.text.find_first_of(":=") == std::string_view::npos &&
                       std::none_of(above.cells.begin(), above.cells.end(), looks_like_value);
  const auto is_blank_cell = [](const std::string& cell) { return trimmed(cell).empty(); };
  const bool describes =
      !are_identifiers(above) && are_identifiers(lines[last]) && are_names(lines[last]) &&
      std::none_of(lines[last].cells.begin(), lines[last].cells.end(), is_blank_cell);
  return is_pair && !describes ? names.front() : last;
}

/// Cuts a comment into names; false where it holds none, or another number of them.
bool holds_names(HeadLine& line, char separator, const std::string& comment, std::size_t usual) {
  if (!is_comment(line, comment)) return false;
  std::string text(trimmed(line.text.substr(comment.size())));
  std::vector<std::string_view> cells;
  if (split_cells(text, separator, cells) || cells.size() != usual) return false;
  line.cells.assign(cells.begin(), cells.end());
  return are_names(line);
}

/// The names in a comment right above the rows, as "# time, i_load", or in the one above a comment
/// with their units.
HeaderPlace header_in_comment(HeadLines& lines, std::size_t first_row, char separator,
                              const std::string& comment, std::size_t usual) {
  HeaderPlace found{first_row, {}, {}};
  for (std::size_t i = first_row; i-- > 0;) {
    if (is_blank(lines[i])) continue;
    if (!holds_names(lines[i], separator, comment, usual)) break;
    if (found.header) found.units = found.header;
    found.header = i;
    if (found.units || !are_units(lines[i])) break;
  }
  return found;
}

/// The first line that is taken for a row, or the one above it, where it holds names, more or less
/// than there are cells.
const HeadLine* names_of_other_count(const HeadLines& lines, std::size_t first_row,
                                     const Layout& layout) {
  for (std::size_t i = std::min(first_row + 1, lines.size()); i-- > 0;) {
    if (is_blank(lines[i]) || is_comment(lines[i], layout.comment)) continue;
    const auto& cells = lines[i].cells;
    const bool is_text = cells.size() > 1 && cells.size() != layout.cells &&
                         std::none_of(cells.begin(), cells.end(), looks_like_value);
    if (is_text) return &lines[i];
    if (i != first_row) break;
  }
  return nullptr;
}

/// The line above the rows with names behind those of their cells, as of a comment that no row has.
std::optional<HeaderPlace> header_with_more(HeadLines& lines, std::size_t first_row,
                                            const Layout& layout) {
  const HeadLine* other = names_of_other_count(lines, first_row, layout);
  if (!other || other->cells.size() <= layout.cells || is_of_blanks(layout.separator) ||
      !are_names(*other))
    return std::nullopt;
  const auto header = static_cast<std::size_t>(other - lines.data());
  return HeaderPlace{header + 1, header, {}};
}

/// Whether a line is made of pairs, as "u=1.5 v=28.0".
bool holds_pairs(const HeadLine& line) {
  return std::count(line.text.begin(), line.text.end(), '=') > 1;
}

Error no_table_of_pairs(const HeadLine& line, const std::string& name) {
  return at_line(name, line.number,
                 "the line holds pairs of names and values ('" +
                     std::string(line.text.substr(0, 40)) +
                     "') and no row of a table; write the file as CSV first, with the names in its "
                     "first line");
}

/// What is wrong where no line above the rows names their columns.
Error no_names(const HeadLines& lines, std::size_t first_row, const Layout& layout,
               const std::string& name) {
  if (const HeadLine* other = names_of_other_count(lines, first_row, layout))
    return at_line(name, other->number,
                   "the line has " + std::to_string(other->cells.size()) +
                       " names, the rows have " + std::to_string(layout.cells) +
                       " cells; name all columns with --names NAME,NAME,..., or write the file "
                       "with a separator that stands in no cell (a comma cannot separate decimal "
                       "commas)");
  const HeadLine& line = lines[std::min(first_row, lines.size() - 1)];
  if (holds_pairs(line)) return no_table_of_pairs(line, name);
  return at_line(name, line.number,
                 "the line holds values ('" + std::string(line.text.substr(0, 40)) +
                     "'), and no line above it names the columns; name them with --names "
                     "NAME,NAME,..., or say with --header N which line does");
}

}  // namespace

std::variant<HeaderPlace, Error> find_header(HeadLines& lines, const Layout& layout,
                                             const DialectOptions& options,
                                             const std::string& name) {
  const Head head(lines, layout.comment, layout.cells);
  HeaderPlace found;
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
  found.first_row = options.names.empty() ? head.first_row() : head.first_of_values();
  const auto block = head.block_above(found.first_row);
  if (block.empty()) {
    found =
        header_in_comment(lines, found.first_row, layout.separator, layout.comment, layout.cells);
    if (found.header || !options.names.empty()) return found;
    if (const auto more = header_with_more(lines, found.first_row, layout)) return *more;
    return no_names(lines, found.first_row, layout, name);
  }
  found.header = header_in(lines, block, options.wanted);
  if (is_title(lines[*found.header]) && options.names.empty()) {
    if (const auto more = header_with_more(lines, found.first_row, layout)) return *more;
    return no_names(lines, found.first_row, layout, name);
  }
  const HeadLine& header = lines[*found.header];
  if (holds_pairs(header) && found.first_row < lines.size() && holds_pairs(lines[found.first_row]))
    return no_table_of_pairs(header, name);
  for (const std::size_t i : block)
    if (i > *found.header && are_units(lines[i])) found.units = i;
  return found;
}

}  // namespace reident::telemetry_file
