#include "storage/database/schema.hpp"

#include <initializer_list>
#include <string_view>

#include "storage/database/schema_views.hpp"

namespace reident::storage::schema {
namespace {

// Limits and bounds have no declared type: a column of type REAL would turn -0.0 into 0.
constexpr std::string_view telemetry_tables = R"sql(
CREATE TABLE parameter (
  spacecraft TEXT NOT NULL, id INTEGER NOT NULL, name TEXT NOT NULL, unit TEXT NOT NULL,
  description TEXT NOT NULL, kind TEXT NOT NULL CHECK (kind IN ('analog', 'digital')),
  low_limit, high_limit,
  PRIMARY KEY (spacecraft, id)) WITHOUT ROWID;
CREATE INDEX parameter_by_name ON parameter (spacecraft, name, id);

CREATE TABLE source (
  id INTEGER PRIMARY KEY,
  spacecraft TEXT NOT NULL, name TEXT NOT NULL, origin INTEGER NOT NULL CHECK (origin IN (0, 1)),
  frames INTEGER NOT NULL DEFAULT 0, samples INTEGER NOT NULL DEFAULT 0,
  duplicates INTEGER NOT NULL DEFAULT 0, conflicts INTEGER NOT NULL DEFAULT 0,
  late INTEGER NOT NULL DEFAULT 0, non_finite INTEGER NOT NULL DEFAULT 0,
  out_of_order INTEGER NOT NULL DEFAULT 0, restarts INTEGER NOT NULL DEFAULT 0,
  missing INTEGER NOT NULL DEFAULT 0,
  lowest_sequence INTEGER NOT NULL DEFAULT 0, lowest_time INTEGER NOT NULL DEFAULT 0,
  highest_sequence INTEGER NOT NULL DEFAULT 0, highest_time INTEGER NOT NULL DEFAULT 0,
  UNIQUE (spacecraft, name, origin));

CREATE TABLE sequence_gap (
  source INTEGER NOT NULL REFERENCES source, run INTEGER NOT NULL,
  first INTEGER NOT NULL, last INTEGER NOT NULL,
  time_before INTEGER NOT NULL, time_after INTEGER NOT NULL,
  PRIMARY KEY (source, run, first), CHECK (first <= last)) WITHOUT ROWID;

CREATE TABLE series (
  id INTEGER PRIMARY KEY,
  spacecraft TEXT NOT NULL, origin INTEGER NOT NULL CHECK (origin IN (0, 1)),
  parameter INTEGER NOT NULL,
  samples INTEGER NOT NULL DEFAULT 0, first_time INTEGER, last_time INTEGER,
  moved INTEGER NOT NULL DEFAULT 0,
  UNIQUE (spacecraft, origin, parameter));
)sql";

constexpr std::string_view sample_tables = R"sql(
CREATE TABLE recent (
  batch INTEGER NOT NULL, series INTEGER NOT NULL REFERENCES series,
  samples INTEGER NOT NULL, first_time INTEGER NOT NULL, last_time INTEGER NOT NULL,
  data BLOB NOT NULL,
  PRIMARY KEY (batch, series)) WITHOUT ROWID;

CREATE TABLE chunk_data (id INTEGER PRIMARY KEY, bytes BLOB NOT NULL);

-- Data is the id of a chunk_data, in the shard or (0) in this file. Declared as a reference it
-- would cost a scan of this table for each chunk that is rewritten.
CREATE TABLE chunk (
  series INTEGER NOT NULL REFERENCES series, first_time INTEGER NOT NULL,
  last_time INTEGER NOT NULL, samples INTEGER NOT NULL,
  step INTEGER NOT NULL, gap_limit INTEGER NOT NULL, least, greatest,
  data INTEGER NOT NULL, shard INTEGER NOT NULL DEFAULT 0,
  PRIMARY KEY (series, first_time)) WITHOUT ROWID;

CREATE TABLE sample_gap (
  series INTEGER NOT NULL REFERENCES series,
  begin_time INTEGER NOT NULL, end_time INTEGER NOT NULL,
  PRIMARY KEY (series, begin_time)) WITHOUT ROWID;

CREATE TABLE revision (
  series INTEGER NOT NULL REFERENCES series, batch INTEGER NOT NULL,
  first_time INTEGER NOT NULL, last_time INTEGER NOT NULL,
  landed BLOB, replaced BLOB,
  PRIMARY KEY (series, batch)) WITHOUT ROWID;

CREATE TABLE removal (
  id INTEGER PRIMARY KEY,
  series INTEGER NOT NULL REFERENCES series,
  begin_time INTEGER NOT NULL, end_time INTEGER NOT NULL, samples INTEGER NOT NULL,
  cause TEXT NOT NULL, time INTEGER NOT NULL);
CREATE INDEX removal_by_series ON removal (series, cause);

CREATE TABLE damaged_chunk (
  id INTEGER PRIMARY KEY,
  series INTEGER NOT NULL REFERENCES series,
  first_time INTEGER NOT NULL, last_time INTEGER NOT NULL, samples INTEGER NOT NULL,
  bytes BLOB NOT NULL, reason TEXT NOT NULL, time INTEGER NOT NULL);
)sql";

