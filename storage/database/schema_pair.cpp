// Tables of what the services of a pair share, and triggers that guard rows or note them in the
// journal.
#include "storage/database/schema.hpp"

namespace reident::storage::schema {
namespace {

// What two services of a pair share (storage/types/journal.hpp). Without a pair all three are
// empty.
constexpr std::string_view pair_tables = R"sql(
CREATE TABLE term (
  number INTEGER PRIMARY KEY, service TEXT NOT NULL, time INTEGER NOT NULL,
  first INTEGER NOT NULL UNIQUE);

CREATE TABLE journal (id INTEGER PRIMARY KEY, kind TEXT NOT NULL, key TEXT NOT NULL);

CREATE TABLE overruled (
  term INTEGER NOT NULL, position INTEGER NOT NULL, service TEXT NOT NULL, kind TEXT NOT NULL,
  row_json TEXT NOT NULL, time INTEGER NOT NULL,
  PRIMARY KEY (term, position)) WITHOUT ROWID;

CREATE VIEW overruled_decision AS
  SELECT term, service, json_extract(row_json, '$.spacecraft') AS spacecraft,
         json_extract(row_json, '$.equipment') AS equipment,
         json_extract(row_json, '$.version') AS version, json_extract(row_json, '$.kind') AS kind,
         json_extract(row_json, '$.actor') AS actor, json_extract(row_json, '$.reason') AS reason,
         json_extract(row_json, '$.time') AS time, time AS overruled
  FROM overruled WHERE kind = 'decision';
)sql";

std::string journal_triggers() {
  std::string sql;
  for (const JournalledTable& table : journalled_tables) {
    const std::string name(table.name);
    sql += "CREATE TRIGGER " + name + "_journal AFTER INSERT ON " + name +
           " WHEN EXISTS (SELECT 1 FROM term) BEGIN INSERT INTO journal (kind, key) VALUES ('" +
           name + "', " + key_sql(table, "NEW.") + "); END;\n";
  }
  return sql;
}

}  // namespace

std::string guard(const std::string& table, const std::string& event,
                  const std::string& condition) {
  return "CREATE TRIGGER " + table + "_" + event + " BEFORE " + event + " ON " + table + " " +
         condition + " BEGIN SELECT RAISE(ABORT, 'rows of the table " + table +
         " are never changed or removed: add a new one'); END;\n";
}

std::string key_sql(const JournalledTable& table, const std::string& prefix) {
  std::string columns;
  for (const std::string_view column : table.key)
    if (!column.empty()) columns += (columns.empty() ? "" : ", ") + prefix + std::string(column);
  return "json_array(" + columns + ")";
}

std::string from_8_to_9() {
  return std::string(pair_tables) + journal_triggers();
}

std::string without_removal_guards() {
  std::string sql;
  for (const JournalledTable& table : journalled_tables)
    if (table.name != "term") sql += "DROP TRIGGER " + std::string(table.name) + "_delete;\n";
  return sql;
}

std::string removal_guards() {
  std::string sql;
  for (const JournalledTable& table : journalled_tables)
    if (table.name != "term") sql += guard(std::string(table.name), "delete", "");
  return sql;
}

}  // namespace reident::storage::schema
