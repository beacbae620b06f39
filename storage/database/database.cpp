#include "storage/database/database.hpp"

#include <unistd.h>
#include <utility>

#include "storage/database/connection.hpp"
#include "storage/database/file_guard.hpp"
#include "storage/database/migration.hpp"
#include "storage/database/schema.hpp"

namespace reident::storage {
namespace {

namespace fs = std::filesystem;
using sqlite::Connection;

fs::path resolved(const fs::path& path) {
  // Two names of one file must meet at one lock.
  std::error_code error;
  fs::path canonical = fs::weakly_canonical(path, error);
  return error ? path : canonical;
}

void refuse_what_is_no_file(const fs::path& path, Database::Mode mode) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  const std::string what = "database " + path.string();
  if (fs::is_directory(status))
    throw Error(Error::Kind::cannot_open, what + " is a folder: name a file in it");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error(Error::Kind::cannot_open, what + " is not a regular file: name another");
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::exists(folder, error))
    throw Error(Error::Kind::cannot_open,
                what + " cannot be opened: its folder does not exist; check the path");
  if (mode != Database::Mode::read_write && !fs::exists(status))
    throw Error(Error::Kind::cannot_open,
                what + " does not exist: check the path; a service or 'reident import' makes it");
}

// SQLite deletes the log of an empty file.
void refuse_an_emptied_file(const fs::path& path, const std::optional<WriterLock>& lock) {
  if (has_content(path) || !fs::exists(path) || has_content(path.string() + "-journal")) return;
  std::string found;
  if (const std::string log = path.string() + "-wal"; has_content(log))
    found = "it is empty, and its log " + log + " is not; restore a backup";
  else if (lock && lock->had_tables())
    found =
        "it is empty, and was not when it was written last; restore a backup, or remove it to "
        "begin again";
  else
    return;
  throw Error(Error::Kind::corrupt, "database " + path.string() + " was cut short: " + found);
}

// SQLite keeps the log next to the name by which a file was opened: two names, two logs.
void refuse_a_second_name(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t names = fs::hard_link_count(path, error);
  if (error || names <= 1) return;
  throw Error(Error::Kind::cannot_open,
              "database " + path.string() + " has " + std::to_string(names) +
                  " names (hard links), and programs that open it by different ones would damage "
                  "it: remove the others, which 'find FOLDER -samefile FILE' lists");
}

std::int64_t pragma(Connection& connection, std::string_view name) {
  sqlite::Query query = connection.query("PRAGMA " + std::string(name));
  return query.step() ? query.integer(0) : 0;
}

// A file that a crash left between its making and its first commit counts as empty.
bool is_empty(Connection& connection) {
  sqlite::Query query = connection.query("SELECT count(*) FROM sqlite_master");
  return query.step() && query.integer(0) == 0 && pragma(connection, "application_id") == 0 &&
         pragma(connection, "user_version") == 0;
}

void refuse_what_is_not_ours(Connection& connection, const fs::path& path) {
  const std::string what = "database " + path.string();
  const std::int64_t version = pragma(connection, "user_version");
  if (pragma(connection, "application_id") != schema::application_id || version < 1)
    throw Error(Error::Kind::cannot_open,
                what + " was not made by reident: name another file, it is left as it is");
  if (version > schema::version)
    throw Error(Error::Kind::newer_schema, what + " has schema version " + std::to_string(version) +
                                               ", this program knows versions up to " +
                                               std::to_string(schema::version) +
                                               ": use a newer reident, the file is left as it is");
}

void refuse_a_shard(Connection& connection, const fs::path& path) {
  sqlite::Query table =
      connection.query("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = 'shard'");
  if (!table.step()) return;
  sqlite::Query itself = connection.query("SELECT 1 FROM shard WHERE id = 0");
  if (itself.step())
    throw Error(Error::Kind::cannot_open,
                "database " + path.string() +
                    " is a shard of an archive, which never changes: name the archive's database");
}

