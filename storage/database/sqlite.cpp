#include "storage/database/sqlite.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

namespace reident::storage::sqlite {
namespace {

constexpr int most_bytes_of_value = 256 << 20;

struct Diagnosis {
  Error::Kind kind;
  const char* what_and_remedy;
};

// SQLite reports ENOSPC alone as SQLITE_FULL; a quota and a file size limit come as I/O errors.
bool no_room(int system_error) {
  return system_error == ENOSPC || system_error == EDQUOT || system_error == EFBIG;
}

bool no_room(sqlite3* connection, int code, int system_error) {
  if ((code & 0xff) == SQLITE_FULL) return true;
  if ((code & 0xff) != SQLITE_IOERR || code == SQLITE_IOERR_READ) return false;
  // SQLite does not note the system's error of every failure; errno still has it then.
  return no_room(system_error) || (connection && no_room(sqlite3_system_errno(connection)));
}

Diagnosis diagnose(int code) {
  using Kind = Error::Kind;
  switch (code & 0xff) {
    case SQLITE_CANTOPEN:
      return {Kind::cannot_open, "cannot be opened: check that it exists and its permissions"};
    case SQLITE_NOTADB:
      return {Kind::cannot_open, "is not a database: name another file"};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {Kind::locked, "is locked by another program: end that program's transaction"};
    case SQLITE_CORRUPT:
    case SQLITE_TOOBIG:
      return {Kind::corrupt,
              "is damaged: restore a backup, or save what can be read with "
              "'sqlite3 FILE .recover'"};
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return {Kind::read_only,
              "cannot be written: check the permissions of the file and of its "
              "folder"};
    case SQLITE_FULL:
      return {Kind::full,
              "has no room to grow: free space on its disk or raise the quota or file size limit; "
              "what was stored before is kept"};
    case SQLITE_IOERR:
      return {Kind::failed, "cannot be read or written: check the disk"};
    default:
      return {Kind::failed, "failed"};
  }
}

[[noreturn]] void fail_on(sqlite3* connection, int code, const std::string& path) {
  const int system_error = errno;
  const bool full = no_room(connection, code, system_error);
  const Diagnosis diagnosis = diagnose(full ? SQLITE_FULL : code);
  std::string message = "database " + path + " " + diagnosis.what_and_remedy;
  message +=
      std::string(" (SQLite: ") + (connection ? sqlite3_errmsg(connection) : sqlite3_errstr(code));
  if ((code & 0xff) == SQLITE_IOERR && system_error != 0)
    message += std::string("; system: ") + std::strerror(system_error);
  throw Error(diagnosis.kind, message + ")");
}

}  // namespace

void fail(sqlite3* connection, int code) {
  const char* path = sqlite3_db_filename(connection, "main");
  fail_on(connection, code, path ? path : "");
}

std::string immutable_uri(const std::filesystem::path& path) {
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

Query::~Query() {
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

void Query::check(int code) const {
  if (code != SQLITE_OK) fail(sqlite3_db_handle(statement_), code);
}

bool Query::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) fail(sqlite3_db_handle(statement_), code);
  return false;
}

std::int64_t Query::run_bound() {
  step();
  return sqlite3_changes64(sqlite3_db_handle(statement_));
}

std::int64_t Query::run(const std::vector<Value>& values) {
  sqlite3_reset(statement_);
  int index = 0;
  for (const Value& value : values) {
    ++index;
    if (const auto* integer = std::get_if<std::int64_t>(&value))
      bind_one(index, *integer);
    else if (const auto* real = std::get_if<double>(&value))
      bind_one(index, *real);
    else if (const auto* text = std::get_if<std::string>(&value))
      bind_one(index, std::string_view(*text));
    else if (const auto* bytes = std::get_if<std::vector<std::uint8_t>>(&value))
      bind_bytes(index, *bytes);
    else
      bind_null(index);
  }
  return run_bound();
}

Value Query::value(int column) const {
  switch (sqlite3_column_type(statement_, column)) {
    case SQLITE_INTEGER:
      return integer(column);
    case SQLITE_FLOAT:
      return real(column);
    case SQLITE_TEXT:
      return text(column);
    case SQLITE_BLOB: {
      const auto all = bytes(column);
      return std::vector<std::uint8_t>(all.begin(), all.end());
    }
    default:
      return std::monostate();
  }
}

bool Query::is_null(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

double Query::real(int column) const {
  return sqlite3_column_double(statement_, column);
}

std::string Query::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  return text
             ? std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)))
             : std::string();
}

std::span<const std::uint8_t> Query::bytes(int column) const {
  const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_, column));
  return {bytes, bytes ? static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)) : 0};
}

void Query::bind_one(int index, std::span<const std::uint8_t> bytes) {
  check(sqlite3_bind_blob64(statement_, index, bytes.data(), bytes.size(), SQLITE_STATIC));
}

