// What the service notices about itself and around it, kept in the registry: alarms, and what
// simulators run.
#pragma once

#include <future>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "service/config/config.hpp"
#include "service/daemon/archive_writer.hpp"
#include "service/daemon/pair.hpp"
#include "service/daemon/publisher.hpp"
#include "service/daemon/repeated_error.hpp"
#include "service/daemon/simulator_book.hpp"
#include "service/daemon/telemetry_watch.hpp"
#include "service/dds/dds.hpp"

namespace reident {

/// One thread, which looks once a second. What it is made of must outlive it.
class ServiceWatch {
 public:
  struct Parts {
    const Config& config;
    Clock clock, uptime;
    storage::Time started;
    dds::Participant& participant;
    ArchiveWriter& writer;
    TelemetryWatch& telemetry;
    SimulatorBook& simulators;
    const Publisher& publisher;
    std::string damage;          // what is damaged in the file already; empty: nothing
    const Pair* pair = nullptr;  // that the service is of; null: of none
  };
  /// Throws dds::Error.
  explicit ServiceWatch(Parts parts);

  /// Finds what is wrong and has the registry keep what is news. An alarm that cannot be kept, as
  /// on a full disk, is tried again at the next look, and the log says why.
  void look();

  /// What look() found, one alarm a line: "code SPACECRAFT/EQUIPMENT: text"; as many as a status
  /// has room for, and how many more there are.
  std::string text() const;

 private:
  void log_a_set_clock();
  void hear_services();
  std::vector<storage::Alarm> services() const;
  std::vector<storage::Alarm> disk_and_damage() const;
  std::vector<storage::Alarm> old_simulators();
  std::vector<storage::Alarm> certificate() const;
  void keep(std::vector<storage::SimulatorState> changes);
  void let_partner_keep();

  Parts parts_;
  dds::Reader<ServiceStatus> statuses_;
  std::optional<storage::Time> booted_;  // UTC at which the uptime is 0
  struct Other {
    ServiceStatus status;
    storage::Time heard = 0;  // of the uptime
  };
  std::map<std::pair<std::string, storage::Time>, Other> others_;  // by name and start
  /// Since when, of the uptime, a simulator runs another version than the champion.
  std::map<std::pair<std::string, storage::EquipmentName>, storage::Time> old_since_;
  std::vector<storage::Alarm> alarms_;
  std::optional<std::vector<storage::Alarm>> kept_;  // those that the registry has, once known
  /// What the registry's thread was given and may not have written yet.
  std::future<void> posted_;
  std::vector<storage::Alarm> posted_alarms_;
  std::vector<storage::SimulatorState> posted_changes_;
  RepeatedError failure_;  // to record them
};

}  // namespace reident
