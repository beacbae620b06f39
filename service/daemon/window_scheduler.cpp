#include "service/daemon/window_scheduler.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "service/support/floor_divide.hpp"

namespace reident {
namespace {

/// Times further from the epoch than this (year 2200) belong to no window: a clock that is wrong by
/// centuries must not overflow the arithmetic below.
constexpr storage::Time time_bound = 7'258'118'400'000'000'000;
constexpr const char* late_telemetry = "late telemetry";

}  // namespace

WindowScheduler::WindowScheduler(const std::vector<Plan>& plans, Duration settle)
    : settle_(settle) {
  for (const Plan& plan : plans) {
    assert(plan.slide > 0 && plan.window >= plan.slide);
    equipment_.push_back({.plan = plan});
  }
}

void WindowScheduler::touched(std::size_t equipment, storage::Time time, storage::Time now) {
  if (time >= time_bound || time <= -time_bound) return;
  Equipment& state = equipment_[equipment];
  const auto touch = [&](storage::Time end, Begin begin, const char* cause) {
    if (begin && time < *begin) return;
    const auto due = state.due.try_emplace(end, Due{now, cause, begin}).first;
    due->second.touched = now;
  };
  const storage::Time first = (floor_divide(time, state.plan.slide) + 1) * state.plan.slide;
  const storage::Time last = time + state.plan.window;
  // Later windows that hold the sample are due by samples of their own, unless they were tried or
  // asked for.
  for (auto it = state.due.upper_bound(time); it != state.due.end() && it->first <= last; ++it)
    if (it->second.begin && *it->second.begin <= time) it->second.touched = now;
  if (const auto& running = state.running; running && running->end > time && running->end <= last)
    touch(running->end, running->begin, late_telemetry);
  for (auto it = state.tried.upper_bound(time); it != state.tried.end() && it->first <= last; ++it)
    touch(it->first, it->second, late_telemetry);
  if (!state.tried.contains(first) && !(state.running && state.running->end == first))
    touch(first, std::nullopt, "slide");
}

void WindowScheduler::reached(std::size_t equipment, storage::Time time) {
  Equipment& state = equipment_[equipment];
  state.reached = std::max(state.reached, std::clamp(time, -time_bound, time_bound));
}

void WindowScheduler::ask(std::size_t equipment, storage::Time end, std::string cause,
                          storage::Time now, Begin begin) {
  equipment_[equipment].due[end] = {now - settle_, std::move(cause), begin};
}

void WindowScheduler::tried_before(std::size_t equipment, storage::TimeRange window) {
  Equipment& state = equipment_[equipment];
  const bool is_short = window.end - window.begin < state.plan.window;
  state.tried.insert_or_assign(window.end, is_short ? Begin(window.begin) : std::nullopt);
}

void WindowScheduler::tried_elsewhere(std::size_t equipment, storage::TimeRange window) {
  equipment_[equipment].due.erase(window.end);
  tried_before(equipment, window);
}

std::optional<WindowScheduler::Job> WindowScheduler::next(storage::Time now) {
  std::optional<Job> best;
  const auto turn = [this](std::size_t equipment, storage::Time end) {
    return std::pair(equipment_[equipment].turn, end);
  };
  for (std::size_t i = 0; i < equipment_.size(); ++i) {
    const Equipment& state = equipment_[i];
    if (state.running) continue;
    for (const auto& [end, due] : state.due) {
      if (state.reached < end || (best && turn(best->equipment, best->window.end) <= turn(i, end)))
        break;
      if (now - due.touched < settle_) continue;
      best = Job{i, {due.begin.value_or(end - state.plan.window), end}, due.cause};
      break;
    }
  }
  if (best) {
    Equipment& state = equipment_[best->equipment];
    state.turn = ++turns_;
    const auto due = state.due.find(best->window.end);
    state.running = Running{due->first, due->second.begin};
    state.due.erase(due);
  }
  return best;
}

void WindowScheduler::finished(const Job& job, bool completed, storage::Time now) {
  Equipment& state = equipment_[job.equipment];
  assert(state.running && state.running->end == job.window.end);
  if (completed)
    state.tried.insert_or_assign(job.window.end, state.running->begin);
  else
    state.due.emplace(job.window.end, Due{now, job.cause, state.running->begin});
  state.running.reset();
}

storage::Time WindowScheduler::tried_until(std::size_t equipment) const {
  const Equipment& state = equipment_[equipment];
  storage::Time first = state.reached;
  const auto limit = [&](storage::Time end) {
    if (!state.tried.contains(end)) first = std::min(first, end);
  };
  if (state.running) limit(state.running->end);
  for (auto due = state.due.begin(); due != state.due.end() && due->first < first; ++due)
    limit(due->first);
  return first;
}

std::optional<storage::Time> WindowScheduler::next_due() const {
  std::optional<storage::Time> earliest;
  for (const Equipment& state : equipment_) {
    if (state.running) continue;
    for (const auto& [end, due] : state.due) {
      if (end > state.reached) break;
      earliest = std::min(earliest.value_or(INT64_MAX), due.touched + settle_);
    }
  }
  return earliest;
}

std::size_t WindowScheduler::pending() const {
  std::size_t count = 0;
  for (const Equipment& state : equipment_) {
    if (state.running) ++count;
    const auto later = state.due.upper_bound(state.reached);
    count += static_cast<std::size_t>(std::distance(state.due.begin(), later));
  }
  return count;
}

bool WindowScheduler::pending_within(std::size_t equipment, storage::TimeRange range) const {
  const Equipment& state = equipment_[equipment];
  const auto overlaps = [&](storage::Time end) {
    return end - state.plan.window < range.end && range.begin < end;
  };
  if (state.running && overlaps(state.running->end)) return true;
  return std::any_of(state.due.begin(), state.due.end(),
                     [&](const auto& entry) { return overlaps(entry.first); });
}

}  // namespace reident
