// reidentd: the re-identification service.

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <iostream>
#include <mutex>
#include <stdexcept>
#include <stop_token>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/resource.h>

#include "service/config/config.hpp"
#include "service/daemon/daemon.hpp"
#include "service/daemon/service_manager.hpp"
#include "service/dds/middleware_log.hpp"
#include "service/support/allocator.hpp"
#include "service/support/command_line.hpp"
#include "service/support/log.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/utc_clock.hpp"

namespace {

constexpr int exit_failed = 1;
constexpr int exit_bad_request = 2;

/// Waits for a second, or until the stop is requested.
void wait_a_second(const std::stop_token& stop) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any never;
  never.wait_for(lock, stop, std::chrono::seconds(1), [] { return false; });
}

/// SIGHUP asks to read the log level again. It is blocked before any thread begins, and looked for
/// once a second.
sigset_t reload_signal() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGHUP);
  return signals;
}

bool is_asked_to_reload() {
  const sigset_t signals = reload_signal();
  constexpr timespec at_once{};
  return sigtimedwait(&signals, nullptr, &at_once) == SIGHUP;
}

void reload(const std::string& path) {
  const auto loaded = reident::load_config(path);
  if (const auto* mistakes = std::get_if<std::vector<reident::ConfigMistake>>(&loaded)) {
    reident::log::error(
        "service", "the configuration has mistakes; everything stays as it is",
        {{"file", path}, {"line", mistakes->front().line}, {"mistake", mistakes->front().message}});
    return;
  }
  const auto& config = std::get<reident::Config>(loaded);
  reident::log::set_level("info");
  reident::log::info("service", "log level read again; other keys are read at a start",
                     {{"log_level", config.log_level}});
  reident::log::set_level(config.log_level);
}

/// Where there are too few, what fails is anything that opens a file, and its error names that.
void require_files(const reident::Config& config) {
  const rlim_t needed = 64 + 8 * config.workers;
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < needed)
    throw std::runtime_error(
        fmt::format("this process may open {} files and needs {}: raise the limit "
                    "(LimitNOFILE, ulimit -n)",
                    files.rlim_cur, needed));
}

int serve(const reident::Config& config, const std::string& path,
          const reident::StopSignal& signal) {
  require_files(config);
  reident::Daemon daemon(config, reident::utc_now, reident::steady_now);
  daemon.start();
  reident::notify_service_manager("READY=1");
  while (!signal.token().stop_requested() && !daemon.failed()) {
    daemon.heartbeat();
    if (is_asked_to_reload()) reload(path);
    if (daemon.goes_on()) reident::notify_service_manager("WATCHDOG=1");
    wait_a_second(signal.token());
  }
  reident::notify_service_manager("STOPPING=1");
  if (signal.number() != 0)
    reident::log::info("service", "asked to stop", {{"signal", strsignal(signal.number())}});
  const bool all_stored = daemon.stop();
  return all_stored && !daemon.failed() ? 0 : exit_failed;
}

}  // namespace

int main(int argc, char** argv) {
  reident::keep_freed_memory();
  const sigset_t reloading = reload_signal();
  pthread_sigmask(SIG_BLOCK, &reloading, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);  // beyond a file size limit a write fails, as on a full disk
  std::signal(SIGPIPE, SIG_IGN);  // who reads the log may end; the service goes on
  const reident::StopSignal signal;
  CLI::App app(
      "Identifies the equipment models of a satellite simulator again and again from telemetry,\n"
      "and publishes those that pass the gate.\n\n"
      "Example:\n  reidentd --config reident.toml\n");
  reident::dds::log_what_the_middleware_says();
  app.name("reidentd");
  std::string path;
  app.add_option("-c,--config", path, "Configuration file (see `reident check-config`)")
      ->required();
  if (const auto status = reident::parse_command_line(app, argc, argv)) return *status;

  const auto loaded = reident::load_config(path);
  if (const auto* mistakes = std::get_if<std::vector<reident::ConfigMistake>>(&loaded)) {
    for (const reident::ConfigMistake& mistake : *mistakes)
      std::cerr << fmt::format("{}:{}: {}\n", path, mistake.line, mistake.message);
    return exit_bad_request;
  }
  const auto& config = std::get<reident::Config>(loaded);
  reident::log::set_level(config.log_level);
  try {
    return serve(config, path, signal);
  } catch (const std::exception& error) {
    reident::log::error("service", "cannot run", {{"error", error.what()}});
    return exit_failed;
  }
}
