// The part of SQLite's C API that storage uses, with owners for its handles. Private to storage.
//
// Failures are thrown as storage::Error with the file and the remedy. A connection keeps every
// statement that it prepared; a Query borrows one and gives it back clean.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <variant>
#include <vector>

#include <sqlite3.h>

#include "storage/database/database.hpp"
#include "storage/database/file_guard.hpp"
#include "storage/database/log_folding.hpp"

namespace reident::storage::sqlite {

/// Throws the Error that fits `code`, which a call on `connection` returned.
[[noreturn]] void fail(sqlite3* connection, int code);

/// Name of a file, for SQLITE_OPEN_URI, that is read as one that does not change: no log, no locks.
std::string immutable_uri(const std::filesystem::path& path);

/// What a column holds, of whatever type; nothing stands for NULL.
using Value =
    std::variant<std::monostate, std::int64_t, double, std::string, std::vector<std::uint8_t>>;

/// A statement in use: bound by position, stepped, read. It is reset when the Query ends.
class Query {
 public:
  template <typename... Values>
  explicit Query(sqlite3_stmt* statement, const Values&... values) : statement_(statement) {
    bind(values...);
  }
  ~Query();
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  /// Binds all parameters in their order; starts the statement again if it ran already.
  template <typename... Values>
  Query& bind(const Values&... values) {
    sqlite3_reset(statement_);
    int index = 0;
    (bind_one(++index, values), ...);
    return *this;
  }
  /// True while there is a row to read.
  bool step();
  /// For statements that give no row; without values with those bound. Returns how many rows it
  /// changed.
  template <typename... Values>
  std::int64_t run(const Values&... values) {
    bind(values...);
    return run_bound();
  }

  /// As run(), with values whose types are known at run time alone.
  std::int64_t run(const std::vector<Value>& values);

  bool is_null(int column) const;
  int columns() const { return sqlite3_column_count(statement_); }
  Value value(int column) const;
  double real(int column) const;
  std::string text(int column) const;
  /// Valid until the next step.
  std::span<const std::uint8_t> bytes(int column) const;
  template <typename T = std::int64_t>
  T integer(int column) const {
    return static_cast<T>(sqlite3_column_int64(statement_, column));
  }

 private:
  void bind_one(int index, double value);  // NaN becomes NULL: SQLite has no NaN
  void bind_one(int index, std::string_view text);
  void bind_one(int index, std::int64_t value);
  void bind_one(int index, std::span<const std::uint8_t> bytes);       // not copied
  void bind_bytes(int index, const std::vector<std::uint8_t>& bytes);  // not copied
  void bind_null(int index);
  template <typename T>
  void bind_one(int index, const std::optional<T>& value) {
    value ? bind_one(index, *value) : bind_null(index);
  }
  template <typename T>
  requires std::is_enum_v<T> ||
      (std::is_integral_v<T> && !std::is_same_v<T, std::int64_t>)void bind_one(int index, T value) {
    bind_one(index, static_cast<std::int64_t>(value));
  }
  std::int64_t run_bound();
  void check(int code) const;

  sqlite3_stmt* statement_;
};

/// One open file.
class Connection {
 public:
  /// `name` is a path or, with SQLITE_OPEN_URI in `flags`, a URI; `path` is for messages.
  Connection(const std::string& name, const std::filesystem::path& path, int flags);

  /// Runs statements that give no rows and are not worth keeping.
  void execute(const std::string& sql);
  /// Prepares `sql` once and keeps it. Its text must not be in use by another Query.
  template <typename... Values>
  Query query(std::string_view sql, const Values&... values) {
    return Query(prepared(sql), values...);
  }
  std::int64_t last_id() const { return sqlite3_last_insert_rowid(handle_.get()); }
  bool is_read_only() const { return sqlite3_db_readonly(handle_.get(), "main") == 1; }
  std::string path() const;
  /// Grows with each transaction that was rolled back: what is known of the file by then may be
  /// wrong.
  std::uint64_t rollbacks() const { return *rollbacks_; }
  bool in_transaction() const { return sqlite3_get_autocommit(handle_.get()) == 0; }
  sqlite3* handle() { return handle_.get(); }
  /// Throws Error corrupt: a statement that goes through `table` by its keys was not given a later
  /// one, as by a key that is no integer, and would never end.
  [[noreturn]] void fail_out_of_order(std::string_view table) const;

  /// The first bytes of the file as they are on the disk, past cache and log; the number of those
  /// that there are. Through SQLite's own handle of the file: closing any other one would take
  /// away the locks that this process's connections hold on it.
  std::size_t read_raw(std::span<unsigned char> bytes) const;
  std::int64_t raw_size() const;
  /// How many frames of the log SQLite takes for copied into the file and never copies again:
  /// nBackfill in the index of the log (https://www.sqlite.org/walformat.html, 2.1.2). In WAL mode.
  std::uint32_t copied_frames() const;

  /// From now on Transaction checks the files before it begins.
  void guard_files(const std::filesystem::path& database) { guard_.emplace(database); }
  void check_files() {
    if (guard_) guard_->check(*this);
  }
  /// From now on each commit that finds the log long folds it into the file.
  void fold_log() { folding_ = std::make_unique<LogFolding>(handle_.get()); }
  /// The log is left next to the file when the connection closes.
  void keep_log();

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }
  };
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;
  sqlite3_stmt* prepared(std::string_view sql);
  sqlite3_file* file() const;

  std::unique_ptr<std::uint64_t> rollbacks_ = std::make_unique<std::uint64_t>(0);
  std::unique_ptr<LogFolding> folding_;
  std::unique_ptr<sqlite3, Close> handle_;
  std::optional<FileGuard> guard_;
  std::unordered_map<std::string, Statement> statements_;
};

/// One snapshot for all that is read until it ends; within another transaction, that one's.
class ReadTransaction {
 public:
  explicit ReadTransaction(Connection& connection);
  ~ReadTransaction();
  ReadTransaction(const ReadTransaction&) = delete;
  ReadTransaction& operator=(const ReadTransaction&) = delete;

 private:
  Connection& connection_;
  const bool is_part_;
};

/// Rolls back unless it was committed. Within another one on the same connection it is a part of
/// that one, which commits or rolls back all.
class Transaction {
 public:
  explicit Transaction(Connection& connection);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Connection& connection_;
  const bool is_part_;
};

}  // namespace reident::storage::sqlite
