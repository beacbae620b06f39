#include "service/cli/partition_survey.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "service/cli/service_choice.hpp"
#include "service/history/remote_readers.hpp"
#include "service/support/text.hpp"

namespace reident::cli {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto settled = 1s;
constexpr auto settled_without = 2s;     // to conclude that nobody is there
constexpr auto writers_interval = 20ms;  // for writers: the wait set wakes for samples
constexpr std::size_t messages_at_most = 1024;

ModelAcknowledgement acknowledgement_of(const storage::SimulatorState& state) {
  ModelAcknowledgement said;
  said.simulator = state.simulator;
  said.spacecraft = state.equipment.spacecraft;
  said.equipment = state.equipment.equipment;
  said.accepted = state.refused == 0;
  said.version = said.accepted ? state.version : state.refused;
  said.reason = state.reason;
  said.running.version = state.version;
  said.running.offered_version = state.offered;
  said.running.mode = state.mode;
  said.running.from_cache = state.from_cache;
  said.running.since = state.since;
  said.host = state.host;
  said.process = state.process;
  said.program_version = state.program_version;
  return said;
}

class Listener {
 public:
  explicit Listener(const dds::Endpoint& endpoint)
      : participant_(endpoint),
        acknowledgements_(participant_),
        versions_(participant_),
        heartbeats_(participant_),
        ready_(participant_) {
    ready_.attach(acknowledgements_);
    ready_.attach(versions_);
    ready_.attach(heartbeats_);
  }

  /// Waits a moment and takes what came. Returns how much is known: writers, simulators, champions,
  /// services.
  std::array<std::size_t, 5> look(Clock::duration limit) {
    ready_.wait(std::min<Clock::duration>(limit, writers_interval));
    acknowledgements_.take(messages_at_most, [this](ModelAcknowledgement&& said) {
      simulators_[{said.simulator, said.spacecraft, said.equipment}] = std::move(said);
    });
    const auto note = [this](const ModelVersion& version) {
      if (version.number < 1) return;
      champions_[{version.model.spacecraft, version.model.equipment}] = {
          version.number, version.decided, version.digest};
    };
    // A version that simulators refuse, because its content is malformed, is published all the
    // same.
    versions_.take(
        messages_at_most, [&](ModelVersion&& version) { note(version); },
        [&](const ModelVersion& version, const std::string&) { note(version); });
    heartbeats_.take(messages_at_most, [this](ServiceStatus&& status) {
      heard_[status.service] = split_names(status.equipment);
    });
    services_ = std::max<std::size_t>(services_, versions_.matched_writers());
    return {acknowledgements_.matched_writers(), services_, simulators_.size(), champions_.size(),
            heard_.size()};
  }

  /// Adds the simulators that the services hear and this program does not: where they have peers
  /// (CYCLONEDDS_URI), clients do not find each other.
  void ask_services(std::chrono::milliseconds timeout) {
    for (const auto& [service, equipment] : heard_) {
      history::RemoteHistory remote(participant_, service);
      try {
        for (const storage::SimulatorState& state :
             history::RemoteHistoryReader({remote, timeout}).simulators())
          simulators_.try_emplace(
              {state.simulator, state.equipment.spacecraft, state.equipment.equipment},
              acknowledgement_of(state));
      } catch (const history::Error&) {
        // It has ended, or this program may not ask it.
      }
    }
  }

  PartitionSurvey sight() {
    PartitionSurvey sight;
    for (auto& [key, said] : simulators_) sight.simulators.push_back(std::move(said));
    sight.champions = std::move(champions_);
    sight.services = services_;
    for (const auto& [service, equipment] : heard_)
      for (const std::string& one : equipment)
        sight.spacecraft.insert(one.substr(0, one.find('/')));
    sight.misses_security = participant_.misses_security();
    return sight;
  }

 private:
  dds::Participant participant_;
  dds::Reader<ModelAcknowledgement> acknowledgements_;
  dds::Reader<ModelVersion> versions_;
  dds::Reader<ServiceStatus> heartbeats_;
  dds::WaitSet ready_;
  std::map<std::array<std::string, 3>, ModelAcknowledgement> simulators_;
  std::map<storage::EquipmentName, PublishedVersion> champions_;
  std::size_t services_ = 0;
  std::map<std::string, std::vector<std::string>> heard_;  // services with their equipment
};

/// Services that publish nothing while the other one of their pair leads.
std::size_t followers(const dds::Endpoint& endpoint) {
  const auto heard = heard_services(endpoint, heartbeat_wait);
  const auto* services = std::get_if<std::vector<ServiceStatus>>(&heard);
  if (services == nullptr) return 0;
  return static_cast<std::size_t>(std::ranges::count(*services, "follows", &ServiceStatus::role));
}

}  // namespace

PartitionSurvey look_into(const dds::Endpoint& endpoint, std::chrono::nanoseconds limit) {
  Listener listener(endpoint);
  const auto deadline = Clock::now() + limit;
  auto changed = Clock::now();
  std::array<std::size_t, 5> known{};
  const auto has_settled = [&](Clock::time_point now) {
    const bool is_full = std::find(known.begin(), known.end(), 0U) == known.end();
    return now - changed >= (is_full ? settled : settled_without);
  };
  for (auto now = changed; now < deadline && !has_settled(now); now = Clock::now()) {
    const auto known_now = listener.look(deadline - now);
    if (known_now != known) changed = Clock::now();
    known = known_now;
  }
  if (std::getenv("CYCLONEDDS_URI") != nullptr) listener.ask_services(heartbeat_wait);
  PartitionSurvey sight = listener.sight();
  if (sight.services > 1) sight.services -= std::min(followers(endpoint), sight.services - 1);
  return sight;
}

}  // namespace reident::cli
