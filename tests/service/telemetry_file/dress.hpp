// A record of telemetry, written out in any of the ways that people have.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "service/support/time_text.hpp"

namespace reident::telemetry_file::test {

/// Rows of two columns, u and y.
struct Rows {
  std::vector<std::int64_t> time_ns;
  std::vector<double> u, y;
};

enum class TimeForm {
  iso,
  day_of_year,
  colons,
  european,
  epoch_s,
  epoch_ms,
  epoch_us,
  filetime,
  two_columns,
  doy_columns,
  gps_week
};
inline constexpr int time_forms = 11;

struct Dress {
  char separator = ',';
  char decimal = '.';
  char thousands = '\0';
  bool quotes = false;
  bool sep_line = false;
  int metadata = 0;  // lines above the header
  std::string comment;
  bool units = false;
  std::string line_end = "\n";
  enum class Text { utf8, utf8_mark, utf16le, utf16be, latin1 } text = Text::utf8;
  TimeForm time = TimeForm::iso;
  bool last_line_end = true;
  bool trailing_separator = false;
};

inline std::string number(double value, const Dress& dress) {
  std::string text = fmt::format("{}", value);
  const auto point = text.find('.');
  if (dress.thousands != '\0' && text.find('e') == std::string::npos) {
    auto end = point == std::string::npos ? text.size() : point;
    const std::size_t first = text.front() == '-' ? 1 : 0;
    while (end > first + 3) text.insert(end -= 3, 1, '~');
  }
  for (char& c : text) {
    if (c == '.') c = dress.decimal;
    if (c == '~') c = dress.thousands;
  }
  return text;
}

inline std::vector<std::string> time_cells(std::int64_t ns, const Dress& dress) {
  const std::string iso = time_text(ns);  // 2024-02-28T22:00:00.5Z
  const std::string date = iso.substr(0, 10), clock = iso.substr(11, iso.size() - 12);
  const std::int64_t day = ns / 86'400'000'000'000;
  const std::int64_t january = *parse_time(iso.substr(0, 4) + "-01-01") / 86'400'000'000'000;
  const std::int64_t s = ns / 1'000'000'000;
  switch (dress.time) {
    case TimeForm::iso:
      return {iso};
    case TimeForm::day_of_year:
      return {fmt::format("{}-{:03}T{}Z", iso.substr(0, 4), day - january + 1, clock)};
    case TimeForm::colons:
      return {fmt::format("{}:{:03}:{}", iso.substr(0, 4), day - january + 1, clock)};
    case TimeForm::european:
      return {fmt::format("{}.{}.{} {}", date.substr(8, 2), date.substr(5, 2), date.substr(0, 4),
                          clock)};
    case TimeForm::epoch_s:
      return {fmt::format("{}", s)};
    case TimeForm::epoch_ms:
      return {fmt::format("{}", s * 1000)};
    case TimeForm::epoch_us:
      return {fmt::format("{}", s * 1'000'000)};
    case TimeForm::filetime:
      return {fmt::format("{}", ns / 100 + 116'444'736'000'000'000)};
    case TimeForm::two_columns:
      return {date, clock};
    case TimeForm::doy_columns:
      return {iso.substr(0, 4), fmt::format("{}", day - january + 1),
              fmt::format("{}", s % 86'400)};
    case TimeForm::gps_week: {
      const std::int64_t gps = s - 315'964'800 + 18;
      return {fmt::format("{}", gps / 604'800), fmt::format("{}", gps % 604'800)};
    }
  }
  return {};
}

inline std::vector<std::string> time_names(const Dress& dress) {
  switch (dress.time) {
    case TimeForm::two_columns:
      return {"Date", "Time"};
    case TimeForm::doy_columns:
      return {"year", "doy", "sec_of_day"};
    case TimeForm::gps_week:
      return {"GPS week", "TOW"};
    default:
      return {"Time"};
  }
}

inline std::string joined(const std::vector<std::string>& cells, const Dress& dress) {
  std::string line;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const bool quoted = dress.quotes || cells[c].find(dress.separator) != std::string::npos;
    if (c > 0) line += dress.separator;
    line += quoted ? "\"" + cells[c] + "\"" : cells[c];
  }
  return line + (dress.trailing_separator ? std::string(1, dress.separator) : "") + dress.line_end;
}

inline std::string encoded(const std::string& text, Dress::Text as) {
  if (as == Dress::Text::utf8) return text;
  if (as == Dress::Text::utf8_mark) return "\xEF\xBB\xBF" + text;
  std::string bytes = as == Dress::Text::utf16le   ? "\xFF\xFE"
                      : as == Dress::Text::utf16be ? "\xFE\xFF"
                                                   : "";
  for (std::size_t i = 0; i < text.size(); ++i) {
    auto c = static_cast<unsigned char>(text[i]);
    if (c >= 0xC0) {  // a letter of Latin-1, in two bytes
      c = static_cast<unsigned char>((c << 6) | (static_cast<unsigned char>(text[++i]) & 0x3F));
    }
    if (as == Dress::Text::utf16be) bytes += '\0';
    bytes += static_cast<char>(c);
    if (as == Dress::Text::utf16le) bytes += '\0';
  }
  return bytes;
}

/// The file's bytes; the columns are called "u (\u00B5A)" and "y".
inline std::string dressed(const Rows& rows, const Dress& dress) {
  std::string text;
  if (dress.sep_line) text += "sep=" + std::string(1, dress.separator) + dress.line_end;
  for (int line = 0; line < dress.metadata; ++line)
    text += dress.comment.empty()
                ? fmt::format("Export {} of the station{}", line, dress.line_end)
                : fmt::format("{} line {}: a, b{}", dress.comment, line, dress.line_end);
  std::vector<std::string> names = time_names(dress), units(names.size());
  names.insert(names.end(), {"u (\xC2\xB5"
                             "A)",
                             "y"});
  units.insert(units.end(), {"mA", "V"});
  text += joined(names, dress);
  if (dress.units) text += joined(units, dress);
  for (std::size_t row = 0; row < rows.time_ns.size(); ++row) {
    auto cells = time_cells(rows.time_ns[row], dress);
    cells.push_back(number(rows.u[row], dress));
    cells.push_back(number(rows.y[row], dress));
    text += joined(cells, dress);
  }
  if (!dress.last_line_end) text.resize(text.size() - dress.line_end.size());
  return encoded(text, dress.text);
}

}  // namespace reident::telemetry_file::test
