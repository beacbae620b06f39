#include "storage/sql/selection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "storage/sql/utc_bounds.hpp"
#include "storage/types/time_ends.hpp"
#include "storage/types/utc_text.hpp"

namespace reident::storage::sql {
namespace {

constexpr TimeBounds none{0, -1};
constexpr double two_to_63 = 9223372036854775808.0;

bool is_lower_bound(Comparison comparison) {
  return comparison == Comparison::above || comparison == Comparison::from;
}

/// Those times that are at least `from`, or below it: what compares true with a number between
/// `from - 1` and `from`, where `exact` says that it is `from` itself.
TimeBounds beside(Time from, bool exact, Comparison comparison) {
  const TimeBounds after = from == latest_time ? none : TimeBounds{from + 1, latest_time};
  const TimeBounds before = from == earliest_time ? none : TimeBounds{earliest_time, from - 1};
  switch (comparison) {
    case Comparison::above:
      return exact ? after : TimeBounds{from, latest_time};
    case Comparison::from:
      return {from, latest_time};
    case Comparison::below:
      return before;
    case Comparison::to:
      return exact ? TimeBounds{earliest_time, from} : before;
    case Comparison::equal:
    case Comparison::in:
      break;
  }
  return exact ? TimeBounds{from, from} : none;
}

/// What lies below all that a comparison is made with, as numbers do below texts.
TimeBounds all_below(Comparison comparison) {
  return comparison == Comparison::below || comparison == Comparison::to ? TimeBounds{} : none;
}

TimeBounds beside(double number, Comparison comparison) {
  if (number >= two_to_63) return all_below(comparison);
  if (number < -two_to_63) return is_lower_bound(comparison) ? TimeBounds{} : none;
  const double from = std::ceil(number);
  if (from >= two_to_63) return all_below(comparison);
  return beside(static_cast<Time>(from), from == number, comparison);
}

std::string_view text_of(sqlite3_value* value) {
  const unsigned char* text = sqlite3_value_text(value);
  if (text == nullptr) throw std::bad_alloc();
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_value_bytes(value))};
}

/// Nothing equals NULL, and no text equals a blob.
void add_text(std::set<std::string, std::less<>>& texts, sqlite3_value* value) {
  const int type = sqlite3_value_type(value);
  if (type != SQLITE_NULL && type != SQLITE_BLOB) texts.emplace(text_of(value));
}

}  // namespace

void TimeBounds::intersect(TimeBounds other) {
  first = std::max(first, other.first);
  last = std::min(last, other.last);
  if (empty()) clear();
}

void TextChoice::intersect(std::set<std::string, std::less<>> texts) {
  if (texts_)
    std::erase_if(texts, [&](const std::string& text) { return !texts_->contains(text); });
  texts_ = std::move(texts);
}

void narrow_time(TimeBounds& bounds, Comparison comparison, sqlite3_value* operand) {
  switch (sqlite3_value_numeric_type(operand)) {
    case SQLITE_INTEGER:
      return bounds.intersect(beside(sqlite3_value_int64(operand), true, comparison));
    case SQLITE_FLOAT:
      return bounds.intersect(beside(sqlite3_value_double(operand), comparison));
    case SQLITE_NULL:
      return bounds.clear();
    default:
      return bounds.intersect(all_below(comparison));
  }
}

void narrow_utc(TimeBounds& bounds, Comparison comparison, sqlite3_value* operand) {
  const int type = sqlite3_value_type(operand);
  if (type == SQLITE_NULL) return bounds.clear();
  if (type == SQLITE_BLOB) return bounds.intersect(all_below(comparison));
  narrow_utc_text(bounds, comparison, text_of(operand));
}

void narrow_utc_text(TimeBounds& bounds, Comparison comparison, std::string_view text) {
  const std::optional<Time> from = first_time_from(text);
  if (!from) return bounds.intersect(all_below(comparison));
  bounds.intersect(beside(*from, utc_text(*from) == text, comparison));
}

void narrow_text(TextChoice& choice, Comparison comparison, sqlite3_value* operand) {
  std::set<std::string, std::less<>> texts;
  if (comparison == Comparison::in) {
    sqlite3_value* element = nullptr;
    int code = sqlite3_vtab_in_first(operand, &element);
    for (; code == SQLITE_OK && element != nullptr; code = sqlite3_vtab_in_next(operand, &element))
      add_text(texts, element);
    if (code != SQLITE_DONE && code != SQLITE_OK)
      throw QueryError(code, "a list could not be read");
  } else {
    add_text(texts, operand);
  }
  choice.intersect(std::move(texts));
}

void narrow_value(Selection& selection, Comparison comparison, sqlite3_value* operand) {
  selection.by_value = true;
  const int type = sqlite3_value_type(operand);
  if (type == SQLITE_NULL) return selection.time.clear();
  if (type != SQLITE_INTEGER && type != SQLITE_FLOAT) return;
  // The nearest double to an integer may lie on its wrong side.
  const double number = sqlite3_value_double(operand);
  const bool rounded = type == SQLITE_INTEGER;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double low = rounded ? std::nextafter(number, -infinity) : number;
  const double high = rounded ? std::nextafter(number, infinity) : number;
  if (is_lower_bound(comparison) || comparison == Comparison::equal)
    selection.least = std::max(selection.least, low);
  if (!is_lower_bound(comparison)) selection.greatest = std::min(selection.greatest, high);
}

}  // namespace reident::storage::sql