constexpr std::string_view late_tables = R"sql(
CREATE TABLE seal (spacecraft TEXT PRIMARY KEY, until INTEGER NOT NULL) WITHOUT ROWID;

CREATE TABLE late_range (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  series INTEGER NOT NULL REFERENCES series,
  begin_time INTEGER NOT NULL, end_time INTEGER NOT NULL);
CREATE INDEX late_range_by_time ON late_range (series, begin_time);
)sql";

constexpr std::string_view import_table = R"sql(
CREATE TABLE import (
  id INTEGER PRIMARY KEY,
  file TEXT NOT NULL, request TEXT NOT NULL, started INTEGER NOT NULL, finished INTEGER,
  position INTEGER NOT NULL DEFAULT 0, line INTEGER NOT NULL DEFAULT 1,
  digest TEXT NOT NULL DEFAULT '',
  rows INTEGER NOT NULL DEFAULT 0, bad_lines INTEGER NOT NULL DEFAULT 0,
  samples INTEGER NOT NULL DEFAULT 0, stored INTEGER NOT NULL DEFAULT 0,
  duplicates INTEGER NOT NULL DEFAULT 0, conflicts INTEGER NOT NULL DEFAULT 0);
CREATE INDEX import_unfinished ON import (request) WHERE finished IS NULL;
)sql";

constexpr std::string_view registry_tables = R"sql(
CREATE TABLE attempt (
  id INTEGER PRIMARY KEY,
  spacecraft TEXT NOT NULL, equipment TEXT NOT NULL,
  window_begin INTEGER NOT NULL, window_end INTEGER NOT NULL,
  cause TEXT NOT NULL, time INTEGER NOT NULL, outcome TEXT NOT NULL, reason TEXT NOT NULL,
  evidence_json TEXT NOT NULL, configuration_digest TEXT NOT NULL, program_version TEXT NOT NULL);
CREATE INDEX attempt_by_window ON attempt (spacecraft, equipment, window_end);

CREATE TABLE version (
  spacecraft TEXT NOT NULL, equipment TEXT NOT NULL, number INTEGER NOT NULL,
  attempt INTEGER NOT NULL UNIQUE REFERENCES attempt,
  model_json TEXT NOT NULL, digest TEXT NOT NULL,
  provenance_json TEXT NOT NULL DEFAULT '', samples_digest TEXT NOT NULL DEFAULT '',
  PRIMARY KEY (spacecraft, equipment, number));
)sql";

constexpr std::string_view decision_table = R"sql(
CREATE TABLE decision (
  id INTEGER PRIMARY KEY,
  spacecraft TEXT NOT NULL, equipment TEXT NOT NULL, version INTEGER NOT NULL,
  kind TEXT NOT NULL CHECK (kind IN ('approve', 'reject', 'wait', 'roll_back', 'withdraw')),
  actor TEXT NOT NULL, reason TEXT NOT NULL, time INTEGER NOT NULL,
  FOREIGN KEY (spacecraft, equipment, version) REFERENCES version (spacecraft, equipment, number));
CREATE INDEX decision_by_version ON decision (spacecraft, equipment, version);
CREATE INDEX decision_for_champion ON decision (spacecraft, equipment)
  WHERE kind IN ('approve', 'roll_back');
)sql";

constexpr std::string_view decision_of_4 = R"sql(
ALTER TABLE decision ADD COLUMN evidence_json TEXT NOT NULL DEFAULT '';
CREATE INDEX decision_to_wait ON decision (spacecraft, equipment, version) WHERE kind = 'wait';
)sql";

