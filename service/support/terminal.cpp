#include "service/support/terminal.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <utility>

#include <sys/ioctl.h>

namespace reident {
namespace {

constexpr char escape = '\033';

/// The part of `text` that is one escape sequence or one code point.
std::string_view first_symbol(std::string_view text) {
  std::size_t size = 1;
  if (text[0] == escape && text.size() > 1 && text[1] == '[') {
    size = 2;
    while (size < text.size() && (text[size] < '@' || text[size] > '~')) ++size;
    size = std::min(size + 1, text.size());
  } else {
    while (size < text.size() && (static_cast<unsigned char>(text[size]) & 0xC0) == 0x80) ++size;
  }
  return text.substr(0, size);
}

/// Columns of a text that may have escape sequences.
std::size_t shown_width(std::string_view text) {
  std::size_t width = 0;
  while (!text.empty()) {
    const std::string_view symbol = first_symbol(text);
    width += symbol[0] != escape;
    text.remove_prefix(symbol.size());
  }
  return width;
}

/// Where lines after the first begin.
std::size_t hanging_indent(std::string_view line, std::size_t width) {
  constexpr std::size_t deep = 8;  // a line that begins there is a part of a column already
  const std::size_t lead = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t gap = line.find("  ", lead);
  std::size_t indent = lead >= deep ? lead : lead + 2;
  if (gap != std::string_view::npos)
    if (const std::size_t next = line.find_first_not_of(' ', gap); next != std::string_view::npos)
      indent = std::max(indent, shown_width(line.substr(0, next)));
  return 2 * indent > width ? std::min(lead + 2, width / 2) : indent;
}

/// Takes as much of a word as fits into `width` columns; at least a code point.
std::string_view fitting(std::string_view word, std::size_t width) {
  std::size_t size = 0, used = 0;
  while (size < word.size()) {
    const std::string_view symbol = first_symbol(word.substr(size));
    used += symbol[0] != escape;
    if (used > width && size > 0) break;
    size += symbol.size();
  }
  return word.substr(0, size);
}

/// Null where there is none.
std::FILE* started_pager() {
  const char* named = std::getenv("PAGER");
  const std::string program = named ? named : "command -v less >/dev/null && exec less || cat";
  if (program.empty() || program == "cat") return nullptr;
  std::signal(SIGPIPE, SIG_IGN);  // whoever has seen enough leaves the pager
  ::setenv("LESS", "FRX", 0);     // less: ends by itself where all fits, and shows colours
  return ::popen(program.c_str(), "w");
}

struct Sink {
  std::FILE* out;
  std::size_t width;
  bool is_pager;
  std::string line;

  bool write(std::string_view text) {
    return std::fwrite(text.data(), 1, text.size(), out) == text.size();
  }
  bool end_line() {
    const bool done = write(folded(line, width) + "\n");
    line.clear();
    return done;
  }
};

/// What to say of a write that failed: of a pager that was left, that it was done.
ssize_t is_left(const Sink& sink, std::size_t size) {
  return sink.is_pager ? static_cast<ssize_t>(size) : 0;
}

ssize_t write_folded(void* cookie, const char* bytes, std::size_t size) {
  Sink& sink = *static_cast<Sink*>(cookie);
  std::string_view text(bytes, size);
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    sink.line += text.substr(0, end);
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
    if (!sink.end_line()) return is_left(sink, size);
  }
  return std::fflush(sink.out) == 0 ? static_cast<ssize_t>(size) : is_left(sink, size);
}

int close_folded(void* cookie) {
  const std::unique_ptr<Sink> sink(static_cast<Sink*>(cookie));
  bool done = sink->line.empty() || sink->write(folded(sink->line, sink->width));
  done = std::fflush(sink->out) == 0 && done;
  if (sink->is_pager) ::pclose(sink->out);
  return done ? 0 : -1;
}

}  // namespace

std::size_t terminal_width(int descriptor) {
  winsize size{};
  const bool known = isatty(descriptor) == 1 && ioctl(descriptor, TIOCGWINSZ, &size) == 0;
  return known ? size.ws_col : 0;
}

bool shows_colours() {
  const char* forbidden = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  return isatty(STDOUT_FILENO) == 1 && (!forbidden || *forbidden == '\0') && terminal &&
         std::string_view(terminal) != "dumb";
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

std::string folded(std::string_view line, std::size_t width) {
  constexpr std::size_t least = 20;
  width = std::max(width, least);
  if (shown_width(line) <= width) return std::string(line);
  const std::string indent(hanging_indent(line, width), ' ');
  std::string text;
  std::size_t used = 0;  // columns of the last line
  bool is_new = true;    // nothing but its indent stands in the last line
  while (!line.empty()) {
    const std::size_t blanks = std::min(line.find_first_not_of(' '), line.size());
    std::string_view word = line.substr(blanks, line.find(' ', blanks) - blanks);
    const bool is_first = text.empty();
    line.remove_prefix(blanks + word.size());
    if (!is_first && !is_new && used + blanks + shown_width(word) > width) {
      text.append("\n").append(indent);
      used = indent.size();
      is_new = true;
    } else if (is_first || !is_new) {
      text.append(blanks, ' ');
      used += blanks;
    }
    while (used + shown_width(word) > width) {
      const std::string_view part = fitting(word, width - used);
      text.append(part).append("\n").append(indent);
      word.remove_prefix(part.size());
      used = indent.size();
    }
    text += word;
    used += shown_width(word);
    is_new = false;
  }
  return text;
}

void print_error(std::string_view text) {
  const std::size_t width = terminal_width(STDERR_FILENO);
  const std::string line = (width > 0 ? folded(text, width) : std::string(text)) + "\n";
  static_cast<void>(std::fwrite(line.data(), 1, line.size(), stderr));
}

FoldedOutput::FoldedOutput(bool with_pager) {
  const std::size_t width = terminal_width();
  if (width == 0) return;
  std::FILE* pager = with_pager ? started_pager() : nullptr;
  auto sink = std::make_unique<Sink>(Sink{pager ? pager : stdout, width, pager != nullptr, {}});
  std::FILE* folding = fopencookie(sink.get(), "w", {nullptr, write_folded, nullptr, close_folded});
  if (!folding) return;
  static_cast<void>(sink.release());  // close_folded() has it
  std::setvbuf(folding, nullptr, _IOLBF, BUFSIZ);
  before_ = std::exchange(stdout, folding);
}

FoldedOutput::~FoldedOutput() {
  if (!before_) return;
  std::fclose(std::exchange(stdout, before_));
}

}  // namespace reident
