#include "service/telemetry_file/row_reader.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "service/support/text.hpp"
#include "service/telemetry_file/date_text.hpp"
#include "service/telemetry_file/number_text.hpp"

namespace reident::telemetry_file {
namespace {

constexpr std::size_t max_row_bytes = std::size_t{16} << 20;
constexpr std::size_t most_comments = 100;   // between two rows that are looked at
constexpr std::size_t comment_bytes = 1024;  // of each
constexpr std::string_view open_quote =
    "a quoted cell that starts in this row is not closed; add the \"";

bool blank(char c) {
  return c == ' ' || c == '\t';
}

/// Whether a cell may end at the byte.
bool separates(char c, char separator) {
  return is_of_blanks(separator) ? blank(c) : c == separator;
}

std::size_t plain_end(std::span<const char> line, std::size_t at, char separator) {
  if (!is_of_blanks(separator)) {
    const void* found = std::memchr(line.data() + at, separator, line.size() - at);
    return found ? static_cast<std::size_t>(static_cast<const char*>(found) - line.data())
                 : line.size();
  }
  const auto ends = [&] {
    return blank(line[at]) &&
           (separator == ' ' || line[at] == '\t' || at + 1 == line.size() || blank(line[at + 1]));
  };
  while (at < line.size() && !ends()) ++at;
  return at;
}

/// Whether a line goes on with \" in place of a doubled quote.
bool is_escaped_quote(std::span<const char> rest, char separator) {
  return rest.size() > 2 && rest[1] == '"' && rest[2] != '"' && !separates(rest[2], separator);
}

/// Whether a cell is words, as "(240 rows)", and no time or number.
bool is_wording(std::string_view cell) {
  return !plain_number(cell) && !read_date_text(cell, DateOrder::day_first) &&
         std::any_of(cell.begin(), cell.end(),
                     [](char c) { return (c | 0x20) >= 'a' && (c | 0x20) <= 'z'; });
}

/// Whether a line says how many rows there are, as "(30 rows affected)".
bool counts_rows(std::string_view line) {
  line = trimmed(line);
  if (line.starts_with('(')) line.remove_prefix(1);
  const std::size_t digits = std::min(line.find_first_not_of("0123456789"), line.size());
  return digits > 0 && line.substr(digits).starts_with(" row");
}

}  // namespace

bool place_cells(std::string_view line, const std::vector<Place>& places,
                 std::vector<std::string_view>& cells) {
  std::vector<std::string_view> placed(places.size(), line.substr(0, 0));
  for (const std::string_view cell : cells) {
    if (cell.empty()) continue;
    const auto begin = static_cast<std::size_t>(cell.data() - line.data());
    const auto stands_in = [&](const Place& place) {
      return begin < place.end && begin + cell.size() > place.begin;
    };
    const auto place = std::find_if(places.begin(), places.end(), stands_in);
    if (place == places.end() || std::find_if(place + 1, places.end(), stands_in) != places.end())
      return false;
    std::string_view& at = placed[static_cast<std::size_t>(place - places.begin())];
    if (!at.empty()) return false;
    at = cell;
  }
  cells = std::move(placed);
  return true;
}

void join_date(std::vector<std::string_view>& cells) {
  const char* const first = cells[0].data();
  cells[0] = {first, static_cast<std::size_t>(cells[1].data() + cells[1].size() - first)};
  cells.erase(cells.begin() + 1);
}

std::string_view name(Damage damage) {
  constexpr std::array<std::string_view, 6> names = {"another number of cells",
                                                     "a quote that is not closed",
                                                     "NUL bytes",
                                                     "no time",
                                                     "no number",
                                                     "none"};
  return names[static_cast<std::size_t>(damage)];
}

bool is_ruled(std::string_view text) {
  if (text.empty() || std::string_view("-+|=:").find(text.front()) == std::string_view::npos)
    return false;
  return text.find_first_not_of("-+|=: \t") == std::string_view::npos &&
         (text.find("--") != std::string_view::npos || text.find("==") != std::string_view::npos);
}

std::string comment_advice(std::string_view line) {
  for (const std::string_view mark : comment_marks)
    if (line.starts_with(mark))
      return "; where such lines are comments, say --comment '" + std::string(mark) + "'";
  return {};
}

std::optional<std::string_view> split_cells(std::span<char> line, char separator,
                                            std::vector<std::string_view>& cells) {
  cells.clear();
  std::size_t at = 0;
  const auto pass_blanks = [&] {
    while (is_of_blanks(separator) && at < line.size() && blank(line[at])) ++at;
  };
  pass_blanks();
  while (true) {
    std::size_t quote = at;  // behind blanks too
    while (quote < line.size() && blank(line[quote]) && line[quote] != separator) ++quote;
    if (quote < line.size() && line[quote] == '"') {
      at = quote;
      const std::size_t first = ++at;
      std::size_t last = first;
      while (true) {
        if (at >= line.size()) return open_quote;
        if (line[at] == '\\' && is_escaped_quote(line.subspan(at), separator))
          ++at;
        else if (line[at] == '"' && (++at >= line.size() || line[at] != '"'))
          break;
        line[last++] = line[at++];
      }
      cells.emplace_back(line.data() + first, last - first);
      if (at < line.size() && !separates(line[at], separator))
        return "text follows the closing quote of a cell; double the quotes inside cells";
    } else {
      const std::size_t end = plain_end(line, at, separator);
      cells.emplace_back(line.data() + at, end - at);
      at = end;
    }
    pass_blanks();
    if (at == line.size()) return std::nullopt;
    if (!is_of_blanks(separator)) ++at;
  }
}

RowReader::Step RowReader::fail(std::uint64_t at_line, std::string_view what, Damage damage) {
  error_.message = source_.name() + ":" + std::to_string(at_line) + ": " + std::string(what);
  damage_ = damage;
  return Step::error;
}

bool RowReader::has_nul_bytes() const {
  return std::memchr(buffer_.data() + row_begin_, '\0', row_end_ - row_begin_) != nullptr;
}

Error RowReader::error_here(std::string_view what) const {
  std::string text = source_.name() + ":" + std::to_string(line_) + ": ";
  if (has_nul_bytes())
    text +=
        "the row holds NUL bytes, as a disk or link that failed leaves them; leave it out with "
        "--skip-bad-lines, or mend it";
  else
    text += what;
  return {std::move(text)};
}

/// Makes more of the text available behind the end; Step::end when there is no more.
RowReader::Step RowReader::fill() {
  if (buffer_.size() - begin_ >= max_row_bytes)
    return fail(next_line_, "the row is longer than 16 MiB; is a quoted cell not closed?",
                Damage::none);
  if (begin_ > 0) {
    buffer_.erase(0, begin_);
    begin_ = 0;
  }
  const std::size_t before = buffer_.size();
  if (auto error = source_.read(buffer_)) {
    error_ = *std::move(error);
    damage_ = Damage::none;
    return Step::error;
  }
  return buffer_.size() == before ? Step::end : Step::row;
}

std::variant<RowReader::Head, Error> RowReader::head(std::size_t most) {
  Step step = Step::row;
  while (buffer_.size() - begin_ < most && step == Step::row) step = fill();
  if (step == Step::error) return error_;
  const std::string_view text = std::string_view(buffer_).substr(begin_);
  return Head{text.substr(0, most), step == Step::end && text.size() <= most};
}

std::optional<Error> RowReader::start(Layout layout, std::uint64_t position, std::uint64_t line) {
  layout_ = std::move(layout);
  if (position >= consumed_ && position - consumed_ <= buffer_.size() - begin_) {
    begin_ += position - consumed_;
  } else {
    buffer_.clear();
    begin_ = 0;
    if (auto error = source_.seek(position)) return error;
  }
  row_begin_ = row_end_ = begin_;
  consumed_ = position;
  next_line_ = line;
  return std::nullopt;
}

/// The end of the row at begin_ when all of it is in the buffer and no quote is in it.
bool RowReader::find_plain_row_end(std::size_t& row_end) const {
  const char* const first = buffer_.data() + begin_;
  const void* const line_end = std::memchr(first, layout_.line_end, buffer_.size() - begin_);
  if (line_end == nullptr) return false;
  const auto length = static_cast<std::size_t>(static_cast<const char*>(line_end) - first);
  row_end = begin_ + length;
  return std::memchr(first, '"', length) == nullptr;
}

/// Finds the line end that ends the row at begin_, quoted line ends left aside; the end of the text
/// stands for a missing last one.
RowReader::Step RowReader::find_row_end(std::size_t& row_end, bool& is_cut) {
  is_cut = false;
  if (find_plain_row_end(row_end)) return Step::row;
  enum class At { cell_start, plain, quoted, closed } state = At::cell_start;
  std::size_t scanned = 0;  // from begin_, which fill() moves
  while (true) {
    for (; begin_ + scanned < buffer_.size(); ++scanned) {
      const char c = buffer_[begin_ + scanned];
      if (state == At::quoted) {
        if (c == '"') state = At::closed;
      } else if (c == layout_.line_end) {
        row_end = begin_ + scanned;
        return Step::row;
      } else if (separates(c, layout_.separator)) {
        state = At::cell_start;
      } else if (c == '"' && state != At::plain) {
        state = At::quoted;  // opened, or the second of a doubled quote: the cell goes on
      } else if (state == At::cell_start && blank(c)) {
        continue;
      } else {
        state = At::plain;
      }
    }
    const Step filled = fill();
    if (filled == Step::row) continue;
    if (filled == Step::error && damage_ == Damage::none && buffer_.size() - begin_ < max_row_bytes)
      return filled;  // the file cannot be read
    if (filled == Step::end) is_cut = true;
    row_end = buffer_.size();
    // A quote that is open at the end: the line alone is bad, and what follows it is read again.
    if (state != At::quoted) return filled;
    const std::size_t line_end = buffer_.find(layout_.line_end, begin_);
    if (line_end != std::string::npos) {
      row_end = line_end;
      is_cut = false;
    } else if (filled == Step::error) {
      return filled;
    }
    return Step::row;
  }
}

/// Whether a line is blank, ruled, a comment or the header again.
bool RowReader::is_passed_over(std::string_view text) {
  if (text.empty() || is_ruled(trimmed(text))) return true;
  if (!layout_.comment.empty() && text.starts_with(layout_.comment)) {
    if (comments_.size() < most_comments)
      comments_.push_back({next_line_, std::string(text.substr(0, comment_bytes))});
    return true;
  }
  if (layout_.header.empty() || text != layout_.header) return false;
  if (repeated_headers_++ == 0) first_repeated_header_ = next_line_;
  return true;
}

RowReader::Step RowReader::next() {
  damage_ = Damage::none;
  comments_.clear();
  while (true) {
    bool is_cut = false;
    std::size_t row_end = 0;
    const Step found = find_row_end(row_end, is_cut);
    if (found == Step::error) return found;
    if (begin_ == buffer_.size()) {
      row_begin_ = row_end_ = begin_;
      return Step::end;
    }
    if (constexpr std::string_view mark = "\xEF\xBB\xBF";  // of a file that was joined
        buffer_.compare(begin_, mark.size(), mark) == 0) {
      begin_ += mark.size();
      consumed_ += mark.size();
    }
    const std::size_t following = std::min(row_end + 1, buffer_.size());
    while (row_end > begin_ && buffer_[row_end - 1] == '\r') --row_end;
    const std::string_view text(buffer_.data() + begin_, row_end - begin_);
    if (!is_passed_over(text)) return take_row(row_end, following, is_cut);
    next_line_ += static_cast<std::uint64_t>(
        std::count(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
                   buffer_.begin() + static_cast<std::ptrdiff_t>(following), layout_.line_end));
    consumed_ += following - begin_;
    begin_ = following;
  }
}

/// Cuts buffer_[begin_, row_end) into cells and goes on at `following`.
RowReader::Step RowReader::take_row(std::size_t row_end, std::size_t following, bool is_cut) {
  row_begin_ = begin_;
  row_end_ = row_end;
  line_ = next_line_;
  is_unended_ = is_cut;
  const std::string_view text(buffer_.data() + begin_, row_end - begin_);
  const auto line_ends = [&](std::size_t end) {
    return static_cast<std::uint64_t>(
        std::count(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
                   buffer_.begin() + static_cast<std::ptrdiff_t>(end), layout_.line_end));
  };
  const bool is_quoted = text.find('"') != std::string_view::npos;
  const std::size_t first_end = is_quoted ? text.find(layout_.line_end) : std::string_view::npos;
  const bool spans_lines = first_end != std::string_view::npos;
  if (spans_lines)
    lines_ = text;  // cutting it into cells changes the text, which may be read again
  char* const from = spans_lines ? lines_.data() : buffer_.data() + begin_;
  const auto wrong = split_cells({from, row_end - begin_}, layout_.separator, cells_);
  if (!wrong && !is_cut && cells_.size() < layout_.places.size())
    place_cells({from, row_end - begin_}, layout_.places, cells_);
  if (layout_.joins_date && cells_.size() > 1) join_date(cells_);
  while (layout_.cells != 0 && cells_.size() > layout_.cells && trimmed(cells_.back()).empty())
    cells_.pop_back();
  const bool fits = !wrong && (layout_.cells == 0 || cells_.size() == layout_.cells);
  if (!fits && spans_lines) {
    // A stray quote joined lines: the first of them alone is bad.
    row_end_ = begin_ + first_end;
    following = row_end_ + 1;
    is_cut = false;
  }
  const bool is_cut_short =
      is_cut && layout_.cells != 0 && (wrong == open_quote || cells_.size() < layout_.cells);
  next_line_ += is_quoted ? line_ends(following) : following > row_end ? 1 : 0;
  consumed_ += following - begin_;
  begin_ = following;
  if (fits) return Step::row;
  if (is_cut && text.find_first_not_of('\0') == std::string_view::npos) {  // padding of a file
    cut_line_ = line_;
    return Step::end;
  }
  if (has_nul_bytes()) {
    error_ = error_here({});
    damage_ = Damage::nul_bytes;
    return Step::error;
  }
  const std::string advice = comment_advice(text);
  const bool is_of_words = counts_rows(text) || (cells_.size() == 1 && is_wording(cells_.front()));
  const bool is_footer = !wrong && layout_.cells > 1 && is_of_words && is_at_end();
  if (is_cut_short || is_footer) {
    cut_line_ = line_;
    return Step::end;
  }
  if (wrong) return fail(line_, *wrong, Damage::open_quote);
  return fail(line_,
              "the row has " + std::to_string(cells_.size()) + " cells, the header has " +
                  std::to_string(layout_.cells) +
                  "; mend the row (a cell with the separator in it needs quotes), or leave such "
                  "rows out with --skip-bad-lines" +
                  advice,
              Damage::cell_count);
}

/// Whether nothing but blank lines follows. The row's bytes are gone where they do not.
bool RowReader::is_at_end() {
  while (buffer_.find_first_not_of("\r\n \t", begin_) == std::string::npos) {
    const Step filled = fill();
    row_begin_ = row_end_ = begin_;
    if (filled != Step::row) return filled == Step::end;
  }
  return false;
}

}  // namespace reident::telemetry_file
