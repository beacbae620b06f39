#include "service/support/csv.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::csv {
namespace {

constexpr std::size_t block_bytes = std::size_t{256} << 10;
constexpr std::size_t max_row_bytes = std::size_t{16} << 20;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

std::optional<double> to_number(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() > 1 && cell[0] == '+' && cell[1] != '-') cell.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

struct Reader::Impl {
  std::string name;
  std::unique_ptr<std::FILE, CloseFile> file;  // null: all there is stands in the buffer
  std::uint64_t size = 0;

  // The unread part of the input is buffer[begin, end). Cells point into the buffer.
  std::string buffer;
  std::size_t begin = 0;
  std::size_t end = 0;
  std::uint64_t consumed = 0;

  std::vector<std::string> columns;
  std::vector<std::string_view> cells;
  std::uint64_t line = 0;       // of the last row
  std::uint64_t next_line = 1;  // of the first unread byte
  Error error;
  bool only_row_is_bad = false;

  Step fail(std::uint64_t at_line, std::string_view what) {
    error.message = name + ":" + std::to_string(at_line) + ": " + std::string(what);
    return Step::error;
  }
  Error whole_file(std::string_view what) const { return {name + ": " + std::string(what)}; }

  Step read_row();
  bool find_plain_row_end(std::size_t& row_end) const;
  Step find_row_end(std::size_t& row_end);
  Step fill();
  Step split(std::size_t row_end);
  Step take_quoted(std::size_t& at, std::size_t row_end);
  std::optional<Error> read_header();
};

/// Makes more of the input available behind `end`; Step::end when there is no more.
Reader::Step Reader::Impl::fill() {
  if (!file) return Step::end;
  if (end - begin >= max_row_bytes) {
    return fail(next_line, "the row is longer than 16 MiB; is a quoted cell not closed?");
  }
  if (begin > 0) {
    std::memmove(buffer.data(), buffer.data() + begin, end - begin);
    end -= begin;
    begin = 0;
  }
  if (buffer.size() - end < block_bytes) buffer.resize(std::max(buffer.size() * 2, block_bytes));
  const std::size_t count = std::fread(buffer.data() + end, 1, buffer.size() - end, file.get());
  if (count == 0 && std::ferror(file.get()) != 0) {
    return fail(next_line, std::string("cannot be read: ") +
                               std::error_code(errno, std::generic_category()).message());
  }
  end += count;
  return count == 0 ? Step::end : Step::row;
}

/// The end of the row at `begin` when all of it is in the buffer and no quote is in it.
bool Reader::Impl::find_plain_row_end(std::size_t& row_end) const {
  const char* const first = buffer.data() + begin;
  const void* const line_end = std::memchr(first, '\n', end - begin);
  if (line_end == nullptr) return false;
  const auto length = static_cast<std::size_t>(static_cast<const char*>(line_end) - first);
  row_end = begin + length;
  return std::memchr(first, '"', length) == nullptr;
}

/// Finds the line end that ends the row at `begin`, quoted line ends left aside; the end of the
/// input stands for a missing last one.
Reader::Step Reader::Impl::find_row_end(std::size_t& row_end) {
  if (find_plain_row_end(row_end)) return Step::row;
  enum class At { cell_start, plain, quoted, closed } state = At::cell_start;
  std::size_t scanned = 0;  // from begin, which fill() moves
  while (true) {
    for (; begin + scanned < end; ++scanned) {
      const char c = buffer[begin + scanned];
      if (state == At::quoted) {
        if (c == '"') state = At::closed;
      } else if (c == '\n') {
        row_end = begin + scanned;
        return Step::row;
      } else if (c == ',') {
        state = At::cell_start;
      } else if (c == '"' && state != At::plain) {
        state = At::quoted;  // opened, or the second of a doubled quote: the cell goes on
      } else {
        state = At::plain;
      }
    }
    const Step filled = fill();
    if (filled == Step::row) continue;
    if (filled == Step::end && state == At::quoted) {
      return fail(next_line, "a quoted cell that starts in this row is not closed; add the \"");
    }
    row_end = end;
    return filled;
  }
}

/// Reads the quoted cell whose opening quote stands at `at`, undoubles its quotes in place and
/// leaves `at` behind its closing quote.
Reader::Step Reader::Impl::take_quoted(std::size_t& at, std::size_t row_end) {
  const std::size_t first = ++at;
  std::size_t last = first;
  while (true) {
    if (buffer[at] == '"') {
      ++at;
      if (at >= row_end || buffer[at] != '"') break;
    }
    buffer[last++] = buffer[at++];
  }
  cells.emplace_back(buffer.data() + first, last - first);
  if (at < row_end && buffer[at] != ',') {
    return fail(line, "text follows the closing quote of a cell; double the quotes inside cells");
  }
  return Step::row;
}

/// Cuts buffer[begin, row_end) into cells.
Reader::Step Reader::Impl::split(std::size_t row_end) {
  cells.clear();
  std::size_t at = begin;
  while (true) {
    if (at < row_end && buffer[at] == '"') {
      if (take_quoted(at, row_end) == Step::error) return Step::error;
    } else {
      const void* comma = std::memchr(buffer.data() + at, ',', row_end - at);
      const std::size_t cell_end =
          comma ? static_cast<std::size_t>(static_cast<const char*>(comma) - buffer.data())
                : row_end;
      cells.emplace_back(buffer.data() + at, cell_end - at);
      at = cell_end;
    }
    if (at == row_end) return Step::row;
    ++at;
  }
}

/// The next row that is not empty, whatever its number of cells.
Reader::Step Reader::Impl::read_row() {
  only_row_is_bad = false;
  while (true) {
    std::size_t row_end = 0;
    const Step found = find_row_end(row_end);
    if (found == Step::error || (found == Step::end && begin == end)) return found;
    const std::size_t following = std::min(row_end + 1, end);
    if (row_end > begin && buffer[row_end - 1] == '\r') --row_end;
    line = next_line;
    next_line += static_cast<std::uint64_t>(
        std::count(buffer.begin() + static_cast<std::ptrdiff_t>(begin),
                   buffer.begin() + static_cast<std::ptrdiff_t>(following), '\n'));
    const bool empty = row_end == begin;
    const Step step = empty ? Step::row : split(row_end);
    only_row_is_bad = step == Step::error;
    consumed += following - begin;
    begin = following;
    if (!empty) return step;
  }
}

std::optional<Error> Reader::Impl::read_header() {
  if (fill() == Step::error) return error;
  const std::string_view head(buffer.data() + begin, end - begin);
  if (head.starts_with("\xEF\xBB\xBF")) begin = consumed = 3;
  if (head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF")) {
    return whole_file("the text is UTF-16; save it as UTF-8 (iconv -f UTF-16 -t UTF-8)");
  }
  if (head.starts_with("\x1F\x8B") || head.find('\0') != std::string_view::npos) {
    return whole_file("the file is packed or no text; unpack it, or convert it to text, first");
  }
  const Step step = read_row();
  if (step == Step::error) return error;
  if (step == Step::end) {
    return whole_file("the file is empty; a header row with the names of the columns is needed");
  }
  const auto is_number = [](std::string_view cell) { return to_number(cell).has_value(); };
  if (std::all_of(cells.begin(), cells.end(), is_number)) {
    fail(line, "the first row holds numbers; put a header row with the names of the columns first");
    return error;
  }
  for (const auto cell : cells) columns.emplace_back(trimmed(cell));
  auto sorted = columns;
  std::sort(sorted.begin(), sorted.end());
  for (auto twin = std::adjacent_find(sorted.begin(), sorted.end()); twin != sorted.end();
       twin = std::adjacent_find(twin + 1, sorted.end())) {
    if (twin->empty()) continue;
    fail(line, "two columns are called '" + *twin + "'; give each column its own name");
    return error;
  }
  return std::nullopt;
}

Reader::Reader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Reader::~Reader() = default;
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;

std::variant<Reader, Error> Reader::start(std::unique_ptr<Impl> impl) {
  if (auto error = impl->read_header()) return *std::move(error);
  return Reader(std::move(impl));
}

std::variant<Reader, Error> Reader::open(const std::filesystem::path& path) {
  auto impl = std::make_unique<Impl>();
  impl->name = path.string();
  std::error_code failed;
  if (std::filesystem::is_directory(path, failed)) {
    return impl->whole_file("is a directory; name a CSV file in it");
  }
  impl->file.reset(std::fopen(path.c_str(), "rb"));
  if (!impl->file) {
    const int code = errno;
    const std::string reason = std::error_code(code, std::generic_category()).message();
    if (code == ENOENT) return impl->whole_file("there is no such file; check the path");
    if (code == EACCES) return impl->whole_file("no permission to read it (chmod +r mends it)");
    return impl->whole_file("cannot be opened: " + reason);
  }
  const auto size = std::filesystem::file_size(path, failed);
  if (!failed) impl->size = size;
  return start(std::move(impl));
}

std::variant<Reader, Error> Reader::from_text(std::string text, std::string name) {
  auto impl = std::make_unique<Impl>();
  impl->name = std::move(name);
  impl->buffer = std::move(text);
  impl->end = impl->buffer.size();
  impl->size = impl->buffer.size();
  return start(std::move(impl));
}

const std::vector<std::string>& Reader::columns() const {
  return impl_->columns;
}

std::variant<std::size_t, Error> Reader::find(std::string_view column) const {
  const auto& columns = impl_->columns;
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end()) {
    return impl_->whole_file("there is no column '" + std::string(column) +
                             "'; the columns are: " + joined(columns));
  }
  return static_cast<std::size_t>(found - columns.begin());
}