void Query::bind_bytes(int index, const std::vector<std::uint8_t>& bytes) {
  static constexpr std::uint8_t nothing = 0;  // a null pointer would be NULL
  bind_one(index, std::span(bytes.empty() ? &nothing : bytes.data(), bytes.size()));
}

void Query::bind_one(int index, double value) {
  std::isnan(value) ? bind_null(index) : check(sqlite3_bind_double(statement_, index, value));
}

void Query::bind_one(int index, std::int64_t value) {
  check(sqlite3_bind_int64(statement_, index, value));
}

void Query::bind_null(int index) {
  check(sqlite3_bind_null(statement_, index));
}

void Query::bind_one(int index, std::string_view text) {
  check(sqlite3_bind_text64(statement_, index, text.empty() ? "" : text.data(), text.size(),
                            SQLITE_TRANSIENT, SQLITE_UTF8));
}

Connection::Connection(const std::string& name, const std::filesystem::path& path, int flags) {
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(name.c_str(), &handle,
                                   flags | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE, nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) fail_on(handle, code, path.string());
  // A damaged length must not take all memory. Nothing that is written comes near it.
  sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, most_bytes_of_value);
  sqlite3_busy_timeout(handle, busy_timeout_ms);
  sqlite3_rollback_hook(
      handle, [](void* count) { ++*static_cast<std::uint64_t*>(count); }, rollbacks_.get());
}

std::string Connection::path() const {
  const char* path = sqlite3_db_filename(handle_.get(), "main");
  return path ? path : "";
}

void Connection::execute(const std::string& sql) {
  const int code = sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(handle_.get(), code);
}

sqlite3_stmt* Connection::prepared(std::string_view sql) {
  Statement& kept = statements_[std::string(sql)];
  if (!kept) {
    sqlite3_stmt* statement = nullptr;
    const int code = sqlite3_prepare_v3(handle_.get(), sql.data(), static_cast<int>(sql.size()),
                                        SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
    kept.reset(statement);
    if (code != SQLITE_OK) fail(handle_.get(), code);
  }
  return kept.get();
}

void Connection::fail_out_of_order(std::string_view table) const {
  throw Error(Error::Kind::corrupt, "database " + path() + " has rows of the table " +
                                        std::string(table) +
                                        " out of order: restore a backup, or see what 'reident "
                                        "verify' says");
}

sqlite3_file* Connection::file() const {
  sqlite3_file* file = nullptr;
  sqlite3_file_control(handle_.get(), "main", SQLITE_FCNTL_FILE_POINTER, &file);
  return file;
}

std::int64_t Connection::raw_size() const {
  sqlite3_int64 size = 0;
  const int code = file()->pMethods->xFileSize(file(), &size);
  if (code != SQLITE_OK) fail(handle_.get(), code);
  return size;
}

std::size_t Connection::read_raw(std::span<unsigned char> bytes) const {
  const std::size_t count = std::min(bytes.size(), static_cast<std::size_t>(raw_size()));
  const int code = file()->pMethods->xRead(file(), bytes.data(), static_cast<int>(count), 0);
  if (code != SQLITE_OK) fail(handle_.get(), code);
  return count;
}

std::uint32_t Connection::copied_frames() const {
  constexpr int region_bytes = 32'768;
  constexpr std::size_t place = 96;
  sqlite3_file* const database = file();
  volatile void* index = nullptr;
  const int code = database->pMethods->xShmMap(database, 0, region_bytes, 0, &index);
  if (code != SQLITE_OK) fail(handle_.get(), code);
  if (!index) return 0;
  return *reinterpret_cast<const volatile std::uint32_t*>(
      static_cast<const volatile unsigned char*>(index) + place);
}

void Connection::keep_log() {
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
}

ReadTransaction::ReadTransaction(Connection& connection)
    : connection_(connection), is_part_(connection.in_transaction()) {
  if (!is_part_) connection_.query("BEGIN").run();
}

ReadTransaction::~ReadTransaction() {
  if (is_part_ || !connection_.in_transaction()) return;
  try {
    connection_.query("COMMIT").run();
  } catch (const Error&) {
    // Nothing was written.
  }
}

Transaction::Transaction(Connection& connection)
    : connection_(connection), is_part_(connection.in_transaction()) {
  if (!is_part_) connection_.check_files();
  if (!is_part_) connection_.query("BEGIN IMMEDIATE").run();
}

Transaction::~Transaction() {
  // A failure such as a full disk may have rolled back already.
  if (is_part_ || !connection_.in_transaction()) return;
  try {
    connection_.query("ROLLBACK").run();
  } catch (const Error&) {
    // The file is as it was: an uncommitted transaction never counts.
  }
}

void Transaction::commit() {
  if (!is_part_) connection_.query("COMMIT").run();
}

}  // namespace reident::storage::sqlite
