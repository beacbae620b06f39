#include "service/daemon/telemetry_watch.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "service/support/log.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/windows/window_data.hpp"

namespace reident {
namespace {

using storage::Alarm;

/// So long after the last new name all of a source's descriptors have come.
constexpr Duration descriptors_settle = 10'000'000'000;

/// Spacecraft that are not configured have alarms of their own up to so many: a name costs its
/// sender nothing.
constexpr std::size_t most_strangers = 10;

constexpr Duration minute = 60'000'000'000;

std::vector<std::string> names_of(const std::map<std::uint32_t, std::string>& by_id) {
  std::vector<std::string> names;
  for (const auto& [id, name] : by_id) names.push_back(name);
  return names;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

TelemetryWatch::TelemetryWatch(const Config& config, Clock clock, Clock uptime,
                               ArchiveListener& next)
    : config_(config), clock_(std::move(clock)), uptime_(std::move(uptime)), next_(next) {
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      equipment_.push_back({{spacecraft.name, equipment.name},
                            &equipment,
                            parameters_of(equipment),
                            clock_(),
                            uptime_()});
}

void TelemetryWatch::note(const storage::ParameterDescriptor& descriptor) {
  Spacecraft& spacecraft = spacecraft_[descriptor.spacecraft];
  if (std::exchange(spacecraft.names[descriptor.id], descriptor.name) == descriptor.name) return;
  spacecraft.described = uptime_();
  spacecraft.is_settled = false;
}

void TelemetryWatch::recover(const storage::Archive& archive, storage::Time last_entry) {
  tried(last_entry);
  const MutexLock lock(mutex_);
  for (const std::string& spacecraft : archive.spacecraft())
    for (const storage::ParameterDescriptor& descriptor : archive.parameters(spacecraft))
      note(descriptor);
}

void TelemetryWatch::tried(storage::Time time) {
  const MutexLock lock(mutex_);
  last_entry_ = std::max(last_entry_, time);
}

void TelemetryWatch::described(const std::vector<storage::ParameterDescriptor>& descriptors,
                               const storage::Archive& archive) {
  {
    const MutexLock lock(mutex_);
    for (const storage::ParameterDescriptor& descriptor : descriptors) note(descriptor);
  }
  next_.described(descriptors, archive);
}

void TelemetryWatch::stored(const std::vector<storage::TelemetryFrame>& frames,
                            const storage::AppendReport& report) {
  {
    const MutexLock lock(mutex_);
    const storage::Time now = clock_();
    for (const storage::AppendReport::Touched& touched : report.touched) {
      if (touched.origin != storage::Origin::real) continue;
      const auto spacecraft = spacecraft_.find(touched.spacecraft);
      if (spacecraft == spacecraft_.end()) continue;
      const auto name = spacecraft->second.names.find(touched.parameter);
      if (name == spacecraft->second.names.end()) continue;
      for (Equipment& equipment : equipment_)
        if (equipment.name.spacecraft == touched.spacecraft &&
            contains(equipment.parameters, name->second)) {
          equipment.heard = now;
          equipment.heard_at = uptime_();
        }
    }
    for (const storage::TelemetryFrame& frame : frames) {
      if (frame.origin != storage::Origin::real) continue;
      std::optional<Duration>& lead = spacecraft_[frame.spacecraft].lead;
      const bool is_ahead =
          frame.generation_time > now && frame.generation_time - now > config_.max_clock_lead;
      if (!is_ahead)
        lead.reset();
      else if (!lead)
        lead = frame.generation_time - now;
    }
  }
  next_.stored(frames, report);
}

bool TelemetryWatch::is_configured(const std::string& spacecraft) const {
  return std::any_of(config_.spacecraft.begin(), config_.spacecraft.end(),
                     [&](const SpacecraftConfig& one) { return one.name == spacecraft; });
}

std::string TelemetryWatch::unknown_text(const Equipment& equipment,
                                         const Spacecraft& spacecraft) const {
  const std::string text = unknown_among(equipment.parameters, names_of(spacecraft.names));
  if (text.empty()) return text;
  return fmt::format("No telemetry has {}. Correct the configuration, or look for the source.",
                     text);
}

void TelemetryWatch::log_unused(const std::string& name, const Spacecraft& spacecraft) const {
  constexpr std::size_t most_named = 10;
  std::vector<std::string> unused;
  for (const std::string& parameter : names_of(spacecraft.names))
    if (std::none_of(equipment_.begin(), equipment_.end(), [&](const Equipment& equipment) {
          return equipment.name.spacecraft == name && contains(equipment.parameters, parameter);
        }))
      unused.push_back(parameter);
  if (unused.empty()) return;
  const std::size_t count = unused.size();
  unused.resize(std::min(count, most_named));
  log::info("telemetry", "parameters that no equipment uses",
            {{"spacecraft", name}, {"parameters", count}, {"such_as", joined(unused)}});
}

std::vector<Alarm> TelemetryWatch::alarms() {
  const MutexLock lock(mutex_);
  const storage::Time now = clock_(), uptime = uptime_();
  std::vector<Alarm> alarms;
  if (now < last_entry_ - minute)
    alarms.push_back({"clock",
                      {},
                      fmt::format("This machine's clock is before the last window that was tried, "
                                  "at {}. Correct the clock. If it is right now, it was ahead "
                                  "then: acknowledge this alarm.",
                                  time_text(last_entry_ / 1'000'000'000 * 1'000'000'000)),
                      now});
  for (const Equipment& equipment : equipment_)
    if (uptime - equipment.heard_at > equipment.config->slide)
      alarms.push_back({"no_telemetry", equipment.name,
                        fmt::format("No telemetry has come since {}, which is more than the slide "
                                    "of {}. Look for the source; 'reident completeness' shows what "
                                    "came.",
                                    time_text(equipment.heard / 1'000'000'000 * 1'000'000'000),
                                    duration_text(equipment.config->slide)),
                        now});
  std::vector<std::string> configured;
  for (const SpacecraftConfig& one : config_.spacecraft) configured.push_back(one.name);
  std::size_t strangers = 0;
  for (auto& [name, spacecraft] : spacecraft_) {
    if (spacecraft.lead && is_configured(name))
      alarms.push_back(
          {"clock",
           {name, ""},
           fmt::format("Telemetry is ahead of this machine's clock by {}, more than max_clock_lead "
                       "({}): no window follows it. Correct the clock, or the source.",
                       duration_text(std::max(*spacecraft.lead / minute, Duration{1}) * minute),
                       duration_text(config_.max_clock_lead)),
           now});
    if (spacecraft.names.empty() || uptime - spacecraft.described < descriptors_settle) continue;
    if (!is_configured(name)) {
      if (++strangers > most_strangers) continue;
      alarms.push_back({"unknown_names",
                        {name, ""},
                        fmt::format("Telemetry of {} comes, which is not configured{}.", name,
                                    did_you_mean(name, configured)),
                        now});
      continue;
    }
    if (!std::exchange(spacecraft.is_settled, true)) log_unused(name, spacecraft);
    for (const Equipment& equipment : equipment_)
      if (equipment.name.spacecraft == name)
        if (std::string text = unknown_text(equipment, spacecraft); !text.empty())
          alarms.push_back({"unknown_names", equipment.name, std::move(text), now});
  }
  if (strangers > most_strangers)
    alarms.push_back({"unknown_names",
                      {},
                      fmt::format("Telemetry of more than {} spacecraft comes that are not "
                                  "configured. Look for who sends it.",
                                  most_strangers),
                      now});
  return alarms;
}

}  // namespace reident
