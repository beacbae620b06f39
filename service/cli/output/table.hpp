// Text in columns for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace reident::cli {

/// Columns that the terminal on standard output has; 0 (no bound) where there is none.
std::size_t terminal_width();

/// Columns that a text takes on a terminal: the code points of its UTF-8.
std::size_t display_width(std::string_view text);

/// Lines of at most `width` columns, broken at blanks; a longer word has a line of its own. One
/// line where `width` is 0.
std::vector<std::string> wrapped(std::string_view text, std::size_t width);

class Table {
 public:
  enum class Align { left, right };
  struct Column {
    std::string title;
    Align align = Align::left;
  };

  explicit Table(std::vector<Column> columns);

  /// As many cells as columns.
  void add(std::vector<std::string> cells);
  bool empty() const { return rows_.empty(); }

  /// The title row and the rows, a line each. Where `width` is not 0 and the last column would
  /// reach over it, that column's text is wrapped at its blanks; where hardly any room is left for
  /// it, it stands below the others.
  std::string text(std::size_t width) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace reident::cli
