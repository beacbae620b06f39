#include "service/daemon/window_scheduler.hpp"

#include <algorithm>
#include <cassert>

#include "service/support/floor_divide.hpp"

namespace reident {
namespace {

/// Times further from the epoch than this (year 2200) belong to no window: a clock that is wrong by
/// centuries must not overflow the arithmetic below.
constexpr storage::Time time_bound = 7'258'118'400'000'000'000;

}  // namespace

WindowScheduler::WindowScheduler(const std::vector<Plan>& plans, Duration settle)
    : settle_(settle) {
  for (const Plan& plan : plans) {
    assert(plan.slide > 0 && plan.window >= plan.slide);
    equipment_.push_back({.plan = plan, .touched = {}, .tried = {}, .running = {}});
  }
}

storage::TimeRange WindowScheduler::window(const Plan& plan, std::int64_t number) const {
  const storage::Time end = number * plan.slide;
  return {end - plan.window, end};
}

void WindowScheduler::touched(std::size_t equipment, storage::Time time, storage::Time now) {
  if (time >= time_bound || time <= -time_bound) return;
  Equipment& state = equipment_[equipment];
  const std::int64_t first = floor_divide(time, state.plan.slide) + 1;
  const std::int64_t last = floor_divide(time + state.plan.window, state.plan.slide);
  state.touched[first] = now;
  // Later windows that hold the sample are due by samples of their own, unless they were tried.
  for (auto it = state.tried.upper_bound(first); it != state.tried.end() && *it <= last; ++it)
    state.touched[*it] = now;
}

void WindowScheduler::reached(std::size_t equipment, storage::Time time) {
  Equipment& state = equipment_[equipment];
  state.reached = std::max(state.reached, std::min(time, time_bound));
}

void WindowScheduler::tried_before(std::size_t equipment, storage::Time end) {
  Equipment& state = equipment_[equipment];
  if (end % state.plan.slide == 0) state.tried.insert(end / state.plan.slide);
}

std::optional<WindowScheduler::Job> WindowScheduler::next(storage::Time now) {
  std::optional<Job> best;
  std::int64_t best_number = 0;
  for (std::size_t i = 0; i < equipment_.size(); ++i) {
    const Equipment& state = equipment_[i];
    if (state.running) continue;
    for (const auto& [number, touched_at] : state.touched) {
      const storage::TimeRange range = window(state.plan, number);
      if (state.reached < range.end || (best && best->window.end <= range.end)) break;
      if (now - touched_at < settle_) continue;
      best = Job{i, range, state.tried.contains(number)};
      best_number = number;
      break;
    }
  }
  if (best) {
    equipment_[best->equipment].running = best_number;
    equipment_[best->equipment].touched.erase(best_number);
  }
  return best;
}

void WindowScheduler::finished(const Job& job, bool completed, storage::Time now) {
  Equipment& state = equipment_[job.equipment];
  assert(state.running && window(state.plan, *state.running) == job.window);
  if (completed)
    state.tried.insert(*state.running);
  else
    state.touched.emplace(*state.running, now);
  state.running.reset();
}

std::optional<storage::Time> WindowScheduler::next_due() const {
  std::optional<storage::Time> due;
  for (const Equipment& state : equipment_) {
    if (state.running) continue;
    for (const auto& [number, touched_at] : state.touched) {
      if (window(state.plan, number).end > state.reached) break;
      due = std::min(due.value_or(INT64_MAX), touched_at + settle_);
    }
  }
  return due;
}

std::size_t WindowScheduler::pending() const {
  std::size_t count = 0;
  for (const Equipment& state : equipment_) {
    if (state.running) ++count;
    for (const auto& [number, touched_at] : state.touched) {
      if (window(state.plan, number).end > state.reached) break;
      ++count;
    }
  }
  return count;
}

bool WindowScheduler::pending_within(std::size_t equipment, storage::TimeRange range) const {
  const Equipment& state = equipment_[equipment];
  const auto overlaps = [&](std::int64_t number) {
    const storage::TimeRange other = window(state.plan, number);
    return other.begin < range.end && range.begin < other.end;
  };
  if (state.running && overlaps(*state.running)) return true;
  return std::any_of(state.touched.begin(), state.touched.end(),
                     [&](const auto& entry) { return overlaps(entry.first); });
}

}  // namespace reident
