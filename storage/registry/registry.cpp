#include "storage/registry/registry.hpp"

#include <algorithm>
#include <utility>

#include "storage/database/connection.hpp"
#include "storage/registry/registry_rows.hpp"

namespace reident::storage {
namespace {

std::int64_t add_attempt(sqlite::Connection& connection, const NewAttempt& attempt) {
  connection
      .query(
          "INSERT INTO attempt (spacecraft, equipment, window_begin, window_end, cause, time, "
          "outcome, reason, evidence_json, configuration_digest, program_version) "
          "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .run(attempt.spacecraft, attempt.equipment, attempt.window.begin, attempt.window.end,
           attempt.trigger, attempt.time, attempt.outcome, attempt.reason, attempt.evidence_json,
           attempt.configuration_digest, attempt.program_version);
  return connection.last_id();
}

std::int64_t add_decision(sqlite::Connection& connection, const std::string& spacecraft,
                          const std::string& equipment, std::int64_t version,
                          const NewDecision& decision, Time time) {
  connection
      .query(
          "INSERT INTO decision (spacecraft, equipment, version, kind, actor, reason, time, "
          "evidence_json) VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
      .run(spacecraft, equipment, version, name(decision.kind), decision.actor, decision.reason,
           time, decision.evidence_json);
  return connection.last_id();
}

/// Above all numbers that were ever given, and in a pair of the same parity as the term: so both
/// services never give the same one.
std::int64_t next_number(sqlite::Connection& connection, const NewAttempt& attempt) {
  sqlite::Query row = connection.query(
      "SELECT 1 + max(coalesce((SELECT max(number) FROM version "
      "                         WHERE spacecraft = ?1 AND equipment = ?2), 0), "
      "               coalesce((SELECT max(json_extract(row_json, '$.number')) FROM overruled "
      "                         WHERE kind = 'version' "
      "                           AND json_extract(row_json, '$.spacecraft') = ?1 "
      "                           AND json_extract(row_json, '$.equipment') = ?2), 0)), "
      "       (SELECT max(number) FROM term)",
      attempt.spacecraft, attempt.equipment);
  row.step();
  const std::int64_t next = row.integer(0);
  return !row.is_null(1) && (next - row.integer(1)) % 2 != 0 ? next + 1 : next;
}

bool follows(DecisionKind kind, std::string_view status) {
  switch (kind) {
    case DecisionKind::approve:
    case DecisionKind::reject:
    case DecisionKind::wait:
      return status == "waiting";
    case DecisionKind::roll_back:
      return status == "superseded";
    case DecisionKind::withdraw:
      return status == "approved" || status == "superseded";
  }
  return false;
}

/// The version, which may get a decision of this kind. Throws Error where it may not.
Version version_to_decide(const Registry& registry, const std::string& spacecraft,
                          const std::string& equipment, std::int64_t version, DecisionKind kind) {
  std::optional<Version> found = registry.version(spacecraft, equipment, version);
  if (!found)
    throw Error(Error::Kind::failed, equipment + " of " + spacecraft + " has no version " +
                                         std::to_string(version) +
                                         ": 'reident history' lists those that exist");
  if (!follows(kind, found->status))
    throw Error(Error::Kind::failed, "version " + std::to_string(version) + " of " + equipment +
                                         " of " + spacecraft + " is " + found->status +
                                         ": it cannot get a decision of kind '" +
                                         std::string(name(kind)) + "'");
  return std::move(*found);
}

}  // namespace

Registry::Registry(Database& database) : database_(database) {}

std::int64_t Registry::record(const NewAttempt& attempt) {
  return add_attempt(connection(database_), attempt);
}

std::int64_t Registry::record(const NewAttempt& attempt, const NewVersion& version,
                              const NewDecision& decision) {
  sqlite::Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  const std::int64_t id = add_attempt(db, attempt);
  const std::int64_t number = next_number(db, attempt);
  db.query(
        "INSERT INTO version (spacecraft, equipment, number, attempt, model_json, digest, "
        "provenance_json, samples_digest) VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
      .run(attempt.spacecraft, attempt.equipment, number, id, version.model_json, version.digest,
           version.provenance_json, version.samples_digest);
  add_decision(db, attempt.spacecraft, attempt.equipment, number, decision, attempt.time);
  transaction.commit();
  return number;
}

std::optional<std::int64_t> Registry::record_if(const DecisionState& state,
                                                const NewAttempt& attempt,
                                                const NewVersion& version,
                                                const NewDecision& decision) {
  sqlite::Transaction transaction(connection(database_));
  if (decision_state(attempt.spacecraft, attempt.equipment) != state) return std::nullopt;
  const std::int64_t number = record(attempt, version, decision);
  transaction.commit();
  return number;
}

std::int64_t Registry::decide(const std::string& spacecraft, const std::string& equipment,
                              std::int64_t version, const NewDecision& decision, Time time) {
  sqlite::Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  const Version found = version_to_decide(*this, spacecraft, equipment, version, decision.kind);
  std::optional<Version> previous;
  if (decision.kind == DecisionKind::withdraw && found.status == "approved")
    previous = previous_champion(spacecraft, equipment);
  const std::int64_t id = add_decision(db, spacecraft, equipment, version, decision, time);
  if (previous)
    add_decision(
        db, spacecraft, equipment, previous->number,
        {.kind = DecisionKind::roll_back,
         .actor = decision.actor,
         .reason = "version " + std::to_string(version) + " was withdrawn: " + decision.reason},
        time);
  transaction.commit();
  return id;
}

std::optional<std::int64_t> Registry::decide_if(const DecisionState& state,
                                                const std::string& spacecraft,
                                                const std::string& equipment, std::int64_t version,
                                                const NewDecision& decision, Time time) {
  sqlite::Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  if (decision_state(spacecraft, equipment) != state) return std::nullopt;
  const std::int64_t id = decide(spacecraft, equipment, version, decision, time);
  transaction.commit();
  return id;
}

std::optional<Version> Registry::version(const std::string& spacecraft,
                                         const std::string& equipment, std::int64_t number) const {
  sqlite::Query row = connection(database_).query(
      version_sql("WHERE spacecraft = ? AND equipment = ? AND version = ?"), spacecraft, equipment,
      number);
  return row.step() ? std::optional(read_version(row)) : std::nullopt;
}

// One statement, so that a reader sees one state while the writer writes.
std::optional<Decision> Registry::champion_decision(const std::string& spacecraft,
                                                    const std::string& equipment,
                                                    std::optional<Time> time) const {
  sqlite::Query row = connection(database_).query(
      decision_sql("AS made WHERE id = "
                   "(SELECT id FROM decision WHERE spacecraft = ?1 AND equipment = ?2 "
                   " AND kind IN ('approve', 'roll_back') AND (?3 IS NULL OR time <= ?3) "
                   " ORDER BY id DESC LIMIT 1) "
                   "AND NOT EXISTS "
                   "(SELECT 1 FROM decision WHERE spacecraft = ?1 AND equipment = ?2 "
                   " AND version = made.version AND kind = 'withdraw' "
                   " AND (?3 IS NULL OR time <= ?3))"),
      spacecraft, equipment, time);
  return row.step() ? std::optional(read_decision(row)) : std::nullopt;
}

std::optional<Version> Registry::champion(const std::string& spacecraft,
                                          const std::string& equipment,
                                          std::optional<Time> time) const {
  const auto made = champion_decision(spacecraft, equipment, time);
  return made ? version(spacecraft, equipment, made->version) : std::nullopt;
}

std::optional<Version> Registry::previous_champion(const std::string& spacecraft,
                                                   const std::string& equipment) const {
  std::optional<Version> found = champion(spacecraft, equipment);
  do {
    if (!found || !found->parent) return std::nullopt;
    found = version(spacecraft, equipment, *found->parent);
  } while (found && found->status == "withdrawn");
  return found;
}

std::vector<Version> Registry::champions() const {
  std::vector<Version> champions;
  sqlite::Query row = connection(database_).query(
      version_sql("WHERE status = 'approved' ORDER BY spacecraft, equipment"));
  while (row.step()) champions.push_back(read_version(row));
  return champions;
}

std::vector<VersionSummary> Registry::summaries(const std::string& spacecraft,
                                                const std::string& equipment) const {
  std::vector<VersionSummary> summaries;
  sqlite::Query row = connection(database_).query(
      "SELECT version, status, parent FROM model_version WHERE spacecraft = ? AND equipment = ? "
      "ORDER BY version",
      spacecraft, equipment);
  while (row.step())
    summaries.push_back({row.integer(0), row.text(1),
                         row.is_null(2) ? std::nullopt : std::optional(row.integer(2))});
  return summaries;
}

std::vector<std::int64_t> Registry::waiting(const std::string& spacecraft,
                                            const std::string& equipment,
                                            const std::string& outcome, std::int64_t after) const {
  std::vector<std::int64_t> numbers;
  sqlite::Query row = connection(database_).query(
      "SELECT DISTINCT own.version FROM decision AS own "
      "JOIN version ON version.spacecraft = ?1 AND version.equipment = ?2 "
      "            AND version.number = own.version "
      "JOIN attempt ON attempt.id = version.attempt "
      "WHERE own.spacecraft = ?1 AND own.equipment = ?2 AND own.kind = 'wait' AND own.id > ?4 "
      "AND outcome = ?3 "
      "AND NOT EXISTS (SELECT 1 FROM decision AS other "
      "                WHERE other.spacecraft = ?1 AND other.equipment = ?2 "
      "                AND other.version = own.version AND other.kind <> 'wait') "
      "ORDER BY own.version",
      spacecraft, equipment, outcome, after);
  while (row.step()) numbers.push_back(row.integer(0));
  return numbers;
}

std::vector<Decision> Registry::waits() const {
  constexpr std::string_view is_last =
      "NOT EXISTS (SELECT 1 FROM decision AS later WHERE later.spacecraft = own.spacecraft "
      "AND later.equipment = own.equipment AND later.version = own.version AND later.id > own.id)";
  std::vector<Decision> decisions;
  sqlite::Query row = connection(database_).query(
      decision_sql("WHERE id IN (SELECT own.id FROM decision AS own WHERE kind = 'wait' AND "
                   "evidence_json <> '' AND " +
                   std::string(is_last) +
                   " UNION SELECT own.id FROM attempt JOIN version ON version.attempt = attempt.id "
                   "JOIN decision AS own ON own.spacecraft = attempt.spacecraft "
                   " AND own.equipment = attempt.equipment AND own.version = version.number "
                   "WHERE outcome IN ('waiting', 'unvouched', 'held') AND kind = 'wait' AND " +
                   std::string(is_last) + ") ORDER BY spacecraft, equipment, version"));
  while (row.step()) decisions.push_back(read_decision(row));
  return decisions;
}

std::vector<TimeRange> Registry::windows(const std::string& spacecraft,
                                         const std::string& equipment,
                                         const std::string& outcome) const {
  std::vector<TimeRange> windows;
  sqlite::Query row = connection(database_).query(
      "SELECT window_begin, window_end FROM attempt JOIN version ON version.attempt = attempt.id "
      "WHERE attempt.spacecraft = ? AND attempt.equipment = ? AND outcome = ? ORDER BY attempt.id",
      spacecraft, equipment, outcome);
  while (row.step()) windows.push_back({row.integer(0), row.integer(1)});
  return windows;
}

std::vector<Decision> Registry::decisions(const std::string& spacecraft,
                                          const std::string& equipment,
                                          std::optional<std::int64_t> version) const {
  std::vector<Decision> decisions;
  sqlite::Query row = connection(database_).query(
      decision_sql("WHERE spacecraft = ?1 AND equipment = ?2 AND (?3 IS NULL OR version = ?3) "
                   "ORDER BY id"),
      spacecraft, equipment, version);
  while (row.step()) decisions.push_back(read_decision(row));
  return decisions;
}

std::vector<EquipmentName> Registry::equipment() const {
  std::vector<EquipmentName> names;
  sqlite::Query row = connection(database_).query(
      "SELECT DISTINCT spacecraft, equipment FROM attempt ORDER BY spacecraft, equipment");
  while (row.step()) names.push_back({row.text(0), row.text(1)});
  return names;
}

Registry::Counts Registry::counts(const EquipmentName& equipment) const {
  sqlite::Query row = connection(database_).query(
      "SELECT (SELECT count(*) FROM attempt WHERE spacecraft = ?1 AND equipment = ?2), "
      "(SELECT count(*) FROM version WHERE spacecraft = ?1 AND equipment = ?2), "
      "(SELECT count(*) FROM decision WHERE spacecraft = ?1 AND equipment = ?2 "
      " AND kind IN ('approve', 'roll_back') AND kind = 'approve')",
      equipment.spacecraft, equipment.equipment);
  row.step();
  return {row.integer(0), row.integer(1), row.integer(2)};
}

std::int64_t Registry::last_decision() const {
  sqlite::Query row = connection(database_).query("SELECT coalesce(max(id), 0) FROM decision");
  row.step();
  return row.integer(0);
}

DecisionState Registry::decision_state(const std::string& spacecraft,
                                       const std::string& equipment) const {
  sqlite::Query row = connection(database_).query(
      "SELECT (SELECT coalesce(max(id), 0) FROM decision "
      "        WHERE spacecraft = ?1 AND equipment = ?2), "
      "       (SELECT coalesce(max(id), 0) FROM hold WHERE spacecraft = ?1 AND equipment = ?2)",
      spacecraft, equipment);
  row.step();
  return {row.integer(0), row.integer(1)};
}

std::optional<Attempt> Registry::attempt(std::int64_t id) const {
  sqlite::Query row = connection(database_).query(attempt_sql("WHERE attempt.id = ?"), id);
  return row.step() ? std::optional(read_attempt(row)) : std::nullopt;
}

std::vector<Attempt> Registry::attempts(const HistoryFilter& filter) const {
  std::vector<Attempt> attempts;
  std::optional<Time> begin, end;
  if (filter.window) begin = filter.window->begin, end = filter.window->end;
  sqlite::Query row = connection(database_).query(
      attempt_sql(
          "WHERE (?1 = '' OR attempt.spacecraft = ?1) AND (?2 = '' OR attempt.equipment = ?2) "
          "AND (?3 IS NULL OR (window_begin < ?4 AND window_end > ?3)) "
          "AND (NOT ?5 OR number IS NOT NULL) ORDER BY attempt.id DESC LIMIT ?6"),
      filter.spacecraft, filter.equipment, begin, end, filter.versions_only,
      filter.last ? static_cast<std::int64_t>(*filter.last) : -1);
  while (row.step()) attempts.push_back(read_attempt(row));
  std::reverse(attempts.begin(), attempts.end());
  return attempts;
}

std::optional<Time> Registry::last_window_end(const std::string& spacecraft,
                                              const std::string& equipment) const {
  sqlite::Query row = connection(database_).query(
      "SELECT max(window_end) FROM attempt WHERE spacecraft = ? AND equipment = ?", spacecraft,
      equipment);
  return row.step() && !row.is_null(0) ? std::optional(row.integer(0)) : std::nullopt;
}

}  // namespace reident::storage
