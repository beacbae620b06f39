#include "service/daemon/service_watch.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "service/history/overview_rows.hpp"
#include "service/operations/commands.hpp"
#include "service/support/log.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident {
namespace {

using storage::Alarm;

constexpr storage::Time second = 1'000'000'000;
constexpr storage::Time heartbeats_missed = 5 * second;  // then a service has ended
constexpr storage::Time swap_time = 30 * second;         // that a simulator may take
constexpr std::size_t most_text = 60'000;  // bytes: a status with more is refused by its readers
constexpr std::string_view of_the_league = "champion_failed";  // raised and cleared there

auto contents(const Alarm& alarm) {
  return std::tie(alarm.code, alarm.about, alarm.text);
}

bool has(const std::vector<Alarm>& alarms, const Alarm& one) {
  return std::any_of(alarms.begin(), alarms.end(),
                     [&](const Alarm& other) { return contents(other) == contents(one); });
}

/// Whatever its text is now.
bool is_raised(const std::vector<Alarm>& alarms, const Alarm& one) {
  return std::any_of(alarms.begin(), alarms.end(), [&](const Alarm& other) {
    return other.code == one.code && other.about == one.about;
  });
}

bool same(const std::vector<Alarm>& a, const std::vector<Alarm>& b) {
  return a.size() == b.size() &&
         std::all_of(a.begin(), a.end(), [&](const Alarm& one) { return has(b, one); });
}

std::string name_of(const storage::EquipmentName& about) {
  return about.equipment.empty() ? about.spacecraft : full_name(about);
}

/// Makes the registry's alarms, but those of the league, these.
void write(storage::Registry& registry, const std::vector<Alarm>& alarms, storage::Time now) {
  for (const Alarm& before : registry.alarms()) {
    if (!is_raised(alarms, before) && before.code != of_the_league)
      registry.clear(before.code, before.about, now);
  }
  for (const Alarm& alarm : alarms) registry.raise(alarm);
}

}  // namespace

ServiceWatch::ServiceWatch(Parts parts) : parts_(std::move(parts)), statuses_(parts_.participant) {}

void ServiceWatch::log_a_set_clock() {
  constexpr storage::Time adjusted = 10 * second;  // at most, and not set
  const storage::Time booted = parts_.clock() - parts_.uptime();
  const storage::Time by = booted - booted_.value_or(booted);
  booted_ = booted;
  if (std::abs(by) > adjusted)
    log::warning("service", "the clock of this machine was set",
                 {{"by_s", by / second}, {"now", time_text(parts_.clock())}});
}

void ServiceWatch::hear_services() {
  constexpr std::size_t at_most = 256;
  const storage::Time now = parts_.uptime();
  statuses_.take(at_most, [&](ServiceStatus&& status) {
    const auto key = std::pair(status.service, status.started);
    if (key != std::pair(parts_.config.service_name, parts_.started))
      others_[key] = {std::move(status), now};
  });
  std::erase_if(others_,
                [&](const auto& other) { return now - other.second.heard > heartbeats_missed; });
}

std::vector<Alarm> ServiceWatch::services() const {
  std::vector<Alarm> alarms;
  std::set<std::string> ours;
  for (const storage::EquipmentName& name : equipment_of(parts_.config))
    ours.insert(full_name(name));
  for (const auto& [key, other] : others_) {
    const std::string& name = other.status.service;
    const bool is_partner = !other.status.pair.empty() && other.status.pair == parts_.config.pair &&
                            name != parts_.config.service_name;
    if (is_partner) continue;
    std::vector<std::string> shared;
    for (const std::string& one : split_names(other.status.equipment))
      if (ours.contains(one)) shared.push_back(one);
    if (name != parts_.config.service_name && shared.empty()) continue;
    const std::string what =
        name == parts_.config.service_name
            ? fmt::format("Another service is called {} too, up since {}", name,
                          time_text(other.status.started / second * second))
            : fmt::format("Service {} publishes {} too", name, joined(shared));
    alarms.push_back({"two_services",
                      {},
                      what + ". Stop one of them, or give it another name and partition.",
                      parts_.clock()});
  }
  if (alarms.size() > 1) {  // one alarm of a code
    for (std::size_t i = 1; i < alarms.size(); ++i) alarms[0].text += " " + alarms[i].text;
    alarms.resize(1);
  }
  return alarms;
}

std::vector<Alarm> ServiceWatch::disk_and_damage() const {
  std::vector<Alarm> alarms;
  const ArchiveWriter::Counts counts = parts_.writer.counts();
  if (!counts.last_error.empty()) alarms.push_back({"disk", {}, counts.last_error, parts_.clock()});
  history::add_full_disk(parts_.config.database, parts_.clock(), alarms);
  std::string damage = counts.last_damage.empty() ? parts_.damage : counts.last_damage;
  if (!counts.postponed.empty()) damage = "Late samples wait: " + counts.postponed;
  if (!damage.empty()) alarms.push_back({"damage", {}, damage, parts_.clock()});
  return alarms;
}

