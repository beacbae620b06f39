#include "storage/archive/import_log.hpp"

#include "storage/database/connection.hpp"

namespace reident::storage {

ImportLog::ImportLog(Database& database) : database_(database) {}

std::vector<ImportLog::Unfinished> ImportLog::unfinished(const std::string& request) const {
  std::vector<Unfinished> found;
  sqlite::Query row = database_.impl().connection->query(
      "SELECT id, position, line, digest, rows, bad_lines, samples, stored, duplicates, conflicts "
      "FROM import WHERE request = ? AND finished IS NULL ORDER BY id DESC",
      request);
  while (row.step())
    found.push_back({row.integer(0),
                     {.position = row.integer<std::uint64_t>(1),
                      .line = row.integer<std::uint64_t>(2),
                      .digest = row.text(3),
                      .rows = row.integer<std::uint64_t>(4),
                      .bad_lines = row.integer<std::uint64_t>(5),
                      .samples = row.integer<std::uint64_t>(6),
                      .stored = row.integer<std::uint64_t>(7),
                      .duplicates = row.integer<std::uint64_t>(8),
                      .conflicts = row.integer<std::uint64_t>(9)}});
  return found;
}

std::int64_t ImportLog::begin(const std::string& file, const std::string& request, Time now) {
  sqlite::Connection& connection = *database_.impl().connection;
  connection.query("INSERT INTO import (file, request, started) VALUES (?, ?, ?)")
      .run(file, request, now);
  return connection.last_id();
}

AppendReport ImportLog::append(std::int64_t import,
                               std::span<const ParameterDescriptor> descriptors,
                               std::span<const TelemetryFrame> frames, ImportPosition& at) {
  sqlite::Connection& connection = *database_.impl().connection;
  ImportPosition after = at;
  sqlite::Transaction transaction(connection);
  Archive archive(database_);
  archive.describe(descriptors);
  AppendReport report = archive.append(frames);
  after.samples += report.stored + report.duplicates + report.conflicts;
  after.stored += report.stored;
  after.duplicates += report.duplicates;
  after.conflicts += report.conflicts;
  connection
      .query(
          "UPDATE import SET position = ?, line = ?, digest = ?, rows = ?, bad_lines = ?, "
          "samples = ?, stored = ?, duplicates = ?, conflicts = ? WHERE id = ?")
      .run(after.position, after.line, after.digest, after.rows, after.bad_lines, after.samples,
           after.stored, after.duplicates, after.conflicts, import);
  transaction.commit();
  at = after;
  return report;
}

void ImportLog::finish(std::int64_t import, Time now) {
  database_.impl()
      .connection->query("UPDATE import SET finished = ? WHERE id = ?")
      .run(now, import);
}

}  // namespace reident::storage
