// What each simulator runs, from its acknowledgements: the changes of it are rows of the registry.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "service/model/messages.hpp"
#include "service/support/mutex.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident {

/// Any thread may call it. Times are those of the service's clock.
class SimulatorBook {
 public:
  /// `known`: those that an earlier run of the service left. Who is not heard of within ten seconds
  /// from `now` has left.
  SimulatorBook(const std::vector<storage::SimulatorState>& known, storage::Time now);

  /// What a simulator said. True where that is a change, and not its running error alone.
  bool hear(const ModelAcknowledgement& said, storage::Time now);
  /// It ended, or was not heard of any more. Of `said` the names count.
  void leave(const ModelAcknowledgement& said, storage::Time now);

  /// The changes that were not handed out yet, oldest first. Whoever cannot keep them gives them
  /// back.
  std::vector<storage::SimulatorState> take_changes(storage::Time now);
  void give_back(std::vector<storage::SimulatorState> changes);

  /// The simulators that are there, by name and equipment.
  std::vector<storage::SimulatorState> present() const;

 private:
  using Key = std::pair<std::string, storage::EquipmentName>;
  struct Entry {
    storage::SimulatorState state;
    double error_percent = 0;  // that the state has come to; not a number without one
    bool is_heard = false;     // in this run of the service
  };
  void end(std::map<Key, Entry>::iterator entry, storage::Time now) REIDENT_REQUIRES(mutex_);

  mutable Mutex mutex_;
  const storage::Time started_;
  std::map<Key, Entry> entries_ REIDENT_GUARDED_BY(mutex_);
  std::vector<storage::SimulatorState> changes_ REIDENT_GUARDED_BY(mutex_);
  bool are_all_heard_ REIDENT_GUARDED_BY(mutex_) = false;
};

}  // namespace reident
