#include "service/telemetry_file/head_lines.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "service/support/text.hpp"
#include "service/telemetry_file/date_text.hpp"

namespace reident::telemetry_file {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
constexpr std::size_t lines_looked_at = 400;
constexpr int lines_in_a_cell = 20;  // more are a stray quote

/// The end of the line at `at`, lines with an open quote joined.
std::size_t row_end(std::string_view text, std::size_t at, char line_end) {
  const std::size_t first = std::min(text.find(line_end, at), text.size());
  std::size_t end = first;
  for (int lines = 0; lines < lines_in_a_cell; ++lines) {
    const std::string_view row = text.substr(at, end - at);
    if (std::count(row.begin(), row.end(), '"') % 2 == 0) return end;
    if (end == text.size()) break;
    end = std::min(text.find(line_end, end + 1), text.size());
  }
  return first;
}

}  // namespace

char find_line_end(std::string_view text) {
  if (text.find('\n') != std::string_view::npos) return '\n';
  return text.find('\r') != std::string_view::npos ? '\r' : '\n';
}

HeadLines lines_of(const RowReader::Head& head, char line_end) {
  HeadLines lines;
  std::size_t at = 0;
  while (head.text.substr(at).starts_with(byte_order_mark)) at += byte_order_mark.size();
  std::uint64_t number = 1;
  while (at < head.text.size() && lines.size() < lines_looked_at) {
    const std::size_t end = row_end(head.text, at, line_end);
    if (end == head.text.size() && !head.is_all && !lines.empty()) break;  // a part of a line
    std::string_view text = head.text.substr(at, end - at);
    const auto ends = std::count(text.begin(), text.end(), line_end);
    while (text.ends_with('\r')) text.remove_suffix(1);
    lines.push_back({text, number, at, {}});
    number += static_cast<std::uint64_t>(ends) + 1;
    at = end + 1;
  }
  return lines;
}

bool is_blank(const HeadLine& line) {
  const std::string_view text = trimmed(line.text);
  return text.empty() || is_ruled(text);
}

std::string find_comment(const HeadLines& lines) {
  for (const HeadLine& line : lines) {
    if (is_blank(line)) continue;
    for (const std::string_view mark : {"#", "%", "//", "\"#", "!"})
      if (line.text.starts_with(mark) && !line.text.starts_with("\"#\""))  // a name
        return std::string(mark);
    if (looks_like_value(line.text.substr(0, line.text.find_first_of(",;\t|")))) break;
  }
  // Among rows, where few lines begin so.
  for (const std::string_view mark : comment_marks) {
    const auto count = std::count_if(lines.begin(), lines.end(), [mark](const HeadLine& line) {
      return line.text.starts_with(mark);
    });
    if (count > 0 && 10 * count <= static_cast<std::ptrdiff_t>(lines.size()))
      return std::string(mark);
  }
  return "";
}

bool is_comment(const HeadLine& line, const std::string& mark) {
  return !mark.empty() && line.text.starts_with(mark);
}

void split(HeadLines& lines, char separator) {
  std::vector<std::string_view> cells;
  for (HeadLine& line : lines) {
    std::string text(line.text);
    line.cells.clear();
    if (split_cells(text, separator, cells)) continue;
    line.cells.assign(cells.begin(), cells.end());
  }
}

std::size_t usual_cells(const HeadLines& lines, const std::string& comment) {
  std::map<std::size_t, std::size_t> counts;
  for (const HeadLine& line : lines)
    if (!is_blank(line) && !is_comment(line, comment) && !line.cells.empty())
      ++counts[line.cells.size()];
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
        return a.second < b.second || (a.second == b.second && a.first < b.first);
      });
  return most == counts.end() ? 0 : most->first;
}

