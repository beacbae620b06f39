#include "service/support/stop_signal.hpp"

#include <csignal>

namespace reident {
namespace {

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

StopSignal::StopSignal() {
  const sigset_t signals = stop_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  thread_ = std::thread([this] { wait(); });
}

StopSignal::~StopSignal() {
  done_ = true;
  pthread_kill(thread_.native_handle(), SIGTERM);
  thread_.join();
}

void StopSignal::wait() {
  const sigset_t signals = stop_signals();
  while (true) {
    int number = 0;
    sigwait(&signals, &number);
    if (done_) return;
    if (number_ != 0) {
      std::signal(number, SIG_DFL);
      pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
      std::raise(number);
    }
    number_ = number;
    source_.request_stop();
  }
}

}  // namespace reident
