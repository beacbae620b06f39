#include "service/transfer/telemetry_csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::transfer {
namespace {

constexpr std::size_t digits_of_nanoseconds = 17;

bool has(const std::vector<std::string>& columns, std::string_view column) {
  return std::find(columns.begin(), columns.end(), column) != columns.end();
}

std::string_view name(TimeUnit unit) {
  constexpr std::array<std::string_view, 5> names = {"any", "s", "ms", "us", "ns"};
  return names[static_cast<std::size_t>(unit)];
}

bool is_whole(std::string_view text) {
  if (!text.empty() && text.front() == '-') text.remove_prefix(1);
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

bool same_words(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return x == y || (x == '_' && y == ' ') || (x == ' ' && y == '_');
  });
}

template <class T, std::size_t count>
std::optional<T> by_name(std::string_view cell, const std::array<T, count>& all) {
  for (const T one : all)
    if (same_words(trimmed(cell), storage::name(one))) return one;
  return std::nullopt;
}

}  // namespace

bool is_long_layout(const std::vector<std::string>& columns) {
  return has(columns, "parameter") && has(columns, "time") && has(columns, "value");
}

std::optional<double> parse_value(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() > 1 && cell[0] == '+' && cell[1] != '-') cell.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || end != cell.data() + cell.size()) return std::nullopt;
  return value;
}

std::optional<storage::Quality> parse_quality(std::string_view cell) {
  return by_name(cell, storage::qualities);
}

std::optional<storage::Origin> parse_origin(std::string_view cell) {
  return by_name(cell, std::array{storage::Origin::real, storage::Origin::simulated});
}

std::optional<TimeUnit> parse_time_unit(std::string_view text) {
  for (const TimeUnit unit : {TimeUnit::s, TimeUnit::ms, TimeUnit::us, TimeUnit::ns})
    if (text == name(unit)) return unit;
  return std::nullopt;
}

TimeUnit unit_of_column(std::string_view column) {
  const auto underscore = column.rfind('_');
  if (underscore == std::string_view::npos) return TimeUnit::any;
  const auto unit = parse_time_unit(column.substr(underscore + 1));
  return unit && *unit != TimeUnit::s ? *unit : TimeUnit::any;
}

std::optional<storage::Time> parse_time_in(TimeUnit unit, std::string_view cell) {
  cell = trimmed(cell);
  const bool in_ns =
      unit == TimeUnit::ns || (unit == TimeUnit::any && cell.size() >= digits_of_nanoseconds);
  if (in_ns && is_whole(cell)) {
    storage::Time time = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), time);
    return error == std::errc{} ? std::optional(time) : std::nullopt;
  }
  if (unit == TimeUnit::any) return parse_time(cell);
  // A unit that is there already is no number of this one.
  if (cell.empty() || cell.find_first_not_of("+-.0123456789eE") != std::string_view::npos)
    return std::nullopt;
  return parse_duration(std::string(cell).append(name(unit)));
}

void append_value(std::string& line, double value) {
  if (std::isnan(value)) {
    line += "nan";
    return;
  }
  std::array<char, 32> text;
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value);
  line.append(text.data(), written.ptr);
}

void append_time(std::string& line, storage::Time time) {
  line += time_text(time);
}

void append_text(std::string& line, std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos && trimmed(text) == text) {
    line += text;
    return;
  }
  line += '"';
  for (const char c : text) {
    if (c == '"') line += '"';
    line += c;
  }
  line += '"';
}

}  // namespace reident::transfer
