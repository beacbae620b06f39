#include "service/daemon/window_feed.hpp"

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include "service/support/floor_divide.hpp"
#include "service/support/log.hpp"
#include "service/windows/window_data.hpp"

namespace reident {
namespace {

std::vector<WindowScheduler::Plan> plans(const Config& config) {
  std::vector<WindowScheduler::Plan> result;
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      result.push_back({equipment.window, equipment.slide});
  return result;
}

template <class T>
bool contains(const std::vector<T>& all, const T& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

}  // namespace

WindowFeed::WindowFeed(const Config& config, Clock clock, Clock uptime)
    : clock_(std::move(clock)),
      uptime_(std::move(uptime)),
      max_clock_lead_(config.max_clock_lead),
      scheduler_(plans(config), config.settle) {
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      equipment_.push_back({spacecraft.name, &equipment, parameters_of(equipment)});
  altered_.resize(equipment_.size());
}

void WindowFeed::join(const storage::ParameterDescriptor& descriptor,
                      const storage::Archive& archive) {
  for (std::size_t i = 0; i < equipment_.size(); ++i) {
    const Equipment& equipment = equipment_[i];
    if (equipment.spacecraft != descriptor.spacecraft ||
        !contains(equipment.parameters, descriptor.name))
      continue;
    EquipmentIds& ids = membership_[descriptor.spacecraft][descriptor.id];
    if (contains(ids, i)) continue;
    ids.push_back(i);
    touch_stored(i, descriptor.spacecraft, descriptor.id, {equipment.tried_until, INT64_MAX},
                 archive);
  }
}

const WindowFeed::EquipmentIds* WindowFeed::members(const std::string& spacecraft,
                                                    std::uint32_t parameter) const {
  const auto ids = membership_.find(spacecraft);
  if (ids == membership_.end()) return nullptr;
  const auto found = ids->second.find(parameter);
  return found == ids->second.end() ? nullptr : &found->second;
}

void WindowFeed::touch_stored(std::size_t equipment, const std::string& spacecraft,
                              std::uint32_t parameter, storage::TimeRange range,
                              const storage::Archive& archive) {
  try {
    touch_each_slide(equipment, spacecraft, parameter, range, archive);
  } catch (const storage::Error& error) {
    log::error("windows", "stored telemetry cannot be looked at; windows of it may not be tried",
               {{"equipment", spacecraft + "/" + equipment_[equipment].config->name},
                {"error", error.what()}});
  }
}

void WindowFeed::touch_each_slide(std::size_t equipment, const std::string& spacecraft,
                                  std::uint32_t parameter, storage::TimeRange range,
                                  const storage::Archive& archive) {
  const storage::Time now = uptime_();
  const Duration slide = equipment_[equipment].config->slide;
  const auto last = archive.last_at_or_before(spacecraft, storage::Origin::real, parameter,
                                              std::min(range.end - 1, clock_() + max_clock_lead_));
  if (!last) return;
  scheduler_.reached(equipment, *last);
  // First, because what lies before may be damaged.
  if (*last >= range.begin) scheduler_.touched(equipment, *last, now);
  newest_ = std::max(newest_, *last);
  for (auto time = range.begin; time <= *last;) {
    const auto sample =
        archive.first_at_or_after(spacecraft, storage::Origin::real, parameter, time);
    if (!sample || *sample > *last) return;
    scheduler_.touched(equipment, *sample, now);
    time = (floor_divide(*sample, slide) + 1) * slide;  // the next slide
  }
}

void WindowFeed::recover(const storage::Archive& archive, const storage::Registry& registry) {
  MutexLock lock(mutex_);
  for (std::size_t i = 0; i < equipment_.size(); ++i) {
    Equipment& equipment = equipment_[i];
    storage::HistoryFilter all;
    all.spacecraft = equipment.spacecraft;
    all.equipment = equipment.config->name;
    for (const storage::Attempt& attempt : registry.attempts(all)) {
      scheduler_.tried_before(i, attempt.window);
      equipment.tried_until = std::max(equipment.tried_until, attempt.window.end);
    }
  }
  for (const std::string& spacecraft : archive.spacecraft()) {
    for (const storage::ParameterDescriptor& descriptor : archive.parameters(spacecraft))
      join(descriptor, archive);
    for (const storage::LateRange& late : archive.late_ranges(spacecraft)) {
      const EquipmentIds* ids = members(spacecraft, late.parameter);
      if (!ids || late.origin != storage::Origin::real) continue;
      for (const std::size_t i : *ids)
        touch_stored(i, spacecraft, late.parameter, late.range, archive);
    }
  }
}

void WindowFeed::described(const std::vector<storage::ParameterDescriptor>& descriptors,
                           const storage::Archive& archive) {
  MutexLock lock(mutex_);
  for (const storage::ParameterDescriptor& descriptor : descriptors) join(descriptor, archive);
  changed_.notify_all();
}

void WindowFeed::forget_settled(const std::string& spacecraft, storage::Archive& archive) {
  std::vector<storage::LateRange> settled;
  {
    MutexLock lock(mutex_);
    for (const storage::LateRange& late : archive.late_ranges(spacecraft)) {
      bool pending = false;
      if (const EquipmentIds* ids = members(spacecraft, late.parameter))
        for (const std::size_t i : *ids)
          pending = pending || scheduler_.pending_within(i, late.range);
      if (!pending) settled.push_back(late);
    }
  }
  if (!settled.empty()) archive.forget_late(settled);
}

void WindowFeed::stored(const std::vector<storage::TelemetryFrame>& frames,
                        const storage::AppendReport& report) {
  const storage::Time utc = clock_(), now = uptime_();
  MutexLock lock(mutex_);
  // Where nothing new was stored nothing is touched: a frame sent twice starts no work.
  std::map<std::size_t, std::vector<storage::TimeRange>> news;
  for (const storage::AppendReport::Touched& touched : report.touched)
    if (touched.origin == storage::Origin::real)
      if (const EquipmentIds* ids = members(touched.spacecraft, touched.parameter))
        for (const std::size_t i : *ids) {
          news[i].push_back(touched.range);
          remember(altered_[i], touched.range);
        }

  std::set<std::size_t> equipment;
  for (const storage::TelemetryFrame& frame : frames) {
    if (is_jump(frame.generation_time, utc)) {
      ++clock_jumps_;
      continue;
    }
    if (frame.origin != storage::Origin::real) continue;
    newest_ = std::max(newest_, frame.generation_time);
    const auto watched = membership_.find(frame.spacecraft);
    if (watched == membership_.end()) continue;
    equipment.clear();
    for (const storage::Sample& sample : frame.samples)
      if (const auto found = watched->second.find(sample.parameter); found != watched->second.end())
        equipment.insert(found->second.begin(), found->second.end());
    for (const std::size_t i : equipment) {
      scheduler_.reached(i, frame.generation_time);
      const auto fresh = news.find(i);
      if (fresh == news.end()) continue;
      for (const storage::TimeRange& range : fresh->second)
        if (frame.generation_time >= range.begin && frame.generation_time < range.end) {
          scheduler_.touched(i, frame.generation_time, now);
          break;
        }
    }
  }
  ++batches_;
  changed_.notify_all();
}

void WindowFeed::remember(std::vector<storage::TimeRange>& changed, storage::TimeRange range) {
  constexpr std::size_t most_ranges = 64;
  constexpr std::uint64_t nearby = 600'000'000'000;  // a chunk of ticks is some minutes at least
  // The distance of two times can be twice as large as a Time holds.
  const auto is_apart = [](storage::Time end, storage::Time begin) {
    return begin > end &&
           static_cast<std::uint64_t>(begin) - static_cast<std::uint64_t>(end) > nearby;
  };
  const auto touches = [&](const storage::TimeRange& other) {
    return !is_apart(other.end, range.begin) && !is_apart(range.end, other.begin);
  };
  auto found = std::find_if(changed.rbegin(), changed.rend(), touches);
  if (found == changed.rend() && changed.size() < most_ranges) {
    changed.push_back(range);
    return;
  }
  storage::TimeRange& joined = found == changed.rend() ? changed.back() : *found;
  joined = {std::min(joined.begin, range.begin), std::max(joined.end, range.end)};
}

std::optional<storage::Time> WindowFeed::ask(const std::string& spacecraft,
                                             const std::string& equipment, const std::string& cause,
                                             std::optional<storage::TimeRange> window) {
  MutexLock lock(mutex_);
  for (std::size_t i = 0; i < equipment_.size(); ++i) {
    if (equipment_[i].spacecraft != spacecraft || equipment_[i].config->name != equipment) continue;
    const storage::Time reached = scheduler_.reached(i);
    if (reached == INT64_MIN) return std::nullopt;
    if (window)
      scheduler_.ask(i, window->end, cause, uptime_(), window->begin);
    else
      scheduler_.ask(i, reached, cause, uptime_());
    changed_.notify_all();
    return window ? window->end : reached;
  }
  return std::nullopt;
}

bool WindowFeed::wait_for_telemetry(std::uint64_t& seen) {
  MutexLock lock(mutex_);
  while (!stopped_ && (paused_ || batches_ == seen)) changed_.wait(mutex_);
  seen = batches_;
  return !stopped_;
}

storage::Time WindowFeed::tried_until(std::size_t equipment) const {
  MutexLock lock(mutex_);
  return scheduler_.tried_until(equipment);
}

std::optional<WindowFeed::Job> WindowFeed::take_due(storage::Time now) {
  const auto job = scheduler_.next(now);
  if (!job) return std::nullopt;
  const Equipment& equipment = equipment_[job->equipment];
  return Job{*job, &equipment.spacecraft, equipment.config,
             std::exchange(altered_[job->equipment], {})};
}

std::optional<WindowFeed::Job> WindowFeed::next_due() {
  MutexLock lock(mutex_);
  return take_due(uptime_());
}

std::optional<WindowFeed::Job> WindowFeed::next() {
  MutexLock lock(mutex_);
  while (!stopped_) {
    if (paused_) {
      changed_.wait(mutex_);
      continue;
    }
    const storage::Time now = uptime_();
    if (auto job = take_due(now)) return job;
    if (const auto due = scheduler_.next_due())
      changed_.wait_for(mutex_, std::chrono::nanoseconds(std::max<Duration>(*due - now, 1)));
    else
      changed_.wait(mutex_);
  }
  return std::nullopt;
}

void WindowFeed::finished(const Job& job, bool completed) {
  MutexLock lock(mutex_);
  scheduler_.finished(job.window, completed, uptime_());
  changed_.notify_all();
}

void WindowFeed::pause(bool is_paused) {
  MutexLock lock(mutex_);
  paused_ = is_paused;
  if (!paused_) ++batches_;  // there may be something to look at
  changed_.notify_all();
}

void WindowFeed::tried_elsewhere(const storage::EquipmentName& equipment,
                                 storage::TimeRange window) {
  MutexLock lock(mutex_);
  for (std::size_t i = 0; i < equipment_.size(); ++i)
    if (equipment_[i].spacecraft == equipment.spacecraft &&
        equipment_[i].config->name == equipment.equipment)
      scheduler_.tried_elsewhere(i, window);
}

void WindowFeed::stop() {
  MutexLock lock(mutex_);
  stopped_ = true;
  changed_.notify_all();
}

std::size_t WindowFeed::pending() const {
  MutexLock lock(mutex_);
  return scheduler_.pending();
}

storage::Time WindowFeed::newest_telemetry() const {
  MutexLock lock(mutex_);
  return newest_;
}

}  // namespace reident
