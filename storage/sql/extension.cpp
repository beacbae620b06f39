// Entry of the loadable extension: the sqlite3 shell's `.load ./reident_telemetry`.
#include "storage/sql/sqlite_api.hpp"
#include "storage/sql/summary_table.hpp"
#include "storage/sql/telemetry_table.hpp"

extern "C" {

SQLITE_EXTENSION_INIT1

// The name that SQLite makes of the file's.
__attribute__((visibility("default"))) int sqlite3_reidenttelemetry_init(
    sqlite3* connection, char** message, const sqlite3_api_routines* api) {
  SQLITE_EXTENSION_INIT2(api);
  constexpr int oldest = 3038000;  // lists of an IN are read as a whole since then
  if (sqlite3_libversion_number() < oldest) {
    *message = sqlite3_mprintf("reident_telemetry needs SQLite 3.38 or newer, this is %s",
                               sqlite3_libversion());
    return SQLITE_ERROR;
  }
  const int code = reident::storage::sql::add_telemetry_table(connection);
  return code != SQLITE_OK ? code : reident::storage::sql::add_summary_table(connection);
}
}
