// A progress bar on a terminal; silence anywhere else.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>

namespace reident {

/// Does not own its stream, which has to outlive it. One thread at a time. The destructor clears
/// it.
class Progress {
 public:
  using Clock = std::chrono::steady_clock;

  /// Draws on `out` when it is a terminal.
  explicit Progress(std::FILE* out = stderr);
  /// Draws on `out` when `enabled`.
  Progress(std::FILE* out, bool enabled);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Whether update() would draw: on a terminal, ten times a second. `now` is given in tests.
  bool due(Clock::time_point now = Clock::now()) const;
  /// Draws when it is due. `fraction` is held to [0, 1], a NaN is shown as 0; `detail`, one short
  /// line, follows the bar.
  void update(double fraction, std::string_view detail, Clock::time_point now = Clock::now());
  /// As above, for what has no end that is known: the detail alone.
  void update(std::string_view detail, Clock::time_point now = Clock::now());
  /// Takes the bar off the terminal, so that other text can be written.
  void clear();

 private:
  void draw(const std::string& line, Clock::time_point now);

  std::FILE* out_;
  bool enabled_;
  bool drawn_ = false;
  Clock::time_point last_draw_{};
};

}  // namespace reident
