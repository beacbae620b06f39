// reidentd: the re-identification service.

#include <csignal>
#include <ctime>
#include <iostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "service/daemon/config.hpp"
#include "service/daemon/daemon.hpp"
#include "service/daemon/service_manager.hpp"
#include "service/support/log.hpp"
#include "service/support/version.hpp"

namespace {

constexpr int exit_failed = 1;
constexpr int exit_bad_request = 2;

reident::storage::Time utc_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Blocked in every thread that is started from here on; taken by wait_for_signal alone.
sigset_t block_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

/// The signal that came within a second; 0 where none did.
int wait_for_signal(const sigset_t& signals) {
  const timespec second{1, 0};
  const int number = sigtimedwait(&signals, nullptr, &second);
  return number > 0 ? number : 0;
}

int serve(const reident::Config& config, const sigset_t& signals) {
  reident::Daemon daemon(config, utc_now);
  daemon.start();
  reident::notify_service_manager("READY=1");
  int signal = 0;
  while (signal == 0 && !daemon.failed()) {
    daemon.heartbeat();
    reident::notify_service_manager("WATCHDOG=1");
    signal = wait_for_signal(signals);
  }
  reident::notify_service_manager("STOPPING=1");
  if (signal != 0) reident::log::info("service", "asked to stop", {{"signal", strsignal(signal)}});
  const bool all_stored = daemon.stop();
  return all_stored && !daemon.failed() ? 0 : exit_failed;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Identifies the equipment models of a satellite simulator again and again from telemetry,\n"
      "and publishes those that pass the gate.\n\n"
      "Example:\n  reidentd --config reident.toml\n");
  app.name("reidentd");
  app.set_version_flag("--version", std::string(reident::program_version()));
  std::string path;
  app.add_option("-c,--config", path, "Configuration file (see `reident check-config`)")
      ->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : exit_bad_request;
  }

  const auto loaded = reident::load_config(path);
  if (const auto* mistakes = std::get_if<std::vector<reident::ConfigMistake>>(&loaded)) {
    for (const reident::ConfigMistake& mistake : *mistakes)
      std::cerr << fmt::format("{}:{}: {}\n", path, mistake.line, mistake.message);
    return exit_bad_request;
  }
  const auto& config = std::get<reident::Config>(loaded);
  reident::log::set_level(config.log_level);
  const sigset_t signals = block_stop_signals();
  try {
    return serve(config, signals);
  } catch (const std::exception& error) {
    reident::log::error("service", "cannot run", {{"error", error.what()}});
    return exit_failed;
  }
}
