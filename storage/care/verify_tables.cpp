#include "storage/care/verify_tables.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "storage/archive/sequence.hpp"
#include "storage/database/schema.hpp"

namespace reident::storage {
namespace {

using sqlite::Connection;

constexpr const char* restore =
    "restore a backup; 'sqlite3 FILE .recover' saves what can be read of this file";

/// Lines of `pragma` that are not "ok". They hold what SQLite found, an error included.
std::vector<std::string> complaints(Connection& connection, const std::string& pragma) {
  std::vector<std::string> lines;
  sqlite::Query row = connection.query("PRAGMA " + pragma);
  while (row.step())
    if (row.text(0) != "ok") lines.push_back(row.text(0));
  return lines;
}

/// Asked by SQLite while a statement runs; ends it where the answer is no.
class Interruption {
 public:
  Interruption(Connection& connection, const std::function<bool()>& go_on)
      : connection_(connection), go_on_(go_on) {
    constexpr int instructions = 100'000;
    sqlite3_progress_handler(connection.handle(), instructions, &ask, this);
  }
  ~Interruption() { sqlite3_progress_handler(connection_.handle(), 0, nullptr, nullptr); }
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  bool happened() const { return happened_; }

 private:
  static int ask(void* self) {
    auto* own = static_cast<Interruption*>(self);
    own->happened_ = own->happened_ || !own->go_on_();
    return own->happened_ ? 1 : 0;
  }
  Connection& connection_;
  const std::function<bool()>& go_on_;
  bool happened_ = false;
};

void report_broken_references(Connection& connection, VerifyReport& report) {
  std::map<std::pair<std::string, std::string>, std::int64_t> broken;
  {
    sqlite::Query row = connection.query("PRAGMA foreign_key_check");
    while (row.step()) ++broken[{row.text(0), row.text(2)}];
  }
  for (const auto& [tables, rows] : broken)
    report.add({.check = "references",
                .what = std::to_string(rows) + " rows of the table " + tables.first +
                        " refer to rows of " + tables.second + " that do not exist",
                .remedy = restore});
}

// Columns and keys, not the text: a table that a migration altered reads differently.
std::string columns_of(Connection& connection, const std::string& table) {
  std::string text;
  {
    sqlite::Query row = connection.query(
        "SELECT name, type, \"notnull\", coalesce(dflt_value, ''), pk FROM pragma_table_xinfo(?)",
        table);
    while (row.step())
      text += row.text(0) + ' ' + row.text(1) + ' ' + row.text(2) + ' ' + row.text(3) + ' ' +
              row.text(4) + '\n';
  }
  sqlite::Query row = connection.query(
      "SELECT \"from\", \"table\" FROM pragma_foreign_key_list(?) ORDER BY 1, 2", table);
  while (row.step()) text += row.text(0) + " -> " + row.text(1) + '\n';
  return text;
}

std::string without_blanks(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\n' || c == '\t'; });
  return text;
}

using Object = std::pair<std::string, std::string>;  // kind and name

/// The text of each table, index, view and trigger.
std::map<Object, std::string> texts_of(Connection& connection) {
  std::map<Object, std::string> texts;
  sqlite::Query row = connection.query(
      "SELECT type, name, coalesce(sql, '') FROM sqlite_master WHERE name NOT LIKE 'sqlite_%'");
  while (row.step()) texts[{row.text(0), row.text(1)}] = row.text(2);
  return texts;
}

std::string meaning_of(Connection& connection, const Object& object, const std::string& text) {
  return object.first == "table" ? columns_of(connection, object.second) : without_blanks(text);
}

struct Definition {
  std::string text, meaning;
};

const std::map<Object, Definition>& expected_objects() {
  static const std::map<Object, Definition> expected = [] {
    Connection model(":memory:", ":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_MEMORY);
    model.execute(schema::creation());
    std::map<Object, Definition> definitions;
    for (const auto& [object, text] : texts_of(model))
      definitions[object] = {text, meaning_of(model, object, text)};
    return definitions;
  }();
  return expected;
}

struct Rule {
  const char* check;
  const char* rows;  // SQL: spacecraft, name, origin (or NULL), first, last (or NULL), what
  const char* remedy;
};

constexpr const char* as_backup = "restore these rows from a backup";

constexpr Rule rules[] = {
    {"versions",
     "SELECT spacecraft, equipment, NULL, NULL, NULL, 'version ' || number || ' has no decision' "
     "FROM version AS v WHERE NOT EXISTS (SELECT 1 FROM decision AS d WHERE d.spacecraft = "
     "v.spacecraft AND d.equipment = v.equipment AND d.version = v.number)",
     as_backup},
    {"versions",
     // Services of a pair leave out numbers, each those of the other one.
     "SELECT spacecraft, equipment, NULL, NULL, NULL, 'its ' || count(*) || ' versions are "
     "numbered up to ' || max(number) FROM version GROUP BY spacecraft, equipment "
     "HAVING (max(number) <> count(*) OR min(number) <> 1) AND NOT EXISTS (SELECT 1 FROM term)",
     as_backup},
    {"journal",
     "SELECT '', '', NULL, NULL, NULL, 'its ' || count(*) || ' rows are numbered up to ' || "
     "max(id) "
     "FROM journal HAVING max(id) <> count(*)",
     as_backup},
    {"versions",
     "SELECT v.spacecraft, v.equipment, NULL, window_begin, window_end, 'version ' || number || "
     "' belongs to an attempt at another equipment' FROM version AS v JOIN attempt AS a "
     "ON a.id = v.attempt WHERE a.spacecraft <> v.spacecraft OR a.equipment <> v.equipment",
     as_backup},
    {"attempts",
     "SELECT spacecraft, equipment, NULL, window_begin, window_end, 'attempt ' || id || ' has "
     "evidence that is no JSON' FROM attempt "
     "WHERE evidence_json <> '' AND NOT json_valid(evidence_json)",
     as_backup},
    {"decisions",
     "SELECT spacecraft, equipment, NULL, NULL, NULL, 'decision ' || id || ' has evidence that is "
     "no JSON' FROM decision WHERE evidence_json <> '' AND NOT json_valid(evidence_json)",
     as_backup},
    {"scores",
     "SELECT spacecraft, equipment, NULL, begin_time, end_time, 'a block is no list of numbers, or "
     "ends before it begins' FROM block WHERE length(output_mean) % 8 <> 0 "
     "OR length(output_square) <> length(output_mean) OR length(input_low) % 8 <> 0 "
     "OR length(input_high) <> length(input_low) OR length(baseline_square) % 8 <> 0 "
     "OR end_time <= begin_time",
     as_backup},
    {"scores",
     "SELECT spacecraft, equipment, NULL, begin_time, NULL, 'a score of version ' || version || "
     "' is no list of numbers' FROM score WHERE length(error_mean) % 8 <> 0 "
     "OR length(error_square) <> length(error_mean) OR length(noise_square) <> length(error_mean) "
     "OR length(state) % 8 <> 0 OR length(run_square) % 8 <> 0 "
     "OR length(bias_effects) % 8 <> 0",
     as_backup},
    {"attempts",
     "SELECT spacecraft, equipment, NULL, window_begin, window_end, 'attempt ' || id || ' has a "
     "window that ends before it begins' FROM attempt WHERE window_end < window_begin",
     as_backup},
    {"late",
     "SELECT spacecraft, CAST(parameter AS TEXT), origin, begin_time, end_time, 'a mark of late "
     "samples ends before it begins' FROM late_range JOIN series ON series.id = series "
     "WHERE end_time < begin_time",
     "delete the mark from the table late_range while no service runs"},
    {"removal",
     "SELECT spacecraft, CAST(parameter AS TEXT), origin, begin_time, end_time, 'a removal ends "
     "before it begins, or removed nothing' FROM removal JOIN series ON series.id = series "
     "WHERE end_time < begin_time OR removal.samples <= 0",
     as_backup},
};

std::optional<Time> time(const sqlite::Query& row, int column) {
  return row.is_null(column) ? std::nullopt : std::optional(row.integer(column));
}

struct Source {
  std::int64_t id;
  std::string spacecraft, name;
  Origin origin;
};

void verify_source(Connection& connection, const Source& source, VerifyReport& report) {
  const sqlite::ReadTransaction snapshot(connection);
  const auto add = [&](std::optional<Time> first, std::optional<Time> last, std::string what) {
    report.add({"source", source.spacecraft, source.name, source.origin, first, last,
                std::move(what),
                "the samples are sound; 'reident completeness' shows what is missing by their "
                "times"});
  };
  sqlite::Query counts =
      connection.query("SELECT missing, restarts FROM source WHERE id = ?", source.id);
  if (!counts.step()) return;
  std::uint64_t missing = 0;
  std::int64_t run = -1;
  std::uint64_t last = 0;
  sqlite::Query gap = connection.query(
      "SELECT run, first, last, time_before, time_after FROM sequence_gap WHERE source = ? "
      "ORDER BY run, first",
      source.id);
  while (gap.step()) {
    const std::uint64_t from = from_column(gap.integer(1)), to = from_column(gap.integer(2));
    missing += to - from + 1;
    if (to < from || (gap.integer(0) == run && from <= last))
      add(gap.integer(3), gap.integer(4),
          "the gap of sequence numbers from " + std::to_string(from) + " to " + std::to_string(to) +
              " overlaps the one before it or ends before it begins");
    run = gap.integer(0);
    last = to;
  }
  if (run > counts.integer(1))
    add({}, {},
        "it has gaps of run " + std::to_string(run) + " and began again only " +
            std::to_string(counts.integer(1)) + " times");
  if (const auto said = counts.integer<std::uint64_t>(0); said != missing)
    add({}, {},
        "its row says that " + std::to_string(said) + " numbers are missing; its gaps have " +
            std::to_string(missing));
}

}  // namespace

bool verify_pages(Connection& connection, bool quick, VerifyReport& report,
                  const std::function<bool()>& go_on) {
  const Interruption interruption(connection, go_on);
  try {
    for (const std::string& line :
         complaints(connection, quick ? "quick_check" : "integrity_check"))
      report.add({.check = "pages", .what = "SQLite finds: " + line, .remedy = restore});
    report_broken_references(connection, report);
  } catch (const Error& error) {
    if (interruption.happened()) return false;
    report.add({.check = "pages", .what = error.what(), .remedy = restore});
  }
  return true;
}

void verify_schema(Connection& connection, VerifyReport& report) {
  const sqlite::ReadTransaction snapshot(connection);
  const std::map<Object, Definition>& expected = expected_objects();
  const std::map<Object, std::string> found = texts_of(connection);
  const auto add = [&](const auto& object, const char* what) {
    report.add({.check = "schema",
                .what = "the " + object.first + " " + object.second + " " + what,
                .remedy = "restore a backup, or make it as 'sqlite3 FILE .schema' shows it for a "
                          "new file of this program"});
  };
  for (const auto& [object, definition] : expected) {
    const auto at = found.find(object);
    if (at == found.end())
      add(object, "is missing");
    else if (at->second != definition.text &&
             meaning_of(connection, object, at->second) != definition.meaning)
      add(object, "is not the one that this program makes");
  }
  for (const auto& [object, definition] : found)
    if (object.first == "trigger" && !expected.contains(object))
      add(object, "is not of this program, and may change what is written");
}

void verify_sources(Connection& connection, VerifyReport& report) {
  std::vector<Source> sources;
  {
    sqlite::Query row = connection.query("SELECT id, spacecraft, name, origin FROM source");
    while (row.step())
      sources.push_back({row.integer(0), row.text(1), row.text(2), row.integer<Origin>(3)});
  }
  for (const Source& source : sources) verify_source(connection, source, report);
}

void verify_rows(Connection& connection, VerifyReport& report) {
  for (const Rule& rule : rules) {
    sqlite::Query row = connection.query(rule.rows);
    while (row.step())
      report.add({rule.check, row.text(0), row.text(1),
                  row.is_null(2) ? std::nullopt : std::optional(row.integer<Origin>(2)),
                  time(row, 3), time(row, 4), row.text(5), rule.remedy});
  }
}

}  // namespace reident::storage
