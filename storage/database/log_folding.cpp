#include "storage/database/log_folding.hpp"

#include <limits>

namespace reident::storage::sqlite {
namespace {

constexpr int folded_at = 4096;      // pages of 4 KiB
constexpr int first_wait_at = 8192;  // 64 MiB are kept of a log, twice as much
constexpr int wait_ms = 1000;        // the page's readers end within (service/web)

int wait_for_readers(sqlite3* connection, const char* schema) {
  sqlite3_busy_timeout(connection, wait_ms);
  const int code =
      sqlite3_wal_checkpoint_v2(connection, schema, SQLITE_CHECKPOINT_RESTART, nullptr, nullptr);
  sqlite3_busy_timeout(connection, busy_timeout_ms);
  return code;
}

}  // namespace

LogFolding::LogFolding(sqlite3* connection) : waits_at_(first_wait_at) {
  sqlite3_wal_hook(connection, committed, this);
}

// A failure is no failure of the commit: the log has it, and the next commit tries again.
int LogFolding::committed(void* self, sqlite3* connection, const char* schema, int pages) {
  int& waits_at = static_cast<LogFolding*>(self)->waits_at_;
  if (pages < first_wait_at) waits_at = first_wait_at;
  if (pages >= waits_at) {
    const bool is_begun_again = wait_for_readers(connection, schema) == SQLITE_OK;
    waits_at = is_begun_again                                   ? first_wait_at
               : waits_at < std::numeric_limits<int>::max() / 2 ? 2 * waits_at
                                                                : waits_at;
  } else if (pages >= folded_at) {
    sqlite3_wal_checkpoint_v2(connection, schema, SQLITE_CHECKPOINT_PASSIVE, nullptr, nullptr);
  }
  return SQLITE_OK;
}

}  // namespace reident::storage::sqlite
