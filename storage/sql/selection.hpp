// Which samples a statement wants, as far as its conditions were understood.
//
// Conditions on series, time, source and quality are applied to the letter: with the values, types
// and conversions that SQLite would compare a table's columns with (time INTEGER, texts TEXT).
// Those on values bound them generously; SQLite looks at what is left again.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <set>
#include <string>

#include "storage/sql/sqlite_api.hpp"
#include "storage/types/telemetry.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage::sql {

enum class Comparison : char {
  equal = '=',
  in = 'i',
  above = '>',
  from = '}',
  below = '<',
  to = '{'
};

/// Times from `first` to `last`, both included; empty where first > last.
struct TimeBounds {
  Time first = earliest_time;
  Time last = latest_time;

  bool empty() const { return first > last; }
  void clear() { *this = {0, -1}; }
  void intersect(TimeBounds other);
};

/// Texts, all where there is no set.
class TextChoice {
 public:
  bool has(std::string_view text) const { return !texts_ || texts_->contains(text); }
  bool all() const { return !texts_; }
  const std::set<std::string, std::less<>>& texts() const { return *texts_; }
  void intersect(std::set<std::string, std::less<>> texts);

 private:
  std::optional<std::set<std::string, std::less<>>> texts_;
};

struct Selection {
  TextChoice spacecraft, parameter, origin, source, quality;
  TimeBounds time;
  bool by_value = false;  // then NaN is not wanted, nor what is outside
  double least = -std::numeric_limits<double>::infinity();
  double greatest = std::numeric_limits<double>::infinity();
};

/// Each narrows what its first argument says to what compares true.
void narrow_time(TimeBounds& bounds, Comparison comparison, sqlite3_value* operand);
void narrow_utc(TimeBounds& bounds, Comparison comparison, sqlite3_value* operand);
void narrow_utc_text(TimeBounds& bounds, Comparison comparison, std::string_view text);
void narrow_text(TextChoice& choice, Comparison comparison, sqlite3_value* operand);
void narrow_value(Selection& selection, Comparison comparison, sqlite3_value* operand);

}  // namespace reident::storage::sql
