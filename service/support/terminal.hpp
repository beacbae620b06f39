// Text on a terminal: how wide that is, lines that fit into it, colours, errors.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace reident {

/// Columns that the terminal behind a descriptor has; 0 (no bound) where there is none.
std::size_t terminal_width(int descriptor = STDOUT_FILENO);

/// Whether text on standard output may be coloured: that is a terminal which knows colours, and
/// NO_COLOR (https://no-color.org) is not set.
bool shows_colours();

/// Columns that a text takes on a terminal: the code points of its UTF-8.
std::size_t display_width(std::string_view text);

/// Lines of at most `width` columns, broken at blanks; a longer word has a line of its own. One
/// line where `width` is 0.
std::vector<std::string> wrapped(std::string_view text, std::size_t width);

/// One line broken at blanks, and within a word that is too long alone, so that no line has more
/// than `width` columns; at least 20. Lines after the first are indented as the text in the line's
/// second column is, or by two blanks more than the line. Escape sequences take no room.
std::string folded(std::string_view line, std::size_t width);

/// Writes the text and a line end to standard error, folded to its terminal. What cannot be written
/// is nobody's fault: it never throws.
void print_error(std::string_view text);
template <typename First, typename... Rest>
void print_error(fmt::format_string<First, Rest...> format, First&& first, Rest&&... rest) {
  print_error(std::string_view(
      fmt::format(format, std::forward<First>(first), std::forward<Rest>(rest)...)));
}

/// While it lives, what is printed on `stdout` is folded to the terminal behind it, line by line.
/// Does nothing where there is no terminal.
class FoldedOutput {
 public:
  /// `with_pager`: what does not fit on the screen is shown by the program that PAGER names, or by
  /// less where that is not set; where it is empty, or there is none, as it is. Its end waits for
  /// the pager.
  explicit FoldedOutput(bool with_pager);
  ~FoldedOutput();
  FoldedOutput(const FoldedOutput&) = delete;
  FoldedOutput& operator=(const FoldedOutput&) = delete;

 private:
  std::FILE* before_ = nullptr;  // stdout, where it was replaced
};

}  // namespace reident
