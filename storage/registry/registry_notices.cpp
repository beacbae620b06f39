// What the service noticed: alarms, changes of equipment, what simulators run.
#include "storage/database/connection.hpp"
#include "storage/registry/registry.hpp"

namespace reident::storage {
namespace {

constexpr std::string_view service = "service";  // as who raises and clears

void add_alarm(sqlite::Connection& connection, std::string_view kind, std::string_view actor,
               const Alarm& alarm) {
  connection
      .query(
          "INSERT INTO alarm (code, spacecraft, equipment, kind, actor, text, time) "
          "VALUES (?, ?, ?, ?, ?, ?, ?)")
      .run(alarm.code, alarm.about.spacecraft, alarm.about.equipment, kind, actor, alarm.text,
           alarm.since);
}

/// The text of an alarm that is raised.
std::optional<std::string> raised(sqlite::Connection& connection, const std::string& code,
                                  const EquipmentName& about) {
  sqlite::Query row = connection.query(
      "SELECT text FROM alarm_now WHERE code = ? AND spacecraft = ? AND equipment = ?", code,
      about.spacecraft, about.equipment);
  return row.step() ? std::optional(row.text(0)) : std::nullopt;
}

}  // namespace

void Registry::raise(const Alarm& alarm) {
  sqlite::Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  if (raised(db, alarm.code, alarm.about) == alarm.text) return;
  add_alarm(db, "raise", service, alarm);
  transaction.commit();
}

void Registry::clear(const std::string& code, const EquipmentName& about, Time time) {
  sqlite::Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  if (!raised(db, code, about)) return;
  add_alarm(db, "clear", service, {code, about, "", time});
  transaction.commit();
}

bool Registry::acknowledge(const std::string& code, const EquipmentName& about,
                           const std::string& actor, const std::string& reason, Time time) {
  sqlite::Connection& db = connection(database_);
  sqlite::Transaction transaction(db);
  if (!raised(db, code, about)) return false;
  add_alarm(db, "acknowledge", actor, {code, about, reason, time});
  transaction.commit();
  return true;
}

std::vector<Alarm> Registry::alarms() const {
  std::vector<Alarm> alarms;
  sqlite::Query row = connection(database_).query(
      "SELECT code, spacecraft, equipment, text, since, acknowledged_by FROM alarm_now "
      "ORDER BY code, spacecraft, equipment");
  while (row.step())
    alarms.push_back(
        {row.text(0), {row.text(1), row.text(2)}, row.text(3), row.integer(4), row.text(5)});
  return alarms;
}

void Registry::record_change(const EquipmentName& equipment, const FoundChange& change, Time time) {
  connection(database_)
      .query(
          "INSERT INTO change (spacecraft, equipment, champion, since, found, time) "
          "SELECT ?1, ?2, ?3, ?4, ?5, ?6 WHERE NOT EXISTS "
          "(SELECT 1 FROM change WHERE spacecraft = ?1 AND equipment = ?2 AND champion = ?3 "
          " AND since = ?4 AND found = ?5)")
      .run(equipment.spacecraft, equipment.equipment, change.champion, change.since, change.found,
           time);
}

std::optional<FoundChange> Registry::last_change(const EquipmentName& equipment) const {
  sqlite::Query row = connection(database_).query(
      "SELECT champion, since, found FROM change WHERE spacecraft = ? AND equipment = ? "
      "ORDER BY id DESC LIMIT 1",
      equipment.spacecraft, equipment.equipment);
  if (!row.step()) return std::nullopt;
  return FoundChange{row.integer(0), row.integer(1), row.integer(2)};
}

void Registry::record_simulator(const SimulatorState& state) {
  connection(database_)
      .query(
          "INSERT INTO simulator (name, spacecraft, equipment, is_there, version, offered, "
          "refused, reason, mode, from_cache, since, error_before, host, process, program_version, "
          "time) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .run(state.simulator, state.equipment.spacecraft, state.equipment.equipment, state.is_there,
           state.version, state.offered, state.refused, state.reason, state.mode, state.from_cache,
           state.since, state.error_before_percent, state.host, state.process,
           state.program_version, state.time);
}

std::vector<SimulatorState> Registry::simulators() const {
  std::vector<SimulatorState> simulators;
  sqlite::Query row = connection(database_).query(
      "SELECT simulator, spacecraft, equipment, version, offered, refused, reason, mode, "
      "from_cache, since, host, process, program_version, time FROM simulator_now "
      "ORDER BY simulator, spacecraft, equipment");
  while (row.step()) {
    SimulatorState& state = simulators.emplace_back();
    state.simulator = row.text(0);
    state.equipment = {row.text(1), row.text(2)};
    state.version = row.integer(3);
    state.offered = row.integer(4);
    state.refused = row.integer(5);
    state.reason = row.text(6);
    state.mode = row.text(7);
    state.from_cache = row.integer(8) != 0;
    state.since = row.integer(9);
    state.host = row.text(10);
    state.process = row.integer<std::uint64_t>(11);
    state.program_version = row.text(12);
    state.time = row.integer(13);
  }
  return simulators;
}

}  // namespace reident::storage