void refuse_older_schema(Connection& connection, const fs::path& path) {
  const std::int64_t version = pragma(connection, "user_version");
  if (version == schema::version) return;
  throw Error(Error::Kind::older_schema,
              "database " + path.string() + " has schema version " + std::to_string(version) +
                  ", this program reads version " + std::to_string(schema::version) +
                  ": start this reidentd on it once, which brings it up to date");
}

void bring_up_to_date(Connection& connection) {
  sqlite::Transaction transaction(connection);
  if (is_empty(connection))
    connection.execute(schema::creation());
  else if (const std::int64_t version = pragma(connection, "user_version");
           version < schema::version)
    migrate(connection, version);
  transaction.commit();
}

Connection open_writer(const fs::path& path, Durability durability) {
  Connection connection(path.string(), path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  refuse_damaged_files(connection, path, true, durability);
  connection.execute("PRAGMA foreign_keys = ON; PRAGMA cache_size = -65536");
  if (connection.is_read_only())
    throw Error(Error::Kind::read_only,
                "database " + path.string() + " cannot be written: check its permissions");
  if (!is_empty(connection)) refuse_what_is_not_ours(connection, path);
  refuse_a_shard(connection, path);
  if (pragma(connection, "user_version") != schema::version) bring_up_to_date(connection);
  connection.execute("PRAGMA journal_mode = WAL; PRAGMA journal_size_limit = 67108864");
  connection.fold_log();
  // FULL flushes the log before a commit returns, NORMAL before it is folded into the file.
  connection.execute(durability == Durability::power_cut ? "PRAGMA synchronous = FULL"
                                                         : "PRAGMA synchronous = NORMAL");
  pragma(connection, "user_version");  // the first read opens the log
  connection.guard_files(path);
  return connection;
}

// In a folder that cannot be written SQLite cannot make the shared memory that a log needs.
// Without a log the file is complete. It does not change where nobody can write to its folder.
Connection open_sealed(const fs::path& path) {
  const fs::path log = path.string() + "-wal";
  if (has_content(log))
    throw Error(Error::Kind::cannot_open,
                "database " + path.string() + " cannot be opened: its newest data are in " +
                    log.string() +
                    ", which cannot be read in a folder without write permission; "
                    "copy both to a folder that can be written");
  return Connection(sqlite::immutable_uri(path), path, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
}

Connection open_reader(const fs::path& path) {
  const auto checked = [&](Connection connection) {
    refuse_damaged_files(connection, path, false, Durability::power_cut);
    refuse_what_is_not_ours(connection, path);
    refuse_older_schema(connection, path);
    return connection;
  };
  try {
    return checked(Connection(path.string(), path, SQLITE_OPEN_READONLY));
  } catch (const Error& error) {
    const bool folder_is_writable = ::access(path.parent_path().c_str(), W_OK) == 0;
    const bool could_not_make_files =
        error.kind() == Error::Kind::cannot_open || error.kind() == Error::Kind::read_only;
    if (!could_not_make_files || folder_is_writable || ::access(path.c_str(), R_OK) != 0) throw;
  }
  return checked(open_sealed(path));
}

}  // namespace

Database::Database(const std::filesystem::path& path, Mode mode, Durability durability)
    : impl_(std::make_unique<Impl>()) {
  impl_->path = resolved(path);
  refuse_what_is_no_file(impl_->path, mode);
  if (mode != Mode::read_only) {
    refuse_a_second_name(impl_->path);
    impl_->lock.emplace(impl_->path);
  }
  refuse_an_emptied_file(impl_->path, impl_->lock);
  if (mode != Mode::read_only) {
    impl_->connection.emplace(open_writer(impl_->path, durability));
    impl_->lock->note_tables();
  } else {
    impl_->connection.emplace(open_reader(impl_->path));
  }
}

Database::~Database() = default;
Database::Database(Database&&) noexcept = default;
Database& Database::operator=(Database&&) noexcept = default;

bool Database::has_writer(const std::filesystem::path& path) {
  return WriterLock::is_held(resolved(path));
}

const std::filesystem::path& Database::path() const {
  return impl_->path;
}

}  // namespace reident::storage
