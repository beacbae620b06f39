#include "service/web/live_state.hpp"

#include <utility>

#include "service/model/status_json.hpp"
#include "service/support/utc_clock.hpp"
#include "storage/database/snapshot.hpp"
#include "storage/registry/registry.hpp"

namespace reident::web {
namespace {

using namespace std::chrono_literals;
using SteadyClock = std::chrono::steady_clock;

constexpr auto look_interval = 300ms;  // into the registry, for what no topic says
constexpr std::size_t take_at_most = 64;

/// What was decided about an equipment so far: it changes with each decision, hold and attempt.
Json registry_value(const storage::Registry& registry, const storage::EquipmentName& name) {
  const storage::DecisionState state = registry.decision_state(name.spacecraft, name.equipment);
  const auto tried = registry.last_window_end(name.spacecraft, name.equipment);
  Json value = name_value(name);
  value["decision"] = id_value(state.last_decision);
  value["hold"] = id_value(state.last_hold);
  value["tried_until"] = tried ? time_value(*tried) : Json();
  return value;
}

}  // namespace

Json status_value(const HeardStatus& heard) {
  const std::chrono::duration<double> age = SteadyClock::now() - heard.heard;
  Json value = status_json(heard.status);
  value["age_s"] = std::round(age.count() * 10) / 10;
  return value;
}

LiveState::LiveState(const dds::Endpoint& endpoint, std::filesystem::path database)
    : participant_(endpoint),
      statuses_(participant_),
      versions_(participant_),
      ready_(participant_),
      database_(std::move(database)) {
  ready_.attach(statuses_);
  ready_.attach(versions_);
  // A page that was open before this process began has a revision of the process before. With the
  // clock as the first revision no number comes twice.
  const MutexLock lock(mutex_);
  revision_ = static_cast<std::uint64_t>(utc_now()) / 1000;
}

void LiveState::run(const std::function<void()>& changed) {
  auto looked = SteadyClock::now() - look_interval;
  while (!stopping_) {
    bool is_new = take_statuses();
    const bool was_published = versions_.take(
                                   take_at_most, [](ModelVersion&&) {},
                                   [](const ModelVersion&, const std::string&) {}) > 0;
    if (was_published || SteadyClock::now() - looked >= look_interval) {
      is_new = look_into_registry() || is_new;
      looked = SteadyClock::now();
    }
    if (is_new) changed();
    ready_.wait(look_interval);
  }
}

void LiveState::stop() {
  stopping_ = true;
  ready_.wake();
}

bool LiveState::put(const std::string& key, const std::string& event, const Json& value) {
  Entry& entry = entries_[key];
  if (entry.revision != 0 && entry.value == value) return false;
  ++changes_;
  entry = {++revision_, entry.changes + 1, event, value};
  return true;
}

Json LiveState::value_now(const Entry& entry) const {
  if (entry.event != "service") return entry.value;
  return status_value(services_.at(entry.value["service"].get<std::string>()));
}

bool LiveState::take_statuses() {
  bool is_new = false;
  statuses_.take(take_at_most, [&](ServiceStatus&& status) {
    const MutexLock lock(mutex_);
    const std::string name = status.service;
    services_[name] = {std::move(status), SteadyClock::now()};
    is_new = put("service/" + name, "service", status_value(services_[name])) || is_new;
  });
  return is_new;
}

bool LiveState::look_into_registry() {
  std::string error;
  std::vector<std::pair<std::string, Json>> found;
  DecisionCounts made;
  try {
    storage::Database database(database_, storage::Database::Mode::read_only);
    const storage::Snapshot snapshot(database);
    const storage::Registry registry(database);
    for (const storage::EquipmentName& name : registry.equipment())
      found.emplace_back("registry/" + name.spacecraft + "/" + name.equipment,
                         registry_value(registry, name));
    if (registry.last_decision() < counted_) counted_ = 0;  // an older file was put in its place
    storage::RowFilter uncounted;
    if (counted_ > 0) uncounted.beyond = counted_;
    registry.each_decision(uncounted, [&](storage::Decision&& decision) {
      ++made[{std::string(storage::name(decision.kind)), decision.actor == "gate"}];
      counted_ = decision.id;
      return true;
    });
  } catch (const storage::Error& failure) {
    error = failure.what();
  }
  const MutexLock lock(mutex_);
  for (const auto& [key, count] : made) decisions_[key] += count;
  bool is_new = error != database_error_;
  database_error_ = error;
  is_new = put("database", "database", {{"error", error}}) || is_new;
  for (auto& [key, value] : found) is_new = put(key, "registry", value) || is_new;
  return is_new;
}

std::map<std::string, HeardStatus> LiveState::services() const {
  const MutexLock lock(mutex_);
  return services_;
}

std::string LiveState::database_error() const {
  const MutexLock lock(mutex_);
  return database_error_;
}

DecisionCounts LiveState::decisions() const {
  const MutexLock lock(mutex_);
  return decisions_;
}

EventSource::Events LiveState::since(std::uint64_t revision) {
  const MutexLock lock(mutex_);
  Events events;
  events.revision = revision_;
  if (revision == revision_) return events;
  if (revision > revision_) revision = 0;  // of a process whose clock was ahead
  std::uint64_t sent = 0;
  std::string id = std::to_string(revision_);
  for (const auto& [key, entry] : entries_) {
    if (entry.revision <= revision) continue;
    ++sent;
    events.text += "event: " + entry.event + "\ndata: " +
                   value_now(entry).dump(-1, ' ', false, Json::error_handler_t::replace) +
                   "\nid: " + id + "\n\n";
  }
  events.coalesced = std::min(revision_ - revision, changes_) - sent;
  return events;
}

Json LiveState::changes_since(std::uint64_t revision) const {
  const MutexLock lock(mutex_);
  Json list = Json::array();
  for (const auto& [key, entry] : entries_)
    if (entry.revision > revision || revision > revision_)
      list.push_back({{"event", entry.event}, {"data", value_now(entry)}});
  return {{"revision", std::to_string(revision_)}, {"changes", std::move(list)}};
}

}  // namespace reident::web