namespace {

/// How well the lines were cut: the share of lines with the usual number of cells, and of values
/// among those cells.
double quality_of(const HeadLines& lines, char separator, const std::string& comment) {
  const std::size_t usual = usual_cells(lines, comment);
  if (usual < 2) return 0;
  double all = 0, fitting = 0, cells = 0, values = 0;
  for (const HeadLine& line : lines) {
    if (is_blank(line) || is_comment(line, comment)) continue;
    all += 1;
    if (line.cells.size() != usual) continue;
    fitting += 1;
    for (const std::string& cell : line.cells) {
      if (trimmed(cell).empty()) continue;
      cells += 1;
      values += looks_like_value(cell) ? 1 : 0;
    }
  }
  return fitting / all * (0.2 + values / std::max(1.0, cells)) *
         (is_of_blanks(separator) ? 0.9 : 1);
}

/// Whether all lines, the first of which holds names, were cut into equally many cells.
bool are_alike(const HeadLines& lines, const std::string& comment) {
  const auto holds_cells = [&](const HeadLine& line) {
    return !is_blank(line) && !is_comment(line, comment);
  };
  const auto first = std::find_if(lines.begin(), lines.end(), holds_cells);
  return first != lines.end() && first->cells.size() > 1 &&
         std::none_of(first->cells.begin(), first->cells.end(), looks_like_value) &&
         std::all_of(first, lines.end(), [&](const HeadLine& line) {
           return !holds_cells(line) || line.cells.size() == first->cells.size();
         });
}

/// Whether a line of names was cut into as many cells as most lines.
bool has_names(const HeadLines& lines, const std::string& comment) {
  const std::size_t usual = usual_cells(lines, comment);
  return std::any_of(lines.begin(), lines.end(), [&](const HeadLine& line) {
    return !is_blank(line) && !is_comment(line, comment) && line.cells.size() == usual &&
           std::none_of(line.cells.begin(), line.cells.end(), looks_like_value);
  });
}

}  // namespace

char find_separator(HeadLines& lines, const std::string& comment) {
  char best = ',';
  double most = 0;
  // Blanks stand in cells too: in dates with a time of day.
  bool may_be_blanks = std::none_of(lines.begin(), lines.end(), [](const HeadLine& line) {
    return line.text.find('\t') != std::string_view::npos;
  });
  for (const char separator : {',', ';', '\t', '|', ' ', two_blanks}) {
    if (is_of_blanks(separator) && !may_be_blanks) continue;
    split(lines, separator);
    if (separator != '\t' && !is_of_blanks(separator) && are_alike(lines, comment))
      may_be_blanks = false;
    if (separator == two_blanks && !has_names(lines, comment)) continue;
    const double quality = quality_of(lines, separator, comment);
    if (quality > most + 1e-9) {
      most = quality;
      best = separator;
    }
  }
  return best;
}

namespace {

constexpr double lines_in_place = 0.95;

std::vector<std::string_view> cells_in(std::string& text, char separator) {
  std::vector<std::string_view> cells;
  if (split_cells(text, separator, cells)) cells.clear();
  return cells;
}

/// The places that the cells of these lines take; none where two columns stand in one.
std::vector<Place> places_of(const std::vector<const HeadLine*>& lines, char separator,
                             std::size_t count) {
  std::vector<Place> places(count, {std::string_view::npos, 0});
  for (const HeadLine* line : lines) {
    std::string text(line->text);
    const auto cells = cells_in(text, separator);
    for (std::size_t c = 0; c < count && c < cells.size(); ++c) {
      const auto begin = static_cast<std::size_t>(cells[c].data() - text.data());
      places[c].begin = std::min(places[c].begin, begin);
      places[c].end = std::max(places[c].end, begin + cells[c].size());
    }
  }
  for (std::size_t c = 1; c < count; ++c)
    if (places[c].begin <= places[c - 1].end) return {};
  return places;
}

}  // namespace