// Lists are blobs of little-endian doubles, an entry an output or an input, so that no bit is lost.
constexpr std::string_view score_tables = R"sql(
CREATE TABLE block (
  spacecraft TEXT NOT NULL, equipment TEXT NOT NULL,
  begin_time INTEGER NOT NULL, end_time INTEGER NOT NULL,
  rows INTEGER NOT NULL, believed REAL NOT NULL,
  output_mean BLOB NOT NULL, output_square BLOB NOT NULL,
  input_low BLOB NOT NULL, input_high BLOB NOT NULL, baseline_square BLOB NOT NULL,
  PRIMARY KEY (spacecraft, equipment, begin_time)) WITHOUT ROWID;

CREATE TABLE score (
  spacecraft TEXT NOT NULL, equipment TEXT NOT NULL, version INTEGER NOT NULL,
  begin_time INTEGER NOT NULL, rows INTEGER NOT NULL,
  error_mean BLOB NOT NULL, error_square BLOB NOT NULL, noise_square BLOB NOT NULL,
  state BLOB NOT NULL, state_tick INTEGER, run_square BLOB NOT NULL, run_rows INTEGER NOT NULL, bias_effects BLOB NOT NULL DEFAULT x'',
  PRIMARY KEY (spacecraft, equipment, version, begin_time),
  FOREIGN KEY (spacecraft, equipment, version) REFERENCES version (spacecraft, equipment, number))
  WITHOUT ROWID;
)sql";

constexpr std::string_view operator_tables = R"sql(
CREATE TABLE hold (
  id INTEGER PRIMARY KEY,
  spacecraft TEXT NOT NULL, equipment TEXT NOT NULL,
  kind TEXT NOT NULL CHECK (kind IN ('hold', 'release')),
  actor TEXT NOT NULL, reason TEXT NOT NULL, time INTEGER NOT NULL);
CREATE INDEX hold_by_equipment ON hold (spacecraft, equipment);

CREATE TABLE command (
  id INTEGER PRIMARY KEY,
  requester TEXT NOT NULL, request INTEGER NOT NULL,
  action TEXT NOT NULL, spacecraft TEXT NOT NULL, equipment TEXT NOT NULL,
  version INTEGER NOT NULL, actor TEXT NOT NULL, reason TEXT NOT NULL, time INTEGER NOT NULL,
  ok INTEGER NOT NULL CHECK (ok IN (0, 1)), reply TEXT NOT NULL,
  UNIQUE (requester, request));
)sql";

// What the service noticed. A row is a change of what it says, so that the last row of a key is how
// things are.
constexpr std::string_view notice_tables = R"sql(
CREATE TABLE alarm (
  id INTEGER PRIMARY KEY,
  code TEXT NOT NULL, spacecraft TEXT NOT NULL, equipment TEXT NOT NULL,
  kind TEXT NOT NULL CHECK (kind IN ('raise', 'clear', 'acknowledge')),
  actor TEXT NOT NULL, text TEXT NOT NULL, time INTEGER NOT NULL);
CREATE INDEX alarm_by_code ON alarm (code, spacecraft, equipment);

CREATE TABLE change (
  id INTEGER PRIMARY KEY,
  spacecraft TEXT NOT NULL, equipment TEXT NOT NULL, champion INTEGER NOT NULL,
  since INTEGER NOT NULL, found INTEGER NOT NULL, time INTEGER NOT NULL,
  FOREIGN KEY (spacecraft, equipment, champion) REFERENCES version (spacecraft, equipment, number));
CREATE INDEX change_by_equipment ON change (spacecraft, equipment);

CREATE TABLE simulator (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL, spacecraft TEXT NOT NULL, equipment TEXT NOT NULL,
  is_there INTEGER NOT NULL CHECK (is_there IN (0, 1)),
  version INTEGER NOT NULL, offered INTEGER NOT NULL,
  refused INTEGER NOT NULL, reason TEXT NOT NULL,
  mode TEXT NOT NULL, from_cache INTEGER NOT NULL CHECK (from_cache IN (0, 1)),
  since INTEGER NOT NULL, error_before, host TEXT NOT NULL, process INTEGER NOT NULL,
  program_version TEXT NOT NULL, time INTEGER NOT NULL);
CREATE INDEX simulator_by_name ON simulator (name, spacecraft, equipment);

-- Few of the many waits are for an operator; the outcomes are those of programs before version 0.2.
CREATE INDEX decision_with_why ON decision (spacecraft, equipment, version)
  WHERE kind = 'wait' AND evidence_json <> '';
CREATE INDEX attempt_left_waiting ON attempt (id) WHERE outcome IN ('waiting', 'unvouched', 'held');
)sql";

// The insert trigger stops INSERT OR REPLACE, which deletes without asking the delete trigger.
std::string append_only(const std::string& table, const std::string& same_row) {
  return guard(table, "update", "") + guard(table, "delete", "") +
         guard(table, "insert", "WHEN EXISTS (SELECT 1 FROM " + table + " WHERE " + same_row + ")");
}

