// Which window of which equipment is to be identified next.
//
// Windows follow time, not arrival: window k of an equipment is [k * slide - window, k * slide)
// counted from the epoch. It is due when
//   - its last `slide` holds a new sample of the equipment, or it was tried before and a late
//     sample fell into it,
//   - telemetry has reached its end, and
//   - nothing has fallen into it for the time `settle`.
// Others are asked for: by an operator, or because the champion drifts. They may end at any time,
// and are due as soon as telemetry has reached it; one that has a begin of its own keeps it when
// late telemetry falls into it, and settles as others do.
// One window of an equipment runs at a time, the oldest due first, so that a candidate meets the
// champion of the windows before it. Equipment take turns: the backlog of one holds up no other. A
// window that keeps receiving late telemetry holds nothing up.
//
// Not thread-safe; the clock, which never goes back, is the argument `now`.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "storage/types/telemetry.hpp"

namespace reident {

class WindowScheduler {
 public:
  /// Equipment are named by their position in `plans` from here on.
  struct Plan {
    Duration window = 0;
    Duration slide = 0;
  };
  struct Job {
    std::size_t equipment = 0;
    storage::TimeRange window;
    std::string cause;  // "slide", "late telemetry" or what the window was asked for with
    bool operator==(const Job&) const = default;
  };

  WindowScheduler(const std::vector<Plan>& plans, Duration settle);

  /// A new sample of the equipment at `time` was stored.
  void touched(std::size_t equipment, storage::Time time, storage::Time now);
  /// Telemetry of the equipment has reached `time`; it never goes back. Beyond the year 2200, or as
  /// long before 1970, it counts as these.
  void reached(std::size_t equipment, storage::Time time);
  /// Asks for the window that ends at `end`, and begins at `begin` where that is given.
  void ask(std::size_t equipment, storage::Time end, std::string cause, storage::Time now,
           std::optional<storage::Time> begin = std::nullopt);
  /// The window was tried in an earlier run of the service.
  void tried_before(std::size_t equipment, storage::TimeRange window);
  /// The window was tried by another service now, and is due here no more.
  void tried_elsewhere(std::size_t equipment, storage::TimeRange window);

  /// The next window to identify, which then counts as running; absent when none is due.
  std::optional<Job> next(storage::Time now);
  /// The job that `next` gave is over. `completed` is false when it has to be tried once more.
  void finished(const Job& job, bool completed, storage::Time now);

  /// Where the telemetry of the equipment ends; the lowest time where none came.
  storage::Time reached(std::size_t equipment) const { return equipment_[equipment].reached; }

  /// Telemetry up to here belongs to no window that has still to be tried for the first time.
  storage::Time tried_until(std::size_t equipment) const;

  /// When `next` may give a job without any further call; absent when only new telemetry can.
  std::optional<storage::Time> next_due() const;
  /// Windows due or running, those that settle included.
  std::size_t pending() const;
  /// Whether a touched or running window of the equipment overlaps `range`.
  bool pending_within(std::size_t equipment, storage::TimeRange range) const;

 private:
  using Begin = std::optional<storage::Time>;  // absent: as long as planned
  struct Due {
    storage::Time touched = 0;  // when something last fell into it
    std::string cause;
    Begin begin{};
  };
  struct Running {
    storage::Time end = 0;
    Begin begin{};
  };
  struct Equipment {
    Plan plan;
    storage::Time reached = INT64_MIN;
    // Windows by their ends.
    std::map<storage::Time, Due> due{};
    std::map<storage::Time, Begin> tried{};
    std::optional<Running> running{};
    std::uint64_t turn = 0;  // that it had last
  };

  std::vector<Equipment> equipment_;
  Duration settle_;
  std::uint64_t turns_ = 0;
};

}  // namespace reident
