// satcs-reference: the reference spacecraft, publishing its telemetry.

#include <memory>
#include <string>

#include "service/satcs/csv_export.hpp"
#include "service/satcs/program.hpp"
#include "service/satcs/reference_source.hpp"
#include "service/support/time_text.hpp"

namespace {

using namespace reident::satcs;

constexpr const char* about =
    "Simulates the electrical power subsystem of a CBERS-4-class spacecraft and publishes its\n"
    "telemetry at 1 Hz. The same start and seed give the same telemetry.\n\n"
    "Examples:\n"
    "  satcs-reference --duration 12h --speed 600\n"
    "  satcs-reference --start 2017-07-01T06:00:00Z --duration 3d --speed max --seed 7 --json\n"
    "  satcs-reference --duration 6h --csv reference.csv\n"
    "  satcs-reference --duration 12h --speed 600 --simulated\n\n"
    "Exit status: 0 every reader has every frame; 1 failure; 2 bad request; 3 readers were "
    "missing\n"
    "or did not take everything; 128 + N stopped by signal N.\n";

std::optional<std::int64_t> parse_positive_duration(std::string_view text) {
  const auto duration = reident::parse_duration(text);
  return duration && *duration > 0 ? duration : std::nullopt;
}

void add_reference_options(CLI::App& app, ReferenceOptions& options) {
  add_parsed(app, "--start", options.start, reident::parse_time, "Time of the first frame",
             "a time such as 2017-07-01T00:00:00Z")
      ->type_name("TIME")
      ->default_str(reident::time_text(options.start));
  add_parsed(app, "--duration", options.duration_ns, parse_positive_duration,
             "How much telemetry to publish", "a duration above 0 such as 12h")
      ->type_name("DURATION")
      ->default_str(reident::duration_text(options.duration_ns));
  app.add_option("--seed", options.seed, "Seed of noise and operations")->capture_default_str();
}

std::unique_ptr<FrameSource> source_of(const ReferenceOptions& options, bool simulated) {
  if (simulated) return std::make_unique<HandwrittenSource>(options);
  return std::make_unique<ReferenceSource>(options);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(about, "satcs-reference");
  ReferenceOptions reference;
  PublisherOptions publisher;
  publisher.spacecraft = "REFERENCE";
  publisher.source = "reference";
  bool json = false;
  bool simulated = false;
  std::string csv;
  add_reference_options(app, reference);
  app.add_option("--csv", csv, "Write the telemetry to this file and publish nothing")
      ->type_name("FILE");
  app.add_flag("--simulated", simulated,
               "The telemetry of a simplified, hand-written simulation of the same spacecraft and\n"
               "operations instead, from source 'simulator' with origin 'simulated'");
  add_publisher_options(app, publisher, json);
  return run_program(app, argc, argv, [&]() -> int {
    if (simulated) {
      publisher.origin = reident::storage::Origin::simulated;
      if (app.count("--source") == 0) publisher.source = "simulator";
    }
    const auto source = source_of(reference, simulated);
    if (csv.empty()) return publish_and_report(*source, publisher, json);
    write_csv(*source, csv);
    return exit_complete;
  });
}