std::vector<Place> find_places(HeadLines& lines, char separator, const std::string& comment) {
  std::size_t most = 0;
  bool differ = false;
  for (const HeadLine& line : lines) {
    if (is_blank(line) || is_comment(line, comment) || line.cells.empty()) continue;
    if (line.text.find('\t') != std::string_view::npos) return {};
    differ = differ || (most != 0 && line.cells.size() != most);
    most = std::max(most, line.cells.size());
  }
  if (!differ || most < 2) return {};
  std::vector<const HeadLine*> full, rows;
  for (const HeadLine& line : lines) {
    if (is_blank(line) || is_comment(line, comment) || line.cells.size() != most) continue;
    full.push_back(&line);
    if (std::any_of(line.cells.begin(), line.cells.end(), looks_like_value)) rows.push_back(&line);
  }
  auto places = places_of(full, separator, most);
  if (places.empty()) places = places_of(rows, separator, most);
  if (places.empty()) return {};
  HeadLines placed = lines;
  std::size_t short_lines = 0, in_place = 0;
  for (auto line = placed.begin() + (full.front() - lines.data()); line != placed.end(); ++line) {
    if (is_blank(*line) || is_comment(*line, comment) || line->cells.size() == most) continue;
    ++short_lines;
    std::string text(line->text);
    auto cells = cells_in(text, separator);
    if (cells.empty() || !place_cells(text, places, cells)) continue;
    line->cells.assign(cells.begin(), cells.end());
    ++in_place;
  }
  if (in_place == 0 ||
      static_cast<double>(in_place) < lines_in_place * static_cast<double>(short_lines))
    return {};
  lines = std::move(placed);
  return places;
}

bool looks_like_value(std::string_view cell) {
  cell = trimmed(cell);
  constexpr std::string_view minus = "\xE2\x88\x92";
  if (cell.starts_with(minus)) cell.remove_prefix(minus.size());
  if (cell.starts_with('+') || cell.starts_with('-')) cell = trimmed(cell.substr(1));
  if (cell.starts_with('"')) cell.remove_prefix(1);
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (cell.empty() || (!is_digit(cell.front()) &&
                       std::string_view(".(,").find(cell.front()) == std::string_view::npos))
    return false;
  std::size_t digits = 0;
  for (const char c : cell) {
    if (std::string_view(";|\t\"<>").find(c) != std::string_view::npos) return false;
    digits += is_digit(c) ? 1U : 0U;
  }
  if (digits == 0) return false;
  const bool has_clock = cell.find(':') != std::string_view::npos;
  if (cell.find(' ') != std::string_view::npos && !has_clock) {
    // A group of thousands or a unit may stand apart, another number may not.
    const std::string_view rest = trimmed(cell.substr(cell.find(' ')));
    const bool is_group =
        rest.size() >= 3 && rest.find_first_not_of("0123456789") >= 3 &&
        (rest.size() == 3 || std::string_view(" .,").find(rest[3]) != std::string_view::npos);
    return is_group || rest.find_first_of("0123456789") == std::string_view::npos ||
           read_date_text(cell, DateOrder::day_first);
  }
  if (has_clock) {
    // A comma is the mark of a part of a second.
    const auto comma = cell.find(',');
    if (comma == std::string_view::npos) return true;
    const std::string_view part = cell.substr(comma + 1);
    return comma > cell.rfind(':') && !part.empty() && is_digit(part.front()) &&
           part.find_first_of(",.") == std::string_view::npos;
  }
  return digits * 2 + 8 >= cell.size();
}

bool is_unit_word(std::string_view word) {
  word = trimmed(word);
  if (word.size() > 2 &&
      ((word.front() == '[' && word.back() == ']') || (word.front() == '(' && word.back() == ')')))
    return true;
  if (word.empty() || word.find(' ') != std::string_view::npos) return false;
  constexpr std::string_view words =
      " "
      "V mV uV kV \xC2\xB5"
      "V A mA uA \xC2\xB5"
      "A \xCE\xBC"
      "A W mW kW Ah mAh Wh As C "
      "degC \xC2\xB0"
      "C \xC2\xB0"
      " K F deg rad rad/s deg/s Hz kHz MHz Pa kPa hPa bar mbar "
      "psi Ohm ohm \xCE\xA9"
      " % pct rpm N Nm T nT uT m km mm m/s km/s kg g s sec ms us ns "
      "min h d UTC utc ISO ISO8601 counts DN LSB bool enum 1 dB dBm Volt Volts volts Amp "
      "Amps amps Ampere Celsius seconds Seconds J l/min lux Gs G mT raw n/a none unix time "
      "date datetime second volt ampere ";
  return words.find(" " + std::string(word) + " ") != std::string_view::npos;
}

Error whole_file(const std::string& name, std::string_view what) {
  return {name + ": " + std::string(what)};
}
Error at_line(const std::string& name, std::uint64_t line, std::string_view what) {
  return {name + ":" + std::to_string(line) + ": " + std::string(what)};
}

}  // namespace reident::telemetry_file
