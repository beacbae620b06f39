// SIGINT and SIGTERM as a stop token, so that a program ends where it stands, cleanly.
#pragma once

#include <atomic>
#include <stop_token>
#include <thread>

namespace reident {

/// Make one at the start of main, before any other thread: threads that exist already would still
/// die of the signals. The first signal requests the stop; the second one ends the process, as it
/// would have without this object. One object a process. Signals stay blocked after its end.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// Any thread may ask the token, and wait by it.
  std::stop_token token() const { return source_.get_token(); }
  /// The signal that came (SIGINT or SIGTERM); 0 where none did. Any thread may ask.
  int number() const { return number_; }

 private:
  void wait();

  std::stop_source source_;
  std::atomic<int> number_{0};
  std::atomic<bool> done_{false};
  std::thread thread_;
};

}  // namespace reident
