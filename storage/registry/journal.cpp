#include "storage/registry/journal.hpp"

#include <algorithm>

#include "storage/database/connection.hpp"
#include "storage/database/schema.hpp"
#include "storage/registry/journal_rows.hpp"

namespace reident::storage {
namespace {

using schema::JournalledTable;
using sqlite::Connection;

constexpr std::string_view overruled_table = "overruled";
constexpr std::size_t part_bytes = std::size_t{1} << 20;

const JournalledTable* table_of(std::string_view name) {
  const auto found =
      std::find_if(schema::journalled_tables.begin(), schema::journalled_tables.end(),
                   [&](const JournalledTable& one) { return one.name == name; });
  return found == schema::journalled_tables.end() ? nullptr : &*found;
}

/// The condition that selects the row whose key is the parameter.
std::string row_condition(std::string_view table) {
  const JournalledTable* journalled = table_of(table);
  if (!journalled)  // the table of those that are not in the journal by a trigger
    return " WHERE term = json_extract(?1, '$[0]') AND position = json_extract(?1, '$[1]')";
  std::string sql;
  for (std::size_t i = 0; i < journalled->key.size() && !journalled->key[i].empty(); ++i)
    sql += (i == 0 ? " WHERE " : " AND ") + std::string(journalled->key[i]) +
           " = json_extract(?1, '$[" + std::to_string(i) + "]')";
  return sql;
}

JournalRow read_row(Connection& connection, const std::string& table, const std::string& key) {
  sqlite::Query row = connection.query("SELECT * FROM " + table + row_condition(table), key);
  if (!row.step())
    throw Error(Error::Kind::corrupt, "the journal names a row of " + table +
                                          " that is not there (" + key +
                                          "): restore the database from a backup");
  JournalRow read{table, {}};
  for (int column = 0; column < row.columns(); ++column) read.values.push_back(row.value(column));
  return read;
}

std::vector<std::string> columns_of(Connection& connection, const std::string& table) {
  std::vector<std::string> names;
  sqlite::Query row = connection.query("SELECT name FROM pragma_table_info(?) ORDER BY cid", table);
  while (row.step()) names.push_back(row.text(0));
  return names;
}

void insert_row(Connection& connection, const JournalRow& row) {
  const bool may_be_there = row.table == overruled_table;
  if ((!may_be_there && !table_of(row.table)) ||
      columns_of(connection, row.table).size() != row.values.size())
    throw Error(Error::Kind::failed,
                "rows of the table '" + row.table + "' with " + std::to_string(row.values.size()) +
                    " columns are of another program: both services of a pair have to be of one "
                    "version");
  std::string marks;
  for (std::size_t i = 0; i < row.values.size(); ++i) marks += i == 0 ? "?" : ", ?";
  connection
      .query("INSERT " + std::string(may_be_there ? "OR REPLACE " : "") + "INTO " + row.table +
             " VALUES (" + marks + ")")
      .run(row.values);
}

std::int64_t integer_in(const JournalRow& row, std::size_t column) {
  if (const auto* integer = std::get_if<std::int64_t>(&row.values[column])) return *integer;
  throw Error(Error::Kind::corrupt, "a row of the table '" + row.table +
                                        "' has no whole number in column " +
                                        std::to_string(column + 1) +
                                        ": both services of a pair have to be of one version");
}

/// What people and programs read of a row that was overruled.
void insert_overruled(Connection& connection, const JournalRow& row, std::int64_t term,
                      std::int64_t position, const std::string& service, Time now) {
  const std::vector<std::string> names = columns_of(connection, row.table);
  if (names.size() != row.values.size())
    throw Error(Error::Kind::failed, "an overruled row of '" + row.table +
                                         "' has other columns: both services of a pair have to be "
                                         "of one version");
  std::vector<sqlite::Value> values{term, position, service, row.table, now};
  std::string members;
  for (std::size_t i = 0; i < names.size(); ++i) {
    values.push_back(row.values[i]);
    const std::string mark = "?" + std::to_string(values.size());
    const bool is_blob = std::holds_alternative<std::vector<std::uint8_t>>(row.values[i]);
    members += (i == 0 ? "'" : ", '") + names[i] + "', " + (is_blob ? "hex(" + mark + ")" : mark);
  }
  connection
      .query(
          "INSERT OR IGNORE INTO overruled (term, position, service, kind, row_json, time) "
          "VALUES (?1, ?2, ?3, ?4, json_object(" +
          members + "), ?5)")
      .run(values);
}

bool is_overruled(Connection& connection, std::int64_t term, std::int64_t position) {
  sqlite::Query row =
      connection.query("SELECT 1 FROM overruled WHERE term = ? AND position = ?", term, position);
  return row.step();
}

/// The term of each row in turn: rows of the table `term` begin one.
class TermOfRow {
 public:
  TermOfRow(std::int64_t number, std::string service)
      : number_(number), service_(std::move(service)) {}
  void meet(const JournalRow& row) {
    if (row.table != "term" || row.values.size() < 2) return;
    if (const auto* number = std::get_if<std::int64_t>(&row.values[0])) number_ = *number;
    if (const auto* service = std::get_if<std::string>(&row.values[1])) service_ = *service;
  }
  std::int64_t number() const { return number_; }
  const std::string& service() const { return service_; }