Reader::Step Reader::next() {
  const Step step = impl_->read_row();
  if (step != Step::row || impl_->cells.size() == impl_->columns.size()) return step;
  impl_->only_row_is_bad = true;
  return impl_->fail(impl_->line, "the row has " + std::to_string(impl_->cells.size()) +
                                      " cells, the header has " +
                                      std::to_string(impl_->columns.size()) +
                                      "; mend the row (a cell with a comma needs quotes)");
}

std::span<const std::string_view> Reader::cells() const {
  return impl_->cells;
}
std::uint64_t Reader::line() const {
  return impl_->line;
}
const Error& Reader::error() const {
  return impl_->error;
}
bool Reader::only_row_is_bad() const {
  return impl_->only_row_is_bad;
}
std::uint64_t Reader::next_line() const {
  return impl_->next_line;
}
std::uint64_t Reader::bytes_read() const {
  return impl_->consumed;
}
std::uint64_t Reader::size() const {
  return impl_->size;
}

std::optional<Error> Reader::go_on_at(std::uint64_t position, std::uint64_t line) {
  Impl& at = *impl_;
  assert(at.file);
  if (fseeko(at.file.get(), static_cast<off_t>(position), SEEK_SET) != 0) {
    return at.whole_file("cannot be read from its middle: " +
                         std::error_code(errno, std::generic_category()).message());
  }
  at.begin = at.end = 0;
  at.consumed = position;
  at.next_line = line;
  return std::nullopt;
}

