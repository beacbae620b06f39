// The rows of a text of separated values, as a stream.
//
// A cell in double quotes may hold separators, line ends and doubled quotes (RFC 4180). Empty
// lines, comments and repetitions of the header are skipped; a last line that was cut is left out.
//
// Every error is a value that names the file and the line. Nothing here throws but std::bad_alloc.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "service/telemetry_file/text_source.hpp"

namespace reident::telemetry_file {

/// Bytes [begin, end) of a line in which the cells of a column stand.
struct Place {
  std::size_t begin = 0, end = 0;
};

/// The separator of columns whose cells and names have single blanks in them: two blanks or more.
inline constexpr char two_blanks = '\f';
constexpr bool is_of_blanks(char separator) {
  return separator == ' ' || separator == two_blanks;
}

/// How a text is cut into rows and cells.
struct Layout {
  char separator = ',';     // a blank: any number of blanks and tabs; two_blanks
  char line_end = '\n';     // '\n' also ends lines with a CR before it; '\r' alone
  std::string comment;      // what lines begin with that are no rows; empty: none do
  std::string header;       // a line of this text is no row; empty: there is none
  std::size_t cells = 0;    // of each row; 0: any number
  bool joins_date = false;  // a date and a time of day, a blank between them, are the first cell
  /// Where the columns stand, where blanks separate cells and a row may have fewer: the others are
  /// blank.
  std::vector<Place> places;
};

/// Cuts a line, without its end, into cells that point into it; doubled quotes in quoted cells are
/// undoubled in place. An error text where a quoted cell is not closed or goes on behind its quote.
std::optional<std::string_view> split_cells(std::span<char> line, char separator,
                                            std::vector<std::string_view>& cells);

/// Puts cells that point into `line` to their places, blank ones between them. False where a cell
/// stands in none of them or in two, or two cells in one.
bool place_cells(std::string_view line, const std::vector<Place>& places,
                 std::vector<std::string_view>& cells);

/// Makes one cell of the first two, which follow each other in one text. Requires two cells.
void join_date(std::vector<std::string_view>& cells);

/// Whether a line is ruled, as "-----+-----" below a header. Requires a text without blanks around.
bool is_ruled(std::string_view text);

struct NumberedLine {
  std::uint64_t number = 0;
  std::string text;
};

/// What lines of comments begin with.
inline constexpr std::array<std::string_view, 4> comment_marks = {"#", "%", "//", "!"};

/// What is wrong with a row, as counts of rows that were left out name it.
enum class Damage { cell_count, open_quote, nul_bytes, time, value, none };
std::string_view name(Damage damage);

/// What a remedy has in addition where a line looks like a comment; else empty.
std::string comment_advice(std::string_view line);

/// Reads row by row; memory is bounded by the longest row, which may have 16 MiB. One thread at a
/// time.
class RowReader {
 public:
  explicit RowReader(TextSource source) : source_(std::move(source)) {}

  /// Returns the text from the place on where the reader stands, up to `most` bytes, and whether it
  /// is all there is. It is valid until the next call of anything here.
  struct Head {
    std::string_view text;
    bool is_all = false;
  };
  std::variant<Head, Error> head(std::size_t most);

  /// Reads rows of this layout from a place on: `position` bytes of text from its beginning, on
  /// line `line`. An error where the file cannot be read from there.
  std::optional<Error> start(Layout layout, std::uint64_t position, std::uint64_t line);

  enum class Step { row, end, error };
  Step next();
  /// After a row: its cells, valid until the next call of next().
  std::span<const std::string_view> cells() const { return cells_; }
  std::uint64_t line() const { return line_; }  // on which the row starts, from 1
  /// After an error: what stopped the reading, and what is wrong with the row where next() goes on
  /// behind it (else Damage::none).
  const Error& error() const { return error_; }
  Damage damage() const { return damage_; }
  /// Returns an error at the row that was just read: "FILE:LINE: what". It says so where the row
  /// holds NUL bytes.
  Error error_here(std::string_view what) const;
  bool has_nul_bytes() const;
  /// The text of the row or of the bad line, valid until the next call of next().
  std::string_view text() const {
    return std::string_view(buffer_).substr(row_begin_, row_end_ - row_begin_);
  }
  /// Whether the text ends right behind the row, without a line end.
  bool is_unended() const { return is_unended_; }
  /// The comments that next() passed over last, at most 100 of them.
  const std::vector<NumberedLine>& comments() const { return comments_; }

  std::uint64_t bytes_read() const { return consumed_; }  // of the text, up to the end of the row
  std::uint64_t next_line() const { return next_line_; }
  const TextSource& source() const { return source_; }
  std::uint64_t repeated_headers() const { return repeated_headers_; }
  std::uint64_t first_repeated_header() const { return first_repeated_header_; }  // its line
  /// The last line, where it is cut or no row; 0: it is one.
  std::uint64_t cut_line() const { return cut_line_; }

 private:
  Step fail(std::uint64_t at_line, std::string_view what, Damage damage);
  Step fill();
  Step find_row_end(std::size_t& row_end, bool& is_cut);
  bool find_plain_row_end(std::size_t& row_end) const;
  bool is_passed_over(std::string_view text);
  bool is_at_end();
  Step take_row(std::size_t row_end, std::size_t following, bool is_cut);

  TextSource source_;
  Layout layout_;
  // The unread part of the text is buffer_[begin_, end_). Cells point into the buffer, or
  // into a copy of the row.
  std::string buffer_;
  std::string lines_;  // of a row with line ends in it
  std::size_t begin_ = 0;
  std::size_t row_begin_ = 0, row_end_ = 0;  // of the last row
  std::uint64_t consumed_ = 0;
  std::vector<std::string_view> cells_;
  std::uint64_t line_ = 0, next_line_ = 1;
  std::uint64_t repeated_headers_ = 0, first_repeated_header_ = 0, cut_line_ = 0;
  std::vector<NumberedLine> comments_;
  bool is_unended_ = false;
  Error error_;
  Damage damage_ = Damage::none;
};

}  // namespace reident::telemetry_file
