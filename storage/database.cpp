#include "storage/database.hpp"

#include <utility>

#include "storage/connection.hpp"
#include "storage/schema.hpp"

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
  if (mode == Database::Mode::read_only && status.type() == fs::file_type::not_found)
    throw Error(Error::Kind::cannot_open,
                what + " does not exist: check the path, or start the service that makes it");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error(Error::Kind::cannot_open, what + " is not a regular file: name another");
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::exists(folder, error))
    throw Error(Error::Kind::cannot_open,
                what + " cannot be made: its folder does not exist; make the folder first");
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
  if (pragma(connection, "application_id") != schema::application_id)
    throw Error(Error::Kind::cannot_open,
                what + " was not made by reident: name another file, it is left as it is");
  const std::int64_t version = pragma(connection, "user_version");
  if (version > schema::version)
    throw Error(Error::Kind::newer_schema, what + " has schema version " + std::to_string(version) +
                                               ", this program knows versions up to " +
                                               std::to_string(schema::version) +
                                               ": use a newer reident, the file is left as it is");
}

Connection open_writer(const fs::path& path) {
  Connection connection(path.string(), path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  connection.execute("PRAGMA foreign_keys = ON; PRAGMA cache_size = -65536");
  if (is_empty(connection)) {
    sqlite::Transaction transaction(connection);
    connection.execute(schema::creation());
    transaction.commit();
  }
  refuse_what_is_not_ours(connection, path);
  // FULL: the log is on the disk before a commit returns. SCHEMA.md, "What survives".
  connection.execute(
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;"
      "PRAGMA wal_autocheckpoint = 4096; PRAGMA journal_size_limit = 67108864");
  return connection;
}

std::string immutable_uri(const fs::path& path) {
  std::string uri = "file:";
  for (const char c : path.string()) {
    if (c == '%')
      uri += "%25";
    else if (c == '?')
      uri += "%3f";
    else if (c == '#')
      uri += "%23";
    else
      uri += c;
  }
  return uri + "?immutable=1";
}

Connection open_reader(const fs::path& path) {
  try {
    Connection connection(path.string(), path, SQLITE_OPEN_READONLY);
    refuse_what_is_not_ours(connection, path);
    return connection;
  } catch (const Error& error) {
    // In a folder that cannot be written SQLite cannot make its shared memory file. Without a log
    // beside it the file is complete, and nobody who writes is there.
    std::error_code ignored;
    if (error.kind() != Error::Kind::cannot_open || fs::exists(path.string() + "-wal", ignored))
      throw;
    Connection connection(immutable_uri(path), path, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
    refuse_what_is_not_ours(connection, path);
    return connection;
  }
}

}  // namespace

Database::Database(const std::filesystem::path& path, Mode mode) : impl_(std::make_unique<Impl>()) {
  impl_->path = resolved(path);
  refuse_what_is_no_file(impl_->path, mode);
  if (mode == Mode::read_write) {
    impl_->lock.emplace(impl_->path);
    impl_->connection.emplace(open_writer(impl_->path));
  } else {
    impl_->connection.emplace(open_reader(impl_->path));
  }
}

Database::~Database() = default;
Database::Database(Database&&) noexcept = default;
Database& Database::operator=(Database&&) noexcept = default;

const std::filesystem::path& Database::path() const {
  return impl_->path;
}

}  // namespace reident::storage
