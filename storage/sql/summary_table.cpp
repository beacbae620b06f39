#include "storage/sql/summary_table.hpp"

#include <cstring>
#include <optional>

#include "storage/sql/plan.hpp"
#include "storage/sql/summary.hpp"
#include "storage/sql/summary_arguments.hpp"
#include "storage/sql/table.hpp"
#include "storage/types/utc_text.hpp"

namespace reident::storage::sql {
namespace summary_table {
namespace {

enum class Field : char {
  spacecraft,
  parameter,
  origin,
  bucket,
  first_time,
  last_time,
  samples,
  mean,
  least,
  greatest,
  first_value,
  last_value,
  least_time,
  greatest_time,
  worst_quality,
  begin_time,
  end_time,
  step,
  quality,
  utc,
  series
};

// The arguments are the first hidden columns.
constexpr const char* declaration =
    "CREATE TABLE telemetry_summary (spacecraft TEXT, parameter TEXT, origin TEXT, bucket INTEGER, "
    "first_time INTEGER, last_time INTEGER, samples INTEGER, mean, least, greatest, first_value, "
    "last_value, least_time INTEGER, greatest_time INTEGER, worst_quality TEXT, begin_time HIDDEN, "
    "end_time HIDDEN, step HIDDEN, quality HIDDEN, "
    "utc TEXT HIDDEN, series INTEGER HIDDEN, PRIMARY KEY (series, bucket)) WITHOUT ROWID";

constexpr Field arguments[] = {Field::begin_time, Field::end_time, Field::step, Field::quality};
constexpr int first_argument = static_cast<int>(Field::begin_time);

bool is_argument(int column) {
  return column >= first_argument && column <= static_cast<int>(Field::quality);
}

struct Cursor : sqlite3_vtab_cursor {
  explicit Cursor(Table& its_table) : sqlite3_vtab_cursor{}, table(its_table) {}

