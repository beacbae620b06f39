// reident-simulator: subscribes to the approved models and runs them along with live telemetry.
#include <cstdio>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "service/client/simulator.hpp"
#include "service/support/command_line.hpp"
#include "service/support/log.hpp"
#include "service/support/stop_signal.hpp"

namespace {

constexpr const char* about =
    "Runs the approved models of a spacecraft's equipment along with its live telemetry: each new\n"
    "version takes over while it runs, and the running error of each version is printed.\n\n"
    "Example:\n"
    "  reident-simulator --spacecraft CBERS4 --equipment BDR --equipment BAT1 --name trainer-1\n\n"
    "Exit status: 0 stopped by SIGINT or SIGTERM; 1 failure; 2 bad request.\n";

void add_options(CLI::App& app, reident::SimulatorOptions& options, std::string& cache,
                 double& report_s) {
  app.add_option("--spacecraft", options.subscription.spacecraft,
                 "Spacecraft to simulate; * and ? stand for any text and any character")
      ->required()
      ->type_name("NAME");
  app.add_option("--equipment", options.subscription.equipment,
                 "Equipment to simulate, also with * and ?; may be given again (every one)")
      ->type_name("NAME");
  app.add_option("--cache", cache,
                 "Folder of the last good versions, for a start without a service; \"\": none "
                 "($XDG_CACHE_HOME/reident or ~/.cache/reident)")
      ->type_name("FOLDER");
  app.add_option("--name", options.subscription.simulator,
                 "Name of this simulator, unique in its partition")
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--domain", options.endpoint.domain, "DDS domain")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  app.add_option("--partition", options.endpoint.partition, "DDS partition")->capture_default_str();
  app.add_option("--security", options.endpoint.security,
                 "On a secured domain: folder of the simulator's certificate")
      ->envname("REIDENT_SECURITY")
      ->type_name("FOLDER");
  app.add_option("--report", report_s, "Seconds between two reports of the running errors")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  app.add_flag_callback(
      "--follow", [&options] { options.mode = reident::LiveEquipment::Mode::following; },
      "Correct each model by the measured outputs, as a trainer that follows the satellite does "
      "(the models run free)");
  app.add_flag("--json", options.json, "One JSON object a line");
}

}  // namespace

int main(int argc, char** argv) {
  reident::SimulatorOptions options;
  options.endpoint.simulator = true;
  options.subscription.simulator = "simulator-" + std::to_string(getpid());
  std::string cache = reident::ModelCache::default_folder().value_or("").string();
  double report_s = 5;
  CLI::App app(about, "reident-simulator");
  add_options(app, options, cache, report_s);
  if (const auto status = reident::parse_command_line(app, argc, argv)) return *status;
  if (!cache.empty()) options.cache = cache;
  options.report_period =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(report_s));
  try {
    const reident::StopSignal stop;
    reident::Simulator(options).run(stop.token());
  } catch (const std::exception& error) {
    reident::log::error("simulator", error.what());
    return 1;
  }
  return 0;
}
