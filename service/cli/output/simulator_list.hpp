// Who runs which version: what simulators acknowledge, and what the service publishes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "service/model/messages.hpp"

namespace reident::cli {

/// What the service publishes of an equipment now.
struct PublishedVersion {
  std::int64_t number = 0;
  storage::Time decided = 0;  // since when it is champion
  std::string digest;
};

/// What was heard in a partition.
struct PartitionSurvey {
  std::vector<ModelAcknowledgement> simulators;
  std::map<storage::EquipmentName, PublishedVersion> champions;
  std::size_t services = 0;            // that publish versions; 0: the champions are not known
  std::set<std::string> spacecraft{};  // that they keep; empty: not known
  bool misses_security = false;  // others are secured and the survey is not: it heard none of them
};

enum class SimulatorState {
  current,      // runs the champion
  old,          // runs an older version than the champion
  rolled_back,  // runs a newer one than the champion: it has not followed a rollback yet
  different,    // runs the champion's number with another content
  unpublished,  // a service is there and publishes no version of the equipment
  from_file,    // runs what it kept from an earlier run, and no service is there
  unknown,      // no service is there
  not_running,
};

/// As --json says it.
const char* name(SimulatorState state);

/// One simulator and equipment.
struct SimulatorRow {
  ModelAcknowledgement said;
  std::optional<PublishedVersion> champion;
  SimulatorState state = SimulatorState::unknown;
  /// Whether what runs is not what the champion is; false where that is not known.
  bool is_old() const;
  /// The state in words, with what was refused or offered.
  std::string text() const;
};

/// Sorted by simulator, spacecraft and equipment. An empty name selects every one. What a simulator
/// of several spacecraft runs of others than the services' is in their own partitions.
std::vector<SimulatorRow> list_simulators(const PartitionSurvey& sight,
                                          const storage::EquipmentName& wanted);

}  // namespace reident::cli
