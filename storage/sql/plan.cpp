#include "storage/sql/plan.hpp"

#include <algorithm>
#include <cstring>

namespace reident::storage::sql {
namespace {

// The text that is passed on: a column and a comparison for each operand, a bar, and a column and a
// direction for each term of the order.
constexpr char ascending = 'a', descending = 'd', bar = '|';
char coded(Column column) {
  return static_cast<char>('0' + static_cast<char>(column));
}
Column decoded(char code) {
  return static_cast<Column>(code - '0');
}

bool is_text(Column column) {
  return column != Column::time && column != Column::value && column != Column::series;
}
bool is_of_series(Column column) {
  return column == Column::spacecraft || column == Column::parameter || column == Column::origin;
}
bool is_time(Column column) {
  return column == Column::time || column == Column::utc;
}

std::optional<Comparison> comparison_of(unsigned char operation) {
  switch (operation) {
    case SQLITE_INDEX_CONSTRAINT_EQ:
      return Comparison::equal;
    case SQLITE_INDEX_CONSTRAINT_GT:
      return Comparison::above;
    case SQLITE_INDEX_CONSTRAINT_GE:
      return Comparison::from;
    case SQLITE_INDEX_CONSTRAINT_LT:
      return Comparison::below;
    case SQLITE_INDEX_CONSTRAINT_LE:
      return Comparison::to;
    default:
      return std::nullopt;
  }
}

bool is_by_bytes(sqlite3_index_info& question, int index) {
  return std::strcmp(sqlite3_vtab_collation(&question, index), "BINARY") == 0;
}

/// How the table takes a condition over; none where SQLite keeps it.
std::optional<Comparison> taken(sqlite3_index_info& question, int index) {
  const auto& constraint = question.aConstraint[index];
  if (!constraint.usable || constraint.iColumn < 0) return std::nullopt;
  const auto column = static_cast<Column>(constraint.iColumn);
  const auto comparison = comparison_of(constraint.op);
  if (!comparison || column == Column::series) return std::nullopt;
  if (!is_text(column)) return comparison;
  if (column != Column::utc) return text_condition(question, index);
  return is_by_bytes(question, index) ? comparison : std::nullopt;
}

/// Guesses that rank the ways to run a statement: an archive of 500 parameters and a year.
void estimate(sqlite3_index_info& question, const std::string& text) {
  double rows = 1e9, series = 1000, looked_at = 1;
  const std::string conditions = text.substr(0, text.find(bar));
  for (std::size_t i = 0; i + 1 < conditions.size(); i += 2) {
    const Column column = decoded(conditions[i]);
    const auto comparison = static_cast<Comparison>(conditions[i + 1]);
    const bool exact = comparison == Comparison::equal;
    if (column == Column::spacecraft || column == Column::origin) series /= 2;
    if (column == Column::parameter) series /= exact ? 250 : 50;
    if (is_time(column)) rows /= exact ? 3e7 : 20;
    if (column == Column::value) looked_at /= 4;
    if (column == Column::quality || column == Column::source) looked_at /= 2;
  }
  rows = rows / 1000 * series;
  question.estimatedRows = static_cast<sqlite3_int64>(std::max(1.0, rows * looked_at));
  question.estimatedCost = 50 + 20 * series + rows * (0.2 + looked_at);
}

/// The order that the statement asks for, as far as it is not fixed by conditions; none where the
/// table cannot give it.
std::optional<std::string> order_of(const sqlite3_index_info& question, const std::string& fixed) {
  std::string order;
  bool by_time = false;
  for (int i = 0; i < question.nOrderBy; ++i) {
    const auto& term = question.aOrderBy[i];
    if (term.iColumn < 0) return std::nullopt;
    const auto column = static_cast<Column>(term.iColumn);
    if (fixed.find(coded(column)) != std::string::npos || (by_time && is_time(column))) continue;
    if (!is_of_series(column) && !is_time(column)) return std::nullopt;
    by_time |= is_time(column);
    order += {coded(column), term.desc ? descending : ascending};
  }
  return order;
}

void narrow(Selection& selection, Column column, Comparison comparison, sqlite3_value* operand) {
  switch (column) {
    case Column::spacecraft:
      return narrow_text(selection.spacecraft, comparison, operand);
    case Column::parameter:
      return narrow_text(selection.parameter, comparison, operand);
    case Column::source:
      return narrow_text(selection.source, comparison, operand);
    case Column::quality:
      return narrow_text(selection.quality, comparison, operand);
    case Column::origin:
      return narrow_text(selection.origin, comparison, operand);
    case Column::time:
      return narrow_time(selection.time, comparison, operand);
    case Column::utc:
      return narrow_utc(selection.time, comparison, operand);
    case Column::value:
      return narrow_value(selection, comparison, operand);
    case Column::series:
      break;
  }
}

void add_order(RowOrder& order, Column column, bool is_descending) {
  if (is_time(column)) {
    order.by_time = true;
    order.descending = is_descending;
  } else {
    (order.by_time ? order.after : order.before).push_back({column, is_descending});
  }
}

}  // namespace

std::optional<Comparison> text_condition(sqlite3_index_info& question, int index) {
  const auto& constraint = question.aConstraint[index];
  if (!constraint.usable || constraint.op != SQLITE_INDEX_CONSTRAINT_EQ ||
      !is_by_bytes(question, index))
    return std::nullopt;
  return sqlite3_vtab_in(&question, index, 1) != 0 ? Comparison::in : Comparison::equal;
}

int plan_telemetry(sqlite3_index_info& question) {
  std::string text, fixed;
  int operands = 0;
  for (int i = 0; i < question.nConstraint; ++i) {
    const auto comparison = taken(question, i);
    if (!comparison) continue;
    const auto column = static_cast<Column>(question.aConstraint[i].iColumn);
    text += {coded(column), static_cast<char>(*comparison)};
    if (comparison == Comparison::equal && column != Column::value) fixed += coded(column);
    question.aConstraintUsage[i].argvIndex = ++operands;
    question.aConstraintUsage[i].omit = column != Column::value;
  }
  text += bar;
  if (const auto order = order_of(question, fixed)) {
    text += *order;
    question.orderByConsumed = 1;
  }
  estimate(question, text);
  question.idxNum = static_cast<int>(question.colUsed & 0x1ff);
  question.idxStr = sqlite3_mprintf("%s", text.c_str());
  question.needToFreeIdxStr = 1;
  return question.idxStr == nullptr ? SQLITE_NOMEM : SQLITE_OK;
}

Plan understand(int columns, const char* text, std::span<sqlite3_value*> operands) {
  Plan plan;
  const auto is_wanted = [columns](Column column) {
    return (columns >> static_cast<int>(column) & 1) != 0;
  };
  plan.wanted = {.value = is_wanted(Column::value),
                 .quality = is_wanted(Column::quality),
                 .source = is_wanted(Column::source)};
  for (sqlite3_value* operand : operands) {
    narrow(plan.selection, decoded(text[0]), static_cast<Comparison>(text[1]), operand);
    text += 2;
  }
  for (++text; *text != '\0'; text += 2)
    add_order(plan.order, decoded(text[0]), text[1] == descending);
  return plan;
}

}  // namespace reident::storage::sql
