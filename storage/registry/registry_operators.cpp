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

// The table keeps a request's number with the same bits as a signed one.
struct StoredCommand {
  Command command;
  CommandOutcome outcome;
};

std::optional<StoredCommand> kept_command(sqlite::Connection& connection, const Command& asked) {
  sqlite::Query row = connection.query(
      "SELECT action, spacecraft, equipment, version, actor, reason, ok, reply FROM command "
      "WHERE requester = ? AND request = ?",
      asked.requester, asked.request);
  if (!row.step()) return std::nullopt;
  return StoredCommand{{.requester = asked.requester,
                        .request = asked.request,
                        .action = row.text(0),
                        .spacecraft = row.text(1),
                        .equipment = row.text(2),
                        .version = row.integer(3),
                        .actor = row.text(4),
                        .reason = row.text(5)},
                       {.ok = row.integer(6) != 0, .reply = row.text(7)}};
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

}  // namespace reident::storage
