// reident_bench_publisher: one source of frames of a mission's size, as fast as its readers take
// them. Prints when it began, on the clock that all processes of the machine share.
#include <chrono>
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "service/dds/dds.hpp"
#include "tests/bench/archive/mission_telemetry.hpp"
#include "tests/support/wait_for_reader.hpp"

namespace {

using namespace std::chrono_literals;
using reident::bench::MissionTelemetry;
using Clock = std::chrono::steady_clock;

struct Options {
  std::uint32_t domain = 0;
  std::string partition;
  std::string spacecraft;
  std::string security;
  std::uint64_t frames = 0;
  std::size_t parameters = 629;
};

double seconds_of(Clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

// The frames are made beforehand: only their publication is to cost.
void publish(const Options& options) {
  const MissionTelemetry telemetry(options.parameters);
  std::vector<reident::storage::TelemetryFrame> frames(options.frames);
  for (std::uint64_t k = 0; k < options.frames; ++k)
    telemetry.fill(k, options.spacecraft, frames[k]);
  reident::dds::Participant participant({options.domain, options.partition, options.security});
  reident::dds::Writer<reident::storage::TelemetryFrame> writer(participant);
  reident::test::wait_for_reader(writer);
  std::puts("ready");
  std::fflush(stdout);
  std::getchar();  // all publishers begin together
  const auto began = Clock::now();
  for (const auto& frame : frames) writer.write(frame);
  const auto written = Clock::now();
  if (!writer.wait_for_acknowledgments(60s)) throw std::runtime_error("a reader did not answer");
  std::printf("{\"began\": %.6f, \"written\": %.6f, \"acknowledged\": %.6f}\n", seconds_of(began),
              seconds_of(written), seconds_of(Clock::now()));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Publishes telemetry at full speed", "reident_bench_publisher");
  Options options;
  app.add_option("--domain", options.domain, "DDS domain")->required();
  app.add_option("--partition", options.partition, "DDS partition")->required();
  app.add_option("--spacecraft", options.spacecraft, "Whose telemetry")->required();
  app.add_option("--security", options.security, "Folder of the gateway's certificate");
  app.add_option("--frames", options.frames, "How many")->required();
  app.add_option("--parameters", options.parameters, "Samples of a frame")->capture_default_str();
  try {
    app.parse(argc, argv);
    publish(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "reident_bench_publisher: %s\n", error.what());
    return 1;
  }
  return 0;
}
