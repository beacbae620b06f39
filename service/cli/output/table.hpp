// Text in columns for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "service/support/terminal.hpp"

namespace reident::cli {

class Table {
 public:
  enum class Align { left, right };
  struct Column {
    std::string title;
    Align align = Align::left;
  };

  explicit Table(std::vector<Column> columns);

  enum class Look { plain, urgent };  // urgent: in red

  /// As many cells as columns.
  void add(std::vector<std::string> cells, Look look = Look::plain);
  bool empty() const { return rows_.empty(); }

  /// The title row and the rows, a line each. Where `width` is not 0 and the last column would
  /// reach over it, that column's text is wrapped at its blanks; where hardly any room is left for
  /// it, it stands below the others, without its title.
  std::string text(std::size_t width) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<Look> looks_;  // of the rows
};

}  // namespace reident::cli
