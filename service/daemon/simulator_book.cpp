#include "service/daemon/simulator_book.hpp"

#include <limits>
#include <tuple>

namespace reident {
namespace {

using storage::SimulatorState;

constexpr storage::Time return_time = 10'000'000'000;  // of those that an earlier run knew

SimulatorState state_of(const ModelAcknowledgement& said, storage::Time now) {
  SimulatorState state;
  state.simulator = said.simulator;
  state.equipment = {said.spacecraft, said.equipment};
  state.version = said.running.version;
  state.offered = said.running.offered_version;
  if (!said.accepted) {
    state.refused = said.version;
    state.reason = said.reason;
  }
  state.mode = said.running.mode;
  state.from_cache = said.running.from_cache;
  state.since = said.running.since;
  state.host = said.host;
  state.process = said.process;
  state.program_version = said.program_version;
  state.time = now;
  return state;
}

/// What a change is a change of: `since` and `time` follow from it.
auto contents(const SimulatorState& state) {
  return std::tie(state.version, state.offered, state.refused, state.reason, state.mode,
                  state.from_cache, state.host, state.process, state.program_version);
}

}  // namespace

SimulatorBook::SimulatorBook(const std::vector<SimulatorState>& known, storage::Time now)
    : started_(now) {
  for (const SimulatorState& state : known)
    entries_[{state.simulator, state.equipment}] = {state, std::numeric_limits<double>::quiet_NaN(),
                                                    false};
}

bool SimulatorBook::hear(const ModelAcknowledgement& said, storage::Time now) {
  const MutexLock lock(mutex_);
  SimulatorState state = state_of(said, now);
  const auto [place, is_new] = entries_.try_emplace({state.simulator, state.equipment});
  Entry& entry = place->second;
  const bool is_change = is_new || contents(entry.state) != contents(state);
  if (is_change) {
    if (!is_new) state.error_before_percent = entry.error_percent;
    entry.state = state;
    changes_.push_back(std::move(state));
  }
  entry.error_percent = said.running.mrse_percent;
  entry.is_heard = true;
  return is_change;
}

void SimulatorBook::leave(const ModelAcknowledgement& said, storage::Time now) {
  const MutexLock lock(mutex_);
  const auto entry = entries_.find({said.simulator, {said.spacecraft, said.equipment}});
  if (entry != entries_.end()) end(entry, now);
}

void SimulatorBook::end(std::map<Key, Entry>::iterator entry, storage::Time now) {
  SimulatorState state = std::move(entry->second.state);
  state.is_there = false;
  state.error_before_percent = entry->second.error_percent;
  state.time = now;
  changes_.push_back(std::move(state));
  entries_.erase(entry);
}

std::vector<SimulatorState> SimulatorBook::take_changes(storage::Time now) {
  const MutexLock lock(mutex_);
  if (!are_all_heard_ && now - started_ > return_time) {
    are_all_heard_ = true;
    for (auto entry = entries_.begin(); entry != entries_.end();) {
      const auto one = entry++;
      if (!one->second.is_heard) end(one, now);
    }
  }
  return std::exchange(changes_, {});
}

void SimulatorBook::give_back(std::vector<SimulatorState> changes) {
  const MutexLock lock(mutex_);
  changes_.insert(changes_.begin(), std::make_move_iterator(changes.begin()),
                  std::make_move_iterator(changes.end()));
}

std::vector<SimulatorState> SimulatorBook::present() const {
  const MutexLock lock(mutex_);
  std::vector<SimulatorState> present;
  for (const auto& [key, entry] : entries_) present.push_back(entry.state);
  return present;
}

}  // namespace reident