std::vector<Alarm> ServiceWatch::certificate() const {
  const std::string warning = parts_.participant.security_warning();
  if (warning.empty()) return {};
  return {{"certificate", {}, warning, parts_.clock()}};
}

std::vector<Alarm> ServiceWatch::old_simulators() {
  const storage::Time now = parts_.uptime();
  const std::map<storage::EquipmentName, std::int64_t> champions = parts_.publisher.published();
  std::map<storage::EquipmentName, std::vector<std::string>> old;
  auto old_since = std::exchange(old_since_, {});
  for (const storage::SimulatorState& state : parts_.simulators.present()) {
    const auto champion = champions.find(state.equipment);
    if (state.version == 0 || champion == champions.end() || champion->second == state.version)
      continue;
    const std::pair key{state.simulator, state.equipment};
    const auto before = old_since.find(key);
    const storage::Time since = before == old_since.end() ? now : before->second;
    old_since_[key] = since;
    if (now - since >= swap_time)
      old[state.equipment].push_back(
          fmt::format("{} (version {})", state.simulator, state.version));
  }
  std::vector<Alarm> alarms;
  for (const auto& [equipment, names] : old)
    alarms.push_back({"simulators_old", equipment,
                      fmt::format("Not the champion, version {}, runs in {}. 'reident simulators "
                                  "--old' says why.",
                                  champions.at(equipment), joined(names)),
                      parts_.clock()});
  return alarms;
}

void ServiceWatch::look() {
  log_a_set_clock();
  hear_services();
  std::vector<Alarm> now = parts_.telemetry.alarms();
  const auto of_pair = parts_.pair ? parts_.pair->alarms() : std::vector<Alarm>();
  for (auto more : {services(), disk_and_damage(), old_simulators(), certificate(), of_pair})
    now.insert(now.end(), more.begin(), more.end());
  for (const Alarm& alarm : now)
    if (!has(alarms_, alarm))
      log::warning("alarm", "raised",
                   {{"code", alarm.code}, {"about", name_of(alarm.about)}, {"text", alarm.text}});
  for (const Alarm& alarm : alarms_)
    if (!is_raised(now, alarm))
      log::info("alarm", "cleared", {{"code", alarm.code}, {"about", name_of(alarm.about)}});
  alarms_ = std::move(now);
  if (!parts_.pair || parts_.pair->leads())
    keep(parts_.simulators.take_changes(parts_.clock()));
  else
    let_partner_keep();
}

// The leader records the same; what it may not have come to is recorded here if it is gone.
void ServiceWatch::let_partner_keep() {
  const storage::Time recent = parts_.clock() - heartbeats_missed;
  std::vector<storage::SimulatorState> changes = parts_.simulators.take_changes(parts_.clock());
  std::erase_if(changes,
                [&](const storage::SimulatorState& change) { return change.time < recent; });
  parts_.simulators.give_back(std::move(changes));
  kept_.reset();
}

// The registry's thread may be stuck on a full disk for long: nothing is posted until it has done
// what was posted before.
void ServiceWatch::keep(std::vector<storage::SimulatorState> changes) {
  using namespace std::chrono_literals;
  const auto give_back = [&] { parts_.simulators.give_back(std::move(changes)); };
  if (posted_.valid()) {
    if (posted_.wait_for(0s) != std::future_status::ready) return give_back();
    try {
      posted_.get();
      kept_ = posted_alarms_;
      posted_changes_.clear();
      failure_.succeeded();
    } catch (const std::exception& error) {
      if (failure_.is_news(error.what()))
        log::error("alarm", "what was noticed cannot be recorded; it is tried again",
                   {{"error", error.what()}});
      changes.insert(changes.begin(), posted_changes_.begin(), posted_changes_.end());
      posted_changes_.clear();
    }
  }
  if (changes.empty() && kept_ && same(*kept_, alarms_)) return;
  posted_alarms_ = alarms_;
  posted_changes_ = changes;
  posted_ =
      parts_.writer.post([alarms = alarms_, changes, now = parts_.clock(), pair = parts_.pair](
                             storage::Registry& registry, storage::Archive&) {
        if (pair && !pair->leads()) return;
        for (const storage::SimulatorState& change : changes) registry.record_simulator(change);
        write(registry, alarms, now);
      });
}

std::string ServiceWatch::text() const {
  std::string text;
  for (std::size_t i = 0; i < alarms_.size(); ++i) {
    const Alarm& alarm = alarms_[i];
    const std::string about = name_of(alarm.about);
    const std::string line = fmt::format("{}{}{}{}: {}", text.empty() ? "" : "\n", alarm.code,
                                         about.empty() ? "" : " ", about, alarm.text);
    if (text.size() + line.size() > most_text)
      return text + fmt::format("{}and {} more: 'reident overview' has them",
                                text.empty() ? "" : "\n", alarms_.size() - i);
    text += line;
  }
  return text;
}

}  // namespace reident
