// What other threads see of the pair: its part of the status, and its alarms.
#include <algorithm>

#include <fmt/format.h>

#include "service/daemon/pair.hpp"

namespace reident {
namespace {

using Role = LeadershipRule::Role;

constexpr Instant alone_at_most = std::chrono::seconds(5);  // before an alarm

const char* name(Role role) {
  switch (role) {
    case Role::leads:
      return "leads";
    case Role::follows:
      return "follows";
    case Role::listens:
      break;
  }
  return "listens";
}

}  // namespace

std::string Pair::leader() const {
  const MutexLock lock(mutex_);
  return seen_.leader;
}

void Pair::describe(ServiceStatus& status) const {
  const MutexLock lock(mutex_);
  status.pair = config_.pair;
  status.role = name(seen_.role);
  status.term = seen_.latest_term;
  status.partner = seen_.partner                 ? seen_.partner->service
                   : seen_.role == Role::follows ? seen_.leader
                                                 : std::string();
  if (seen_.role == Role::leads)
    status.lag = seen_.partner && seen_.partner->follows
                     ? seen_.ours.position - seen_.partner->standing.position
                     : -1;
  else
    status.lag = seen_.role == Role::follows && seen_.obstacle.empty()
                     ? std::max<std::int64_t>(0, seen_.leader_position - seen_.ours.position)
                     : -1;
}

std::vector<storage::Alarm> Pair::alarms() const {
  const storage::Time time = clock_();
  std::vector<storage::Alarm> alarms;
  const MutexLock lock(mutex_);
  if (!seen_.obstacle.empty())
    alarms.push_back({"cannot_follow",
                      {},
                      fmt::format("{} cannot follow: {}.", config_.service_name, seen_.obstacle),
                      time});
  if (seen_.role == Role::leads && seen_.alone_since > Instant::zero() &&
      seen_.now - seen_.alone_since > alone_at_most)
    alarms.push_back(
        {"no_standby",
         {},
         fmt::format("No service of the pair {} follows {}: what is decided now has no "
                     "copy, and nobody takes over. Start the other one.",
                     config_.pair, config_.service_name),
         time});
  if (seen_.role == Role::leads && seen_.partner && seen_.partner->follows &&
      seen_.partner->standing.position < published_beyond_)
    alarms.push_back(
        {"standby_behind",
         {},
         fmt::format("A decision was published before {} had it: that did not take it "
                     "within {} s. Look at its disk and its log.",
                     seen_.partner->service,
                     std::chrono::duration_cast<std::chrono::seconds>(share_limit).count()),
         time});
  if (seen_.overruled && seen_.overruled->decisions > 0)
    alarms.push_back({"overruled",
                      {},
                      fmt::format("{} decided without the other service of the pair: {} of its "
                                  "decisions and commands are overruled. The view "
                                  "overruled_decision shows them.",
                                  seen_.overruled->service, seen_.overruled->decisions),
                      time});
  return alarms;
}

}  // namespace reident
