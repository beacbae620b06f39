#include "storage/sql/summary_arguments.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "storage/sql/utc_bounds.hpp"

namespace reident::storage::sql {
namespace {

struct Unit {
  std::string_view name;
  std::int64_t nanoseconds;
};
constexpr std::array<Unit, 7> units = {{{"ns", 1},
                                        {"us", 1'000},
                                        {"ms", 1'000'000},
                                        {"s", 1'000'000'000},
                                        {"min", 60'000'000'000},
                                        {"h", 3'600'000'000'000},
                                        {"d", 86'400'000'000'000}}};

[[noreturn]] void refuse(const std::string& what) {
  throw QueryError(SQLITE_ERROR, "telemetry_summary: " + what);
}

std::string copied_text(sqlite3_value* value) {
  const unsigned char* text = sqlite3_value_text(value);
  if (text == nullptr) throw std::bad_alloc();
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_value_bytes(value))};
}

/// A begin of yyyy-mm-ddThh:mm:ss.nnnnnnnnnZ, of at least the day.
bool is_utc(std::string_view text) {
  constexpr std::string_view form = "dddd-dd-ddTdd:dd:dd.dddddddddZ";
  if (text.size() < std::string_view("dddd-dd-dd").size() || text.size() > form.size())
    return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_digit = text[i] >= '0' && text[i] <= '9';
    if (form[i] == 'd' ? !is_digit : text[i] != form[i]) return false;
  }
  return true;
}

std::optional<std::int64_t> duration(const std::string& text) {
  std::int64_t number = 0;
  const char* const end = text.data() + text.size();
  auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc()) return std::nullopt;
  while (rest != end && *rest == ' ') ++rest;
  for (const Unit& unit : units)
    if (unit.name == std::string_view(rest, static_cast<std::size_t>(end - rest)) && number > 0 &&
        number <= std::numeric_limits<std::int64_t>::max() / unit.nanoseconds)
      return number * unit.nanoseconds;
  return std::nullopt;
}

}  // namespace

void narrow_to_argument(TimeBounds& bounds, Comparison comparison, const char* name,
                        sqlite3_value* argument) {
  const int type = sqlite3_value_type(argument);
  if (type == SQLITE_NULL) return;
  if (type == SQLITE_INTEGER || type == SQLITE_FLOAT)
    return narrow_time(bounds, comparison, argument);
  std::string text = copied_text(argument);
  if (text.size() > 10 && text[10] == ' ') text[10] = 'T';
  if (!is_utc(text))
    refuse(std::string(name) + " is '" + text +
           "': give nanoseconds since 1970, or UTC as '2026-03-01' or '2026-03-01T12:30:00'");
  narrow_utc_text(bounds, comparison, text);
}

std::optional<std::int64_t> step_argument(sqlite3_value* argument) {
  const int type = sqlite3_value_type(argument);
  if (type == SQLITE_NULL) return std::nullopt;
  const double number = type == SQLITE_FLOAT ? sqlite3_value_double(argument) : 0;
  if (number >= 1 && number < 9.2e18 && number == std::floor(number))
    return static_cast<std::int64_t>(number);
  if (type == SQLITE_INTEGER && sqlite3_value_int64(argument) > 0)
    return sqlite3_value_int64(argument);
  const std::string text = copied_text(argument);
  if (const auto step = type == SQLITE_TEXT ? duration(text) : std::nullopt) return step;
  refuse("step is '" + text +
         "': give nanoseconds above 0, or a whole number of ns, us, ms, s, min, h or d as '10min'");
}

void narrow_to_quality(TextChoice& quality, sqlite3_value* argument) {
  if (sqlite3_value_type(argument) == SQLITE_NULL) return;
  const std::string text = copied_text(argument);
  if (!quality_named(text)) refuse("quality is '" + text + "': give " + quality_names("'"));
  quality.intersect({text});
}

}  // namespace reident::storage::sql
