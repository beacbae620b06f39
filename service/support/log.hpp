// Structured log on standard error, one line an event:
//   2026-03-01T12:00:00.123Z warning archive: disk full path=/var/lib/reident.db retry_s=1
// Values with blanks, quotes or '=' are quoted; line ends in them become blanks. Any thread may
// log; lines do not mix. Each line is written before the call returns. A line below the level costs
// no more than the formatting of its fields. Under systemd the lines and their fields go to the
// journal (journal.hpp).
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace reident::log {

/// In ascending order; a line is written when its level is not below the one that is set (info).
enum class Level { debug, info, warning, error };

/// One `key=value` of a line. The key has to live until the call returns; the value is a copy.
struct Field {
  template <class T>
  Field(std::string_view name, const T& field_value)
      : key(name), value(fmt::format("{}", field_value)) {}
  std::string_view key;
  std::string value;
};

/// Sets the least level that is written: "debug", "info", "warning" or "error". Returns false, and
/// changes nothing, for any other name.
bool set_level(std::string_view name);

/// Writes one line. `component` is the part that speaks, such as "archive"; `message` is constant
/// text, and what varies is in the fields.
void write(Level level, std::string_view component, std::string_view message,
           std::initializer_list<Field> fields);

inline void debug(std::string_view component, std::string_view message,
                  std::initializer_list<Field> fields = {}) {
  write(Level::debug, component, message, fields);
}
inline void info(std::string_view component, std::string_view message,
                 std::initializer_list<Field> fields = {}) {
  write(Level::info, component, message, fields);
}
inline void warning(std::string_view component, std::string_view message,
                    std::initializer_list<Field> fields = {}) {
  write(Level::warning, component, message, fields);
}
inline void error(std::string_view component, std::string_view message,
                  std::initializer_list<Field> fields = {}) {
  write(Level::error, component, message, fields);
}

}  // namespace reident::log
