#include "storage/registry/kept_commands.hpp"

#include "storage/database/connection.hpp"

namespace reident::storage {

std::vector<KeptCommand> kept_commands(const Database& database, TimeRange range,
                                       std::size_t most) {
  std::vector<KeptCommand> kept;
  sqlite::Query row = connection(database).query(
      "SELECT requester, action, spacecraft, equipment, version, actor, reason, time, ok, reply "
      "FROM command WHERE time >= ? AND time < ? ORDER BY id DESC LIMIT ?",
      range.begin, range.end, static_cast<std::int64_t>(most));
  while (row.step())
    kept.push_back({{.requester = row.text(0),
                     .request = 0,
                     .action = row.text(1),
                     .spacecraft = row.text(2),
                     .equipment = row.text(3),
                     .version = row.integer(4),
                     .actor = row.text(5),
                     .reason = row.text(6)},
                    row.integer(7),
                    {.ok = row.integer(8) != 0, .reply = row.text(9)}});
  return kept;
}

}  // namespace reident::storage
