#include "service/telemetry_file/row_shape.hpp"

#include <algorithm>
#include <functional>
#include <optional>

#include "service/support/text.hpp"
#include "service/telemetry_file/date_text.hpp"
#include "service/telemetry_file/number_text.hpp"

namespace reident::telemetry_file {
namespace {

/// Whether the header has a cell less than the rows, which `fits` says of a row's cells.
bool rows_have_one_more(const HeadLines& lines, std::size_t usual, const std::string& comment,
                        const std::function<bool(const std::vector<std::string>&)>& fits) {
  std::size_t rows = 0, fitting = 0;
  bool has_header = false;
  for (const HeadLine& line : lines) {
    if (is_blank(line) || is_comment(line, comment)) continue;
    if (line.cells.size() + 1 == usual && fitting == 0 &&
        std::none_of(line.cells.begin(), line.cells.end(), looks_like_value))
      has_header = true;
    if (line.cells.size() != usual) continue;
    ++rows;
    fitting += fits(line.cells) ? 1U : 0U;
  }
  return has_header && rows > 0 && fitting == rows;
}

/// Blank cells at the end of every row, two or more, that the header has not.
void drop_blank_ends(HeadLines& lines, Layout& layout) {
  std::size_t blanks = layout.cells, names = 0;
  for (const HeadLine& line : lines) {
    if (is_blank(line) || is_comment(line, layout.comment)) continue;
    const auto& cells = line.cells;
    if (cells.size() == layout.cells) {
      const auto last = std::find_if(cells.rbegin(), cells.rend(), [](const std::string& cell) {
        return !trimmed(cell).empty();
      });
      blanks = std::min(blanks, static_cast<std::size_t>(last - cells.rbegin()));
    } else if (names == 0 && cells.size() < layout.cells &&
               std::none_of(cells.begin(), cells.end(), looks_like_value)) {
      names = cells.size();
    }
  }
  if (names < 2 || layout.cells - names < 2 || layout.cells - names > blanks) return;
  for (HeadLine& line : lines)
    if (line.cells.size() == layout.cells) line.cells.resize(names);
  layout.cells = names;
}

}  // namespace

void join_cells(HeadLines& lines, Layout& layout) {
  if (layout.cells < 2) return;
  drop_blank_ends(lines, layout);
  const bool is_of_dates = layout.separator == ' ' || layout.separator == ',';
  if (is_of_dates && rows_have_one_more(lines, layout.cells, layout.comment, [](const auto& cells) {
        const auto date = read_date_text(cells[0], DateOrder::day_first);
        return date && date->has_date && cells[1].find(':') != std::string::npos;
      })) {
    layout.joins_date = true;
    for (HeadLine& line : lines)
      if (line.cells.size() == layout.cells) {
        line.cells[0] += (layout.separator == ',' ? "," : " ") + line.cells[1];
        line.cells.erase(line.cells.begin() + 1);
      }
    --layout.cells;
  }
  if (rows_have_one_more(lines, layout.cells, layout.comment,
                         [](const auto& cells) { return trimmed(cells.back()).empty(); })) {
    --layout.cells;
    return;
  }
  // Rows are numbered, and no name stands above the numbers.
  std::optional<double> before;
  if (rows_have_one_more(lines, layout.cells, layout.comment, [&](const auto& cells) {
        const auto number = plain_number(cells.front());
        const bool follows = number && (!before || *number == *before + 1);
        before = number;
        return follows;
      }))
    for (HeadLine& line : lines)
      if (line.cells.size() + 1 == layout.cells) line.cells.insert(line.cells.begin(), "");
}

}  // namespace reident::telemetry_file
