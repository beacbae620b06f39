// What operators leave in the registry apart from decisions: holds, and their commands with the
// replies.
#include "storage/database/connection.hpp"
#include "storage/registry/registry.hpp"

namespace reident::storage {
namespace {

void add_hold(sqlite::Connection& connection, const std::string& spacecraft,
              const std::string& equipment, std::string_view kind, const Hold& hold) {
  connection
      .query(
          "INSERT INTO hold (spacecraft, equipment, kind, actor, reason, time) "
          "VALUES (?, ?, ?, ?, ?, ?)")
      .run(spacecraft, equipment, kind, hold.actor, hold.reason, hold.since);
}

constexpr std::string_view command_rows =
    "SELECT requester, request, action, spacecraft, equipment, version, actor, reason, time, ok, "
    "reply FROM command ";

// The table keeps a request's number with the same bits as a signed one.
KeptCommand command_in(const sqlite::Query& row) {
  return {{.requester = row.text(0),
           .request = row.integer<std::uint64_t>(1),
           .action = row.text(2),
           .spacecraft = row.text(3),
           .equipment = row.text(4),
           .version = row.integer(5),
           .actor = row.text(6),
           .reason = row.text(7)},
          row.integer(8),
          {.ok = row.integer(9) != 0, .reply = row.text(10)}};
}

std::optional<KeptCommand> kept_command(sqlite::Connection& connection, const Command& asked) {
  sqlite::Query row =
      connection.query(std::string(command_rows) + "WHERE requester = ? AND request = ?",
                       asked.requester, asked.request);
  if (!row.step()) return std::nullopt;
  return command_in(row);
}

void keep_command(sqlite::Connection& connection, const Command& command,
                  const CommandOutcome& outcome, Time time) {
  connection
      .query(
          "INSERT INTO command (requester, request, action, spacecraft, equipment, version, actor, "
          "reason, time, ok, reply) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .run(command.requester, command.request, command.action, command.spacecraft,
           command.equipment, command.version, command.actor, command.reason, time, outcome.ok,
           outcome.reply);
}

}  // namespace

std::optional<Hold> Registry::hold(const std::string& spacecraft,
                                   const std::string& equipment) const {
  sqlite::Query row = connection(database_).query(
      "SELECT actor, reason, since FROM hold_now WHERE spacecraft = ? AND equipment = ?",
      spacecraft, equipment);
  if (!row.step()) return std::nullopt;
  return Hold{row.text(0), row.text(1), row.integer(2)};
}

void Registry::put_on_hold(const std::string& spacecraft, const std::string& equipment,
                           const Hold& hold) {
  sqlite::Transaction transaction(connection(database_));
  if (this->hold(spacecraft, equipment))
    throw Error(Error::Kind::failed, equipment + " of " + spacecraft + " is held already");
  add_hold(connection(database_), spacecraft, equipment, "hold", hold);
  transaction.commit();
}

void Registry::release(const std::string& spacecraft, const std::string& equipment,
                       const Hold& release) {
  sqlite::Transaction transaction(connection(database_));
  if (!hold(spacecraft, equipment))
    throw Error(Error::Kind::failed, equipment + " of " + spacecraft + " is not held");
  add_hold(connection(database_), spacecraft, equipment, "release", release);
  transaction.commit();
}

CommandOutcome Registry::execute(const Command& command, Time time,
                                 const std::function<CommandOutcome()>& effect) {
  sqlite::Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  if (const auto kept = kept_command(db, command)) {
    if (kept->command == command) return kept->outcome;
    return {false, "request " + std::to_string(command.request) + " of " + command.requester +
                       " was another command (" + kept->command.action +
                       "): give each command a number of its own"};
  }
  const CommandOutcome outcome = effect();
  keep_command(db, command, outcome, time);
  transaction.commit();
  return outcome;
}

std::vector<KeptCommand> Registry::commands(TimeRange range, std::size_t count) const {
  std::vector<KeptCommand> found;
  sqlite::Query row = connection(database_).query(
      std::string(command_rows) + "WHERE time >= ? AND time < ? ORDER BY id DESC LIMIT ?",
      range.begin, range.end, static_cast<std::int64_t>(count));
  while (row.step()) found.push_back(command_in(row));
  return found;
}

}  // namespace reident::storage
