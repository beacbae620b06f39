// When the log of a database is folded into its file and begun again. Private to storage.
#pragma once

#include <sqlite3.h>

namespace reident::storage::sqlite {

/// Readers never wait but for moments such as a recovery after a crash.
constexpr int busy_timeout_ms = 5000;

/// Folds the log of a connection after each commit that finds it long, for as long as it exists.
///
/// SQLite begins the log again only while nobody reads from it: readers that overlap without end
/// would let it grow without end. So from a length on the writer waits for those who read just
/// then. Whoever begins meanwhile reads from the file, and is not waited for. A reader that stays
/// longer than the writer waits is waited for again once the log has doubled, so that it costs
/// little.
class LogFolding {
 public:
  /// `wait`: for readers, at most [ms]. Those of the page end within a second (service/web).
  explicit LogFolding(sqlite3* connection, int wait = 1000);
  LogFolding(const LogFolding&) = delete;
  LogFolding& operator=(const LogFolding&) = delete;

 private:
  static int committed(void* self, sqlite3* connection, const char* schema, int pages);

  int wait_for_readers(sqlite3* connection, const char* schema) const;

  int wait_;
  int waits_at_;  // pages of the log
};

}  // namespace reident::storage::sqlite