Error Reader::error_here(std::string_view what) const {
  return {impl_->name + ":" + std::to_string(impl_->line) + ": " + std::string(what)};
}

std::variant<std::int64_t, Error> Reader::time_at(std::size_t column) const {
  const std::string_view cell = impl_->cells[column];
  if (const auto time = parse_time(cell)) return *time;
  const std::string shown(cell.substr(0, 40));
  return error_here("'" + shown + "' in column '" + impl_->columns[column] +
                    "' is no time; use seconds since 1970-01-01 UTC or 2023-04-29T16:22:37Z");
}

std::variant<Table, Error> read_table(const std::filesystem::path& path,
                                      std::span<const std::string> columns,
                                      const std::optional<std::string>& time_column) {
  auto opened = Reader::open(path);
  if (auto* error = std::get_if<Error>(&opened)) return std::move(*error);
  auto& reader = std::get<Reader>(opened);

  std::vector<std::size_t> positions;
  for (const auto& column : columns) {
    const auto found = reader.find(column);
    if (const auto* error = std::get_if<Error>(&found)) return *error;
    positions.push_back(std::get<std::size_t>(found));
  }
  std::optional<std::size_t> time_position;
  if (time_column) {
    const auto found = reader.find(*time_column);
    if (const auto* error = std::get_if<Error>(&found)) return *error;
    time_position = std::get<std::size_t>(found);
  }

  Table table;
  table.values.resize(columns.size());
  Reader::Step step = reader.next();
  for (; step == Reader::Step::row; step = reader.next()) {
    const auto cells = reader.cells();
    for (std::size_t c = 0; c < positions.size(); ++c) {
      const auto number = to_number(cells[positions[c]]);
      table.values[c].push_back(number.value_or(std::numeric_limits<double>::quiet_NaN()));
    }
    if (time_position) {
      const auto time = reader.time_at(*time_position);
      if (const auto* error = std::get_if<Error>(&time)) return *error;
      table.time_ns.push_back(std::get<std::int64_t>(time));
    }
    ++table.rows;
  }
  if (step == Reader::Step::error) return reader.error();
  return table;
}

}  // namespace reident::csv
