#include "service/cli/output/table.hpp"

#include <algorithm>
#include <cassert>
#include <string_view>

namespace reident::cli {
namespace {

constexpr std::string_view separator = "  ";
// Below this there is hardly any room for the last column.
constexpr std::size_t least_wrapped = 24;
constexpr std::size_t below_indent = 4;

std::string padded(const std::string& text, std::size_t width, Table::Align align) {
  const std::string blanks(width - std::min(width, display_width(text)), ' ');
  return align == Table::Align::left ? text + blanks : blanks + text;
}

}  // namespace

Table::Table(std::vector<Column> columns) : columns_(std::move(columns)) {
  assert(!columns_.empty());
}

void Table::add(std::vector<std::string> cells, Look look) {
  assert(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
  looks_.push_back(look);
}

std::string Table::text(std::size_t width) const {
  std::vector<std::string> titles;
  std::vector<std::size_t> widths;
  for (const Column& column : columns_) {
    titles.push_back(column.title);
    widths.push_back(display_width(column.title));
  }
  for (const auto& row : rows_)
    for (std::size_t c = 0; c < row.size(); ++c)
      widths[c] = std::max(widths[c], display_width(row[c]));

  std::size_t indent = 0;
  for (std::size_t c = 0; c + 1 < widths.size(); ++c) indent += widths[c] + separator.size();
  const bool bounded = width != 0 && indent + widths.back() > width;
  const bool below = bounded && indent + least_wrapped > width;
  if (below) indent = below_indent;
  const std::size_t room =
      bounded ? std::max(width, indent + least_wrapped) - indent : widths.back();

  std::string text;
  const auto append = [&](const std::vector<std::string>& row, Look look) {
    std::string line;
    const auto end_line = [&] {
      line.erase(line.find_last_not_of(' ') + 1);
      text.append(look == Look::urgent ? "\033[31m" + line + "\033[0m" : line).append("\n");
      line.assign(indent, ' ');
    };
    for (std::size_t c = 0; c + 1 < row.size(); ++c)
      line.append(padded(row[c], widths[c], columns_[c].align)).append(separator);
    if (below) end_line();
    if (below && (row.back().empty() || &row == &titles)) return;
    for (const std::string& part : wrapped(row.back(), room)) {
      line += columns_.back().align == Align::left ? part : padded(part, room, Align::right);
      end_line();
    }
  };
  append(titles, Look::plain);
  for (std::size_t r = 0; r < rows_.size(); ++r) append(rows_[r], looks_[r]);
  return text;
}

}  // namespace reident::cli
