#include "storage/database.hpp"

#include <cstring>
#include <fstream>
#include <unistd.h>
#include <utility>

#include "storage/connection.hpp"
#include "storage/migration.hpp"
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
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error(Error::Kind::cannot_open, what + " is not a regular file: name another");
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::exists(folder, error))
    throw Error(Error::Kind::cannot_open,
                what + " cannot be opened: its folder does not exist; check the path");
  if (mode == Database::Mode::read_only && !fs::exists(status))
    throw Error(Error::Kind::cannot_open,
                what + " does not exist: check the path, or start the service that makes it");
}

bool has_content(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  return !error && size > 0;
}

// SQLite reads what is missing of a last page as zeros, and it deletes the log of an empty file. A
// file that has a log or journal beside it may be shorter than its first page says.
void refuse_what_was_cut_short(const fs::path& path) {
  const auto cut_short = [&](const std::string& found) {
    return Error(Error::Kind::corrupt, "database " + path.string() + " was cut short: " + found +
                                           "; restore a backup, or save what can be read with "
                                           "'sqlite3 FILE .recover'");
  };
  const fs::path log = path.string() + "-wal";
  if (has_content(log)) {
    if (!has_content(path)) throw cut_short("it is empty, and its log " + log.string() + " is not");
    return;
  }
  constexpr std::size_t header_size = 32;
  unsigned char header[header_size] = {};
  std::ifstream file(path, std::ios::binary);
  if (has_content(path.string() + "-journal") ||
      !file.read(reinterpret_cast<char*>(header), header_size) ||
      std::memcmp(header, "SQLite format 3", 16) != 0)
    return;
  const std::uint64_t page_size = header[16] * 256U + header[17];
  std::uint64_t pages = 0;
  for (std::size_t i = 28; i < 32; ++i) pages = pages * 256 + header[i];
  if (fs::file_size(path) < pages * page_size)
    throw cut_short("it has " + std::to_string(fs::file_size(path)) + " of " +
                    std::to_string(pages * page_size) + " bytes");
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

Connection open_writer(const fs::path& path) {
  Connection connection(path.string(), path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  connection.execute("PRAGMA foreign_keys = ON; PRAGMA cache_size = -65536");
  if (connection.is_read_only())
    throw Error(Error::Kind::read_only,
                "database " + path.string() + " cannot be written: check its permissions");
  if (!is_empty(connection)) refuse_what_is_not_ours(connection, path);
  if (pragma(connection, "user_version") != schema::version) bring_up_to_date(connection);
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

// In a folder that cannot be written SQLite cannot make the shared memory that a log needs.
// Without a log the file is complete, and a file that nobody can write beside does not change.
Connection open_sealed(const fs::path& path) {
  const fs::path log = path.string() + "-wal";
  if (has_content(log))
    throw Error(Error::Kind::cannot_open,
                "database " + path.string() + " cannot be opened: its newest data are in " +
                    log.string() +
                    ", which cannot be read in a folder without write permission; "
                    "copy both to a folder that can be written");
  return Connection(immutable_uri(path), path, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
}

Connection open_reader(const fs::path& path) {
  const auto checked = [&](Connection connection) {
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

Database::Database(const std::filesystem::path& path, Mode mode) : impl_(std::make_unique<Impl>()) {
  impl_->path = resolved(path);
  refuse_what_is_no_file(impl_->path, mode);
  if (mode == Mode::read_write) impl_->lock.emplace(impl_->path);
  refuse_what_was_cut_short(impl_->path);
  if (mode == Mode::read_write) {
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
