#include "storage/database/log_folding.hpp"

#include <limits>

namespace reident::storage::sqlite {
namespace {

constexpr int folded_at = 4096;      // pages of 4 KiB
constexpr int first_wait_at = 8192;  // 64 MiB are kept of a log, twice as much
constexpr int moment_ms = 50;

}  // namespace

LogFolding::LogFolding(sqlite3* connection, int wait) : wait_(wait), waits_at_(first_wait_at) {
  sqlite3_wal_hook(connection, committed, this);
}

// SQLite waits for the mark of a reader, which others may take over meanwhile and hold in turn. So
// it waits for a moment only, and looks again.
int LogFolding::wait_for_readers(sqlite3* connection, const char* schema) const {
  sqlite3_busy_timeout(connection, moment_ms);
  int code = SQLITE_BUSY;
  for (int waited = 0; waited < wait_ && code == SQLITE_BUSY; waited += moment_ms)
    code =
        sqlite3_wal_checkpoint_v2(connection, schema, SQLITE_CHECKPOINT_RESTART, nullptr, nullptr);
  sqlite3_busy_timeout(connection, busy_timeout_ms);
  return code;
}

// A failure is no failure of the commit: the log has it, and the next commit tries again.
int LogFolding::committed(void* self, sqlite3* connection, const char* schema, int pages) {
  auto& folding = *static_cast<LogFolding*>(self);
  int& waits_at = folding.waits_at_;
  if (pages < first_wait_at) waits_at = first_wait_at;
  if (pages >= waits_at) {
    const bool is_begun_again = folding.wait_for_readers(connection, schema) == SQLITE_OK;
    waits_at = is_begun_again                                   ? first_wait_at
               : waits_at < std::numeric_limits<int>::max() / 2 ? 2 * waits_at
                                                                : waits_at;
  } else if (pages >= folded_at) {
    sqlite3_wal_checkpoint_v2(connection, schema, SQLITE_CHECKPOINT_PASSIVE, nullptr, nullptr);
  }
  return SQLITE_OK;
}

}  // namespace reident::storage::sqlite
