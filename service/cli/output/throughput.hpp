// How fast a long work goes and when it will be done, for the line of its progress bar.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace reident::cli {

/// "1234567": "1.23 M"; below ten thousand all digits.
std::string short_count(double count);

/// "90s", "34min", "5.2h", "3.1d".
std::string rough_duration(double seconds);

class Throughput {
 public:
  using Clock = std::chrono::steady_clock;
  explicit Throughput(Clock::time_point start = Clock::now()) : start_(start) {}

  /// "12.3 M samples, 1.05 M/s, 3min left": `done` of them so far, with `fraction` of the work
  /// behind it. What lay behind it at the first call does not count as this run's.
  std::string text(double fraction, std::uint64_t done, Clock::time_point now = Clock::now());
  double seconds(Clock::time_point now = Clock::now()) const {
    return std::chrono::duration<double>(now - start_).count();
  }

 private:
  Clock::time_point start_;
  struct Mark {
    Clock::time_point time;
    double fraction;
  };
  std::optional<Mark> first_;
};

}  // namespace reident::cli