std::string append_only_decisions() {
  return append_only("decision", "id = NEW.id") + append_only("hold", "id = NEW.id") +
         append_only("command",
                     "id = NEW.id OR (requester = NEW.requester AND request = NEW.request)");
}

std::string append_only_scores() {
  const std::string equipment = "spacecraft = NEW.spacecraft AND equipment = NEW.equipment AND ";
  return append_only("block", equipment + "begin_time = NEW.begin_time") +
         append_only("score", equipment + "version = NEW.version AND begin_time = NEW.begin_time");
}

std::string append_only_notices() {
  return append_only("alarm", "id = NEW.id") + append_only("change", "id = NEW.id") +
         append_only("simulator", "id = NEW.id");
}

std::string joined(std::initializer_list<std::string_view> parts) {
  std::string sql;
  for (const std::string_view part : parts) sql += part;
  return sql;
}

}  // namespace

std::string creation() {
  return joined({telemetry_tables, sample_tables, late_tables, import_table, registry_tables,
                 decision_table, decision_of_4, score_tables, operator_tables, notice_tables,
                 series_view, telemetry_views, hole_view, removal_view, lineage_view,
                 registry_views, reason_view, notice_views}) +
         append_only("attempt", "id = NEW.id") +
         append_only("version",
                     "attempt = NEW.attempt OR (spacecraft = NEW.spacecraft AND "
                     "equipment = NEW.equipment AND number = NEW.number)") +
         append_only_decisions() + append_only_scores() + append_only_notices() + from_7_to_8() +
         shards_of_9() + "PRAGMA application_id = " + std::to_string(application_id) + ";" +
         user_version();
}

// A CHECK cannot be altered, so the decisions move to a new table. Dropping the old one drops its
// triggers; indexes go first because their names are taken again.
std::string from_1_to_2() {
  constexpr std::string_view before = R"sql(
DROP VIEW model_version;
DROP VIEW champion;
DROP VIEW history;
ALTER TABLE version ADD COLUMN provenance_json TEXT NOT NULL DEFAULT '';
ALTER TABLE version ADD COLUMN samples_digest TEXT NOT NULL DEFAULT '';
DROP INDEX decision_by_version;
DROP INDEX decision_for_champion;
ALTER TABLE decision RENAME TO decision_of_1;
)sql";
  constexpr std::string_view move = R"sql(
INSERT INTO decision (id, spacecraft, equipment, version, kind, actor, reason, time)
  SELECT id, spacecraft, equipment, version, kind, actor, reason, time FROM decision_of_1
  ORDER BY id;
DROP TABLE decision_of_1;
)sql";
  return joined({before, decision_table, move, operator_tables, lineage_view, registry_views}) +
         append_only_decisions();
}

std::string from_2_to_3() {
  constexpr std::string_view before = R"sql(
DROP VIEW telemetry;
ALTER TABLE series ADD COLUMN moved INTEGER NOT NULL DEFAULT 0;
)sql";
  return joined({before, sample_tables, import_table, hole_view, removal_view});
}

std::string without_samples_of_2() {
  return "DROP TABLE sample;";
}

std::string from_3_to_4() {
  return joined({"DROP VIEW lineage;", lineage_view, decision_of_4});
}

std::string from_5_to_6() {
  return joined({score_tables, reason_view}) + append_only_scores();
}

std::string from_6_to_7() {
  return joined({notice_tables, notice_views}) + append_only_notices();
}

std::string bias_effects_of_8() {
  return "ALTER TABLE score ADD COLUMN bias_effects BLOB NOT NULL DEFAULT x'';";
}

std::string shards_of_9() {
  return R"sql(
CREATE TABLE shard (
  id INTEGER PRIMARY KEY AUTOINCREMENT, file TEXT NOT NULL UNIQUE,
  first_time INTEGER NOT NULL, last_time INTEGER NOT NULL,
  chunks INTEGER NOT NULL, all_chunks INTEGER NOT NULL, bytes INTEGER NOT NULL);
)sql";
}

std::string chunks_of_9() {
  return "ALTER TABLE chunk ADD COLUMN shard INTEGER NOT NULL DEFAULT 0;";
}

std::string series_view_of_10() {
  return joined({"DROP VIEW telemetry_series;", series_view});
}

std::string user_version() {
  return "PRAGMA user_version = " + std::to_string(version) + ";";
}

}  // namespace reident::storage::schema
