#include "storage/registry/registry_rows.hpp"

#include <limits>

#include "storage/database/connection.hpp"

namespace reident::storage {
namespace {

DecisionKind known_kind(const std::string& text) {
  if (const auto kind = decision_kind(text)) return *kind;
  throw Error(Error::Kind::corrupt,
              "a decision has the unknown kind '" + text + "': restore the database from a backup");
}

/// Where a table keeps what a RowFilter selects by.
struct Columns {
  std::string id, spacecraft, equipment, version, begins_before, ends_after;
};

/// Conditions and order; only those that are asked for, so that an index can serve them.
std::string selection_sql(const RowFilter& filter, const Columns& columns) {
  std::string sql = "WHERE " + columns.id + (filter.newest_first ? " < ?1" : " > ?1");
  if (!filter.spacecraft.empty()) sql += " AND " + columns.spacecraft + " = ?2";
  if (!filter.equipment.empty()) sql += " AND " + columns.equipment + " = ?3";
  if (filter.version) sql += " AND " + columns.version + " = ?4";
  if (filter.range) sql += " AND " + columns.begins_before + " < ?6 AND " + columns.ends_after;
  // Names the last parameter, so that all of them can be bound.
  return sql + " AND (?6 IS NULL OR 1) ORDER BY " + columns.id +
         (filter.newest_first ? " DESC" : "");
}

template <typename Row, typename Read>
void each_row(Database& database, const std::string& sql, const RowFilter& filter, const Read& read,
              const std::function<bool(Row&&)>& visit) {
  using Limits = std::numeric_limits<std::int64_t>;
  std::optional<Time> begin, end;
  if (filter.range) begin = filter.range->begin, end = filter.range->end;
  sqlite::Query row = database.impl().connection->query(
      sql, filter.beyond.value_or(filter.newest_first ? Limits::max() : Limits::min()),
      filter.spacecraft, filter.equipment, filter.version, begin, end);
  while (row.step())
    if (!visit(read(row))) return;
}

}  // namespace

std::string version_sql(std::string_view rest) {
  return "SELECT spacecraft, equipment, version, attempt, window_begin, window_end, created, "
         "model_json, digest, status, parent, provenance_json, samples_digest FROM model_version " +
         std::string(rest);
}

Version read_version(const sqlite::Query& row) {
  return {.spacecraft = row.text(0),
          .equipment = row.text(1),
          .number = row.integer(2),
          .attempt = row.integer(3),
          .window = {row.integer(4), row.integer(5)},
          .created = row.integer(6),
          .model_json = row.text(7),
          .digest = row.text(8),
          .status = row.text(9),
          .parent = row.is_null(10) ? std::nullopt : std::optional(row.integer(10)),
          .provenance_json = row.text(11),
          .samples_digest = row.text(12)};
}

std::string decision_sql(std::string_view rest) {
  return "SELECT id, spacecraft, equipment, version, kind, actor, reason, time, evidence_json "
         "FROM decision " +
         std::string(rest);
}

Decision read_decision(const sqlite::Query& row) {
  Decision decision;
  decision.id = row.integer(0);
  decision.spacecraft = row.text(1);
  decision.equipment = row.text(2);
  decision.version = row.integer(3);
  decision.kind = known_kind(row.text(4));
  decision.actor = row.text(5);
  decision.reason = row.text(6);
  decision.time = row.integer(7);
  decision.evidence_json = row.text(8);
  return decision;
}

std::string attempt_sql(std::string_view rest) {
  return "SELECT attempt.id, attempt.spacecraft, attempt.equipment, window_begin, window_end, "
         "cause, time, outcome, reason, evidence_json, configuration_digest, program_version, "
         "number FROM attempt LEFT JOIN version ON version.attempt = attempt.id " +
         std::string(rest);
}

Attempt read_attempt(const sqlite::Query& row) {
  Attempt attempt;
  attempt.id = row.integer(0);
  attempt.spacecraft = row.text(1);
  attempt.equipment = row.text(2);
  attempt.window = {row.integer(3), row.integer(4)};
  attempt.trigger = row.text(5);
  attempt.time = row.integer(6);
  attempt.outcome = row.text(7);
  attempt.reason = row.text(8);
  attempt.evidence_json = row.text(9);
  attempt.configuration_digest = row.text(10);
  attempt.program_version = row.text(11);
  if (!row.is_null(12)) attempt.version = row.integer(12);
  return attempt;
}

void Registry::each_attempt(const RowFilter& filter,
                            const std::function<bool(Attempt&&)>& visit) const {
  static const Columns columns{"attempt.id", "attempt.spacecraft", "attempt.equipment",
                               "number",     "window_begin",       "window_end > ?5"};
  each_row<Attempt>(database_, attempt_sql(selection_sql(filter, columns)), filter, read_attempt,
                    visit);
}

void Registry::each_version(const RowFilter& filter,
                            const std::function<bool(Version&&)>& visit) const {
  static const Columns columns{"attempt", "spacecraft",   "equipment",
                               "version", "window_begin", "window_end > ?5"};
  each_row<Version>(database_, version_sql(selection_sql(filter, columns)), filter, read_version,
                    visit);
}

void Registry::each_decision(const RowFilter& filter,
                             const std::function<bool(Decision&&)>& visit) const {
  static const Columns columns{"id", "spacecraft", "equipment", "version", "time", "time >= ?5"};
  each_row<Decision>(database_, decision_sql(selection_sql(filter, columns)), filter, read_decision,
                     visit);
}

}  // namespace reident::storage
