#include "service/cli/output/table.hpp"

#include <algorithm>
#include <cassert>
#include <unistd.h>

#include <sys/ioctl.h>

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

std::size_t terminal_width() {
  winsize size{};
  const bool known = isatty(STDOUT_FILENO) == 1 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0;
  return known ? size.ws_col : 0;
}

std::size_t display_width(std::string_view text) {
  const auto begins_code_point = [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  };
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), begins_code_point));
}

std::vector<std::string> wrapped(std::string_view text, std::size_t width) {
  std::vector<std::string> lines(1);
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (width == 0 || display_width(line) + 1 + display_width(word) <= width) {
      line.append(" ").append(word);
    } else {
      lines.emplace_back(word);
    }
  }
  return lines;
}

Table::Table(std::vector<Column> columns) : columns_(std::move(columns)) {
  assert(!columns_.empty());
}

void Table::add(std::vector<std::string> cells) {
  assert(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
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
  const auto append = [&](const std::vector<std::string>& row) {
    std::string line;
    const auto end_line = [&] {
      line.erase(line.find_last_not_of(' ') + 1);
      text.append(line).append("\n");
      line.assign(indent, ' ');
    };
    for (std::size_t c = 0; c + 1 < row.size(); ++c)
      line.append(padded(row[c], widths[c], columns_[c].align)).append(separator);
    if (below) end_line();
    for (const std::string& part : wrapped(row.back(), room)) {
      line += columns_.back().align == Align::left ? part : padded(part, room, Align::right);
      end_line();
    }
  };
  append(titles);
  for (const auto& row : rows_) append(row);
  return text;
}

}  // namespace reident::cli
