#include "storage/care/backup.hpp"

#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "storage/archive/chunk_bytes.hpp"
#include "storage/care/shard_file.hpp"
#include "storage/database/connection.hpp"
#include "storage/database/file_guard.hpp"
#include "storage/database/partial_file.hpp"
#include "storage/database/writer_lock.hpp"

namespace reident::storage {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;

struct Finish {
  void operator()(sqlite3_backup* backup) const { sqlite3_backup_finish(backup); }
};

[[noreturn]] void refuse(const fs::path& copy, const std::string& why) {
  throw Error(Error::Kind::cannot_open, "backup " + copy.string() + " " + why);
}

void refuse_the_source(const fs::path& source, const fs::path& copy) {
  std::error_code error;
  if (fs::equivalent(source, copy, error))
    refuse(copy, "is the database itself: name another file");
  for (const char* companion : {"-wal", "-shm", "-journal", ".lock"})
    if (copy == source.string() + companion)
      refuse(copy,
             "is a name that belongs to the database " + source.string() + ": name another file");
}

// SQLite would take a log or journal of that name for the new file's own.
void refuse_foreign_log(const fs::path& copy) {
  for (const char* companion : {"-wal", "-journal"})
    if (const fs::path log = copy.string() + companion; has_content(log))
      refuse(copy, "cannot be written: " + log.string() +
                       " is next to it, so that a database of that name is in use or was not "
                       "closed; end what uses it, or name another file");
}

void refuse_target(const fs::path& source, const fs::path& copy, bool replace) {
  std::error_code error;
  const fs::file_status status = fs::status(copy, error);
  if (fs::is_directory(status)) refuse(copy, "is a folder: name a file in it");
  if (fs::exists(status) && !fs::is_regular_file(status))
    refuse(copy, "is not a regular file: name another");
  if (!fs::is_directory(copy.parent_path(), error))
    refuse(copy, "cannot be written: the folder " + copy.parent_path().string() +
                     " does not exist; make it, or check the path");
  refuse_the_source(source, copy);
  if (fs::exists(status) && !replace)
    refuse(copy, "exists already: name another file, or replace it with --replace");
  refuse_foreign_log(copy);
}

std::string schema_text(Connection& connection) {
  std::string text;
  sqlite::Query row =
      connection.query("SELECT type, name, coalesce(sql, '') FROM sqlite_master ORDER BY rowid");
  while (row.step()) text += row.text(0) + ' ' + row.text(1) + '\n' + row.text(2) + '\n';
  return text;
}

std::int64_t number(Connection& connection, const std::string& sql) {
  sqlite::Query row = connection.query(sql);
  return row.step() ? row.integer(0) : 0;
}

// The connection is not used again where the page that could not be read is the source's.
bool is_of_source(int code) {
  return (code & 0xff) == SQLITE_CORRUPT || (code & 0xff) == SQLITE_NOTADB ||
         code == SQLITE_IOERR_READ || code == SQLITE_IOERR_SHORT_READ;
}

/// False when it was stopped.
bool copy_pages(Connection& source, Connection& target, std::uint32_t pages_of_step,
                const std::function<bool(const BackupProgress&)>& go_on) {
  std::unique_ptr<sqlite3_backup, Finish> backup(
      sqlite3_backup_init(target.handle(), "main", source.handle(), "main"));
  if (!backup) sqlite::fail(target.handle(), sqlite3_errcode(target.handle()));
  while (true) {
    const int code = sqlite3_backup_step(backup.get(), static_cast<int>(pages_of_step));
    if (code != SQLITE_OK && code != SQLITE_DONE) {
      backup.reset();  // which leaves SQLite's words with the target
      sqlite::fail(is_of_source(code) ? source.handle() : target.handle(), code);
    }
    const auto pages = static_cast<std::uint64_t>(sqlite3_backup_pagecount(backup.get()));
    const auto left = static_cast<std::uint64_t>(sqlite3_backup_remaining(backup.get()));
    if (code == SQLITE_DONE) break;
    if (!go_on({pages, pages - left})) return false;
  }
  const int code = sqlite3_backup_finish(backup.release());
  if (code != SQLITE_OK) sqlite::fail(target.handle(), code);
  return true;
}

bool is_sound(const fs::path& shard, const std::string& name) {
  try {
    Connection connection(sqlite::immutable_uri(shard), shard,
                          SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
    return has_content_of(connection, name);
  } catch (const Error&) {
    return false;
  }
}

/// Shards of the copy in its own folder. One that is there is of that content by its name. False
/// when it was stopped; what was copied by then is of use to the next backup.
bool copy_shards(Connection& source, const fs::path& copy, BackupReport& report,
                 const std::function<bool()>& go_on) {
  std::vector<std::pair<std::int64_t, std::string>> shards;
  {
    sqlite::Query row = source.query("SELECT id, file FROM shard WHERE chunks > 0 AND id <> 0");
    while (row.step()) shards.emplace_back(row.integer(0), row.text(1));
  }
  ChunkBytes bytes(source);
  for (const auto& [id, file] : shards) {
    if (!go_on()) return false;
    bytes.shard(id);  // throws where it is not the one
    const fs::path from = shard_path(source.path(), file), to = shard_path(copy, file);
    ++report.shards;
    std::error_code error;
    if (fs::file_size(to, error) == fs::file_size(from) && !error) continue;
    make_folder_of(to, copy.parent_path());
    PartialFile partial(to, permissions_of(from));
    fs::copy_file(from, partial.path(), fs::copy_options::overwrite_existing, error);
    if (error)
      throw Error(
          error == std::errc::no_space_on_device ? Error::Kind::full : Error::Kind::cannot_open,
          "shard " + from.string() + " cannot be copied to " + to.string() + " (" +
              error.message() + "): check the disk, its room and the permissions");
    if (!is_sound(partial.path(), file))
      throw Error(Error::Kind::corrupt,
                  "shard " + from.string() +
                      " is damaged ('reident verify' shows where), or the disk of the copy fails: "
                      "its copy was not kept; restore the shard from an earlier backup");
    partial.publish(true);
    report.shard_bytes += fs::file_size(to);
  }
  return true;
}

Connection open_target(const fs::path& file) {
  Connection target(file.string(), file, SQLITE_OPEN_READWRITE);
  // A file that counts only when it is whole needs no journal; it is forced to the disk at the end.
  target.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF");
  return target;
}

/// Reads the copy as one that does not change, so that no log is made next to it. Throws Error
/// where it is not what the source's snapshot was.
BackupReport look_at(const fs::path& file, const std::string& schema, std::int64_t pages) {
  Connection connection(sqlite::immutable_uri(file), file, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
  BackupReport report{.bytes = fs::file_size(file)};
  const std::int64_t page_size = number(connection, "PRAGMA page_size");
  if (number(connection, "PRAGMA page_count") != pages ||
      report.bytes != static_cast<std::uint64_t>(pages * page_size) ||
      schema_text(connection) != schema)
    throw Error(Error::Kind::corrupt, "it has another size or other tables");
  sqlite::Query row =
      connection.query("SELECT coalesce(sum(samples), 0), max(last_time) FROM series");
  row.step();
  report.samples = row.integer<std::uint64_t>(0);
  if (!row.is_null(1)) report.newest = row.integer(1);
  report.versions = static_cast<std::uint64_t>(number(connection, "SELECT count(*) FROM version"));
  return report;
}

BackupReport checked(const fs::path& source, const fs::path& copy, const fs::path& file,
                     const std::string& schema, std::int64_t pages) {
  try {
    BackupReport report = look_at(file, schema, pages);
    report.copy = copy;
    return report;
  } catch (const Error& error) {
    throw Error(Error::Kind::corrupt,
                "backup " + copy.string() +
                    " did not come out whole, and was not kept: the database " + source.string() +
                    " is damaged ('reident verify' shows where), or the disk fails (" +
                    error.what() + ")");
  }
}

}  // namespace

std::optional<BackupReport> back_up(Database& source, const fs::path& named,
                                    const BackupOptions& options,
                                    const std::function<bool(const BackupProgress&)>& go_on) {
  // A link stays one: what it leads to is replaced.
  std::error_code error;
  fs::path copy = fs::weakly_canonical(fs::absolute(named), error);
  if (error) copy = fs::absolute(named);  // what keeps it from being looked at is found below
  refuse_target(source.path(), copy, options.replace);
  std::optional<WriterLock> lock;
  if (fs::exists(copy.string() + ".lock", error)) lock.emplace(copy);
  PartialFile partial(copy, permissions_of(source.path()));

  Connection& from = *source.impl().connection;
  const sqlite::ReadTransaction snapshot(from);
  const std::string schema = schema_text(from);
  const std::int64_t pages = number(from, "PRAGMA page_count");
  {
    Connection target = open_target(partial.path());
    if (!copy_pages(from, target, options.pages_of_step, go_on)) return std::nullopt;
  }
  BackupReport report = checked(source.path(), copy, partial.path(), schema, pages);
  const auto still = [&] { return go_on({report.bytes, report.bytes}); };
  if (!copy_shards(from, copy, report, still)) return std::nullopt;
  partial.publish(options.replace);
  return report;
}

}  // namespace reident::storage