 private:
  std::int64_t number_;
  std::string service_;
};

}  // namespace

Journal::Journal(Database& database) : database_(database) {}

std::vector<Term> Journal::terms() const {
  std::vector<Term> terms;
  sqlite::Query row =
      connection(database_).query("SELECT number, service, time, first FROM term ORDER BY number");
  while (row.step()) terms.push_back({row.integer(0), row.text(1), row.integer(2), row.integer(3)});
  return terms;
}

std::int64_t Journal::last() const {
  sqlite::Query row = connection(database_).query("SELECT coalesce(max(id), 0) FROM journal");
  row.step();
  return row.integer(0);
}

bool Journal::is_of_no_pair() const {
  Connection& db = connection(database_);
  return std::any_of(schema::journalled_tables.begin(), schema::journalled_tables.end(),
                     [&](const JournalledTable& table) {
                       sqlite::Query row =
                           db.query("SELECT 1 FROM " + std::string(table.name) + " LIMIT 1");
                       return row.step();
                     }) &&
         terms().empty();
}

std::int64_t Journal::term_at(std::int64_t position) const {
  sqlite::Query row = connection(database_).query(
      "SELECT coalesce(max(number), 0) FROM term WHERE first <= ?", position);
  row.step();
  return row.integer(0);
}

void Journal::begin_term(std::int64_t number, const std::string& service, Time now) {
  Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  const bool is_first = last() == 0;
  db.query("INSERT INTO term VALUES (?, ?, ?, ?)").run(number, service, now, last() + 1);
  if (is_first)
    for (const JournalledTable& table : schema::journalled_tables)
      if (table.name != "term")
        db.query("INSERT INTO journal (kind, key) SELECT '" + std::string(table.name) + "', " +
                 schema::key_sql(table, "") + " FROM " + std::string(table.name) + " ORDER BY " +
                 std::string(table.key.front()))
            .run();
  transaction.commit();
}

bool Journal::is_of(const std::string& service) const {
  const std::vector<Term> all = terms();
  return all.empty() || all.back().service == service;
}

void Journal::leave_pair(const std::string& service, Time now) {
  if (!is_of(service)) begin_term(terms().back().number + 1, service, now);
}

JournalPart Journal::part(std::int64_t after, std::size_t bytes) const {
  Connection& db = connection(database_);
  const sqlite::ReadTransaction snapshot(db);
  JournalPart part{after, after, {}};
  sqlite::Query entry =
      db.query("SELECT id, kind, key FROM journal WHERE id > ? ORDER BY id", after);
  while (entry.step()) {
    const std::size_t before = part.rows.size();
    append_row(read_row(db, entry.text(1), entry.text(2)), part.rows);
    if (part.rows.size() > bytes && before > 0) {
      part.rows.resize(before);
      break;
    }
    part.last = entry.integer(0);
  }
  return part;
}

std::vector<std::int64_t> Journal::apply(const JournalPart& part) {
  Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  const std::int64_t end = last();
  if (part.after > end)
    throw Error(Error::Kind::failed, "rows from " + std::to_string(part.after + 1) +
                                         " on do not follow row " + std::to_string(end));
  if (is_of_no_pair())
    throw Error(Error::Kind::failed,
                "the database has a registry that is of no pair: start this service with an empty "
                "database, or with a backup of the leader's");
  std::vector<std::int64_t> attempts;
  std::int64_t position = part.after;
  for (const JournalRow& row : read_rows(part.rows)) {
    if (++position <= end) continue;
    insert_row(db, row);
    if (row.table == overruled_table)
      db.query("INSERT INTO journal (kind, key) VALUES (?, json_array(?, ?))")
          .run(row.table, integer_in(row, 0), integer_in(row, 1));
    if (row.table == "attempt") attempts.push_back(integer_in(row, 0));
    if (last() != position)
      throw Error(Error::Kind::failed, "row " + std::to_string(position) +
                                           " of the journal was recorded at " +
                                           std::to_string(last()));
  }
  transaction.commit();
  return attempts;
}

void Journal::keep_overruled(const JournalPart& part, std::int64_t term, const std::string& service,
                             Time now) {
  Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  TermOfRow of_row(term, service);
  std::int64_t position = part.after;
  for (const JournalRow& row : read_rows(part.rows)) {
    ++position;
    of_row.meet(row);
    if (row.table == overruled_table) continue;  // is kept as what it was
    if (is_overruled(db, of_row.number(), position)) continue;
    insert_overruled(db, row, of_row.number(), position, of_row.service(), now);
    db.query("INSERT INTO journal (kind, key) VALUES ('overruled', json_array(?, ?))")
        .run(of_row.number(), position);
  }
  transaction.commit();
}

void Journal::overrule(std::int64_t end, Time now) {
  Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  const std::vector<Term> all = terms();
  std::string service;
  for (const Term& term : all)
    if (term.first <= end) service = term.service;
  TermOfRow of_row(term_at(end), service);
  for (std::int64_t position = end; position < last();) {
    const JournalPart some = part(position, part_bytes);
    for (const JournalRow& row : read_rows(some.rows)) {
      of_row.meet(row);
      ++position;
      if (row.table != overruled_table)
        insert_overruled(db, row, of_row.number(), position, of_row.service(), now);
    }
  }
  db.execute(schema::without_removal_guards());
  std::vector<std::pair<std::string, std::string>> entries;
  {
    sqlite::Query entry =
        db.query("SELECT kind, key FROM journal WHERE id > ? ORDER BY id DESC", end);
    while (entry.step()) entries.emplace_back(entry.text(0), entry.text(1));
  }
  for (const auto& [table, key] : entries)
    if (table != overruled_table) db.query("DELETE FROM " + table + row_condition(table)).run(key);
  db.query("DELETE FROM journal WHERE id > ?").run(end);
  db.execute(schema::removal_guards());
  transaction.commit();
}

std::optional<Journal::Overruled> Journal::overruled_since(Time time) const {
  Overruled found;
  sqlite::Query row = connection(database_).query(
      "SELECT count(*), "
      "coalesce(sum(kind IN ('hold', 'command') OR kind = 'decision' AND "
      "             json_extract(row_json, '$.kind') IN ('approve', 'roll_back', 'withdraw')), 0), "
      "coalesce((SELECT service FROM overruled ORDER BY term DESC LIMIT 1), '') "
      "FROM overruled WHERE time >= ?",
      time);
  row.step();
  if (row.integer(0) == 0) return std::nullopt;
  return Overruled{row.integer(1), row.text(2)};
}

}  // namespace reident::storage
