// Clocks that go back from one row to the next.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace reident::telemetry_file {

/// A step back between two rows, and what it looks like.
struct ClockStep {
  enum class Kind {
    out_of_order,  // nothing known: a row that came late
    hour,          // an hour: daylight saving of a local time
    half_day,      // twelve hours: a clock of twelve hours without AM and PM
    restart,       // to zero: whatever counts began again
    wrap,          // a counter of a whole number of bits or of a day or week began again
  };
  Kind kind = Kind::out_of_order;
  std::uint64_t line = 0;
  std::int64_t back_ns = 0;     // how far
  std::int64_t missing_ns = 0;  // what continues the clock where it is added; 0: nothing does
  std::string what;             // "goes back 1h: local time at the end of daylight saving"
};

/// Looks at the times of rows in their order.
class ClockWatch {
 public:
  /// Watches a clock in units of `unit_ns`, which counts since `since_ns`, or shows dates;
  /// `may_be_local`: it may have a daylight change. Where the newest comes first, steps back are
  /// usual, and steps ahead are told.
  ClockWatch(std::int64_t unit_ns, std::optional<std::int64_t> since_ns, bool may_be_local,
             bool is_newest_first = false)
      : unit_ns_(unit_ns),
        since_ns_(since_ns),
        may_be_local_(may_be_local),
        is_newest_first_(is_newest_first) {}

  /// Returns the step where the time is earlier than the one before, or stands still for the hour
  /// that a local clock is set back; where the newest comes first, the step where such a clock goes
  /// the other way.
  std::optional<ClockStep> next(std::int64_t time_ns, std::uint64_t line);
  /// The first line before which a local clock goes ahead an hour, in the night; 0: it does not.
  std::uint64_t hour_ahead_line() const { return hour_ahead_line_; }

 private:
  ClockStep explained(std::int64_t time_ns, std::uint64_t line) const;
  bool begins_daylight_saving(std::int64_t time_ns) const;
  bool repeats_an_hour(std::int64_t time_ns) const;

  std::int64_t unit_ns_;
  std::optional<std::int64_t> since_ns_;
  bool may_be_local_;
  bool is_newest_first_;
  std::optional<std::int64_t> last_ns_;
  std::int64_t usual_ns_ = 0;  // the last step ahead
  std::uint64_t hour_ahead_line_ = 0;
};

}  // namespace reident::telemetry_file