  Table& table;
  std::optional<ArchiveFile> file;
  std::optional<Summaries> summaries;
  OwnedValue given[std::size(arguments)];
  bool at_end = true;
};

Cursor& cursor_of(sqlite3_vtab_cursor* cursor) {
  return *static_cast<Cursor*>(cursor);
}

bool is_asked(std::uint64_t columns, Field field) {
  return (columns >> static_cast<int>(field) & 1) != 0;
}

// idxStr is a column and a comparison for each operand.
int best_index(sqlite3_vtab*, sqlite3_index_info* question) {
  std::string text;
  double rows = 1000;
  for (int i = 0; i < question->nConstraint; ++i) {
    const auto& constraint = question->aConstraint[i];
    const auto field = static_cast<Field>(constraint.iColumn);
    std::optional<Comparison> comparison;
    if (is_argument(constraint.iColumn) && constraint.op == SQLITE_INDEX_CONSTRAINT_EQ) {
      if (!constraint.usable) return SQLITE_CONSTRAINT;  // an argument cannot come later
      comparison = Comparison::equal;
    } else if (field == Field::spacecraft || field == Field::parameter || field == Field::origin) {
      comparison = text_condition(*question, i);
      if (comparison) rows /= field == Field::parameter ? 250 : 2;
    }
    if (!comparison) continue;
    text += {static_cast<char>('A' + constraint.iColumn), static_cast<char>(*comparison)};
    question->aConstraintUsage[i].argvIndex = static_cast<int>(text.size() / 2);
    question->aConstraintUsage[i].omit = 1;
  }
  question->estimatedRows = static_cast<sqlite3_int64>(30 * rows);
  question->estimatedCost = 1e6 * rows;
  question->idxNum = static_cast<int>(question->colUsed & 0x1fffff);
  question->idxStr = sqlite3_mprintf("%s", text.c_str());
  question->needToFreeIdxStr = 1;
  return question->idxStr == nullptr ? SQLITE_NOMEM : SQLITE_OK;
}

void understand_operand(SummaryRequest& request, Field field, Comparison comparison,
                        sqlite3_value* operand) {
  switch (field) {
    case Field::spacecraft:
      return narrow_text(request.selection.spacecraft, comparison, operand);
    case Field::parameter:
      return narrow_text(request.selection.parameter, comparison, operand);
    case Field::origin:
      return narrow_text(request.selection.origin, comparison, operand);
    case Field::begin_time:
      return narrow_to_argument(request.selection.time, Comparison::from, "begin_time", operand);
    case Field::end_time:
      return narrow_to_argument(request.selection.time, Comparison::below, "end_time", operand);
    case Field::quality:
      return narrow_to_quality(request.selection.quality, operand);
    case Field::step:
      request.step = step_argument(operand);
      return;
    default:
      return;
  }
}

int filter(sqlite3_vtab_cursor* base, int columns, const char* text, int operands,
           sqlite3_value** values) {
  Cursor& cursor = cursor_of(base);
  return guarded(&base->pVtab->zErrMsg, [&] {
    cursor.summaries.reset();
    cursor.at_end = true;
    for (OwnedValue& value : cursor.given) value.reset();
    SummaryRequest request;
    const auto used = static_cast<std::uint64_t>(columns);
    request.extremes = is_asked(used, Field::least) || is_asked(used, Field::greatest);
    request.values = is_asked(used, Field::mean) || is_asked(used, Field::first_value) ||
                     is_asked(used, Field::last_value);
    request.times = is_asked(used, Field::least_time) || is_asked(used, Field::greatest_time);
    request.quality = is_asked(used, Field::worst_quality);
    for (int i = 0; i < operands; ++i, text += 2) {
      const int column = text[0] - 'A';
      understand_operand(request, static_cast<Field>(column), static_cast<Comparison>(text[1]),
                         values[i]);
      if (is_argument(column)) cursor.given[column - first_argument] = duplicate(values[i]);
    }
    if (!cursor.file) cursor.file.emplace(cursor.table.connection, cursor.table.names);
    cursor.summaries.emplace(*cursor.file, std::move(request));
    cursor.at_end = !cursor.summaries->next();
  });
}

int next(sqlite3_vtab_cursor* base) {
  Cursor& cursor = cursor_of(base);
  return guarded(&base->pVtab->zErrMsg, [&] { cursor.at_end = !cursor.summaries->next(); });
}

int at_end(sqlite3_vtab_cursor* base) {
  return cursor_of(base).at_end;
}

void give_value(sqlite3_context* context, const Summary& summary, Field field) {
  if (field == Field::mean && summary.numbers > 0)
    sqlite3_result_double(context, summary.sum / static_cast<double>(summary.numbers));
  if (field == Field::least && summary.least <= summary.greatest)
    sqlite3_result_double(context, summary.least);
  if (field == Field::greatest && summary.least <= summary.greatest)
    sqlite3_result_double(context, summary.greatest);
  if (field == Field::least_time && summary.least <= summary.greatest)
    sqlite3_result_int64(context, summary.least_time);
  if (field == Field::greatest_time && summary.least <= summary.greatest)
    sqlite3_result_int64(context, summary.greatest_time);
  if (field == Field::first_value) sqlite3_result_double(context, summary.first_value);
  if (field == Field::last_value) sqlite3_result_double(context, summary.last_value);
}

void give_column(sqlite3_context* context, const Cursor& cursor, Field field) {
  const Summary& summary = cursor.summaries->summary();
  const SeriesName& series = cursor.summaries->series();
  switch (field) {
    case Field::spacecraft:
      return give(context, series.spacecraft);
    case Field::parameter:
      return give(context, series.parameter);
    case Field::origin:
      return give(context, name(series.origin));
    case Field::bucket:
      if (summary.bucket) sqlite3_result_int64(context, *summary.bucket);
      return;
    case Field::utc:
      if (summary.bucket) give_copy(context, utc_text(*summary.bucket));
      return;
    case Field::first_time:
      return sqlite3_result_int64(context, summary.first_time);
    case Field::last_time:
      return sqlite3_result_int64(context, summary.last_time);
    case Field::samples:
      return sqlite3_result_int64(context, static_cast<sqlite3_int64>(summary.samples));
    case Field::series:
      return sqlite3_result_int64(context, series.id);
    case Field::worst_quality:
      return give(context, name(summary.worst_quality));
    case Field::begin_time:
    case Field::end_time:
    case Field::step:
    case Field::quality:
      if (const auto& value = cursor.given[static_cast<int>(field) - first_argument])
        sqlite3_result_value(context, value.get());
      return;
    default:
      return give_value(context, summary, field);
  }
}

int column(sqlite3_vtab_cursor* base, sqlite3_context* context, int index) {
  return guarded(&base->pVtab->zErrMsg,
                 [&] { give_column(context, cursor_of(base), static_cast<Field>(index)); });
}

int connect(sqlite3* connection, void*, int, const char* const*, sqlite3_vtab** table,
            char** message) {
  return connect_table(connection, declaration, table, message);
}

}  // namespace
}  // namespace summary_table

int add_summary_table(sqlite3* connection) {
  using namespace summary_table;
  static const sqlite3_module module =
      table_module<Cursor>({connect, best_index, filter, next, at_end, column});
  return sqlite3_create_module(connection, "telemetry_summary", &module, nullptr);
}

}  // namespace reident::storage::sql
