// satcs-reference: the reference spacecraft, publishing its telemetry.

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "service/satcs/csv_export.hpp"
#include "service/satcs/faults/faulty_stream.hpp"
#include "service/satcs/program.hpp"
#include "service/satcs/programs.hpp"
#include "service/satcs/reference/life_text.hpp"
#include "service/satcs/reference/random.hpp"
#include "service/satcs/reference/reference_stream.hpp"
#include "service/support/output_file.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/time_text.hpp"

namespace reident::satcs {
namespace {

constexpr const char* about_reference =
    "Simulates the electrical power subsystem of a CBERS-4-class spacecraft, or its platform\n"
    "(thermal nodes, reaction wheels, transmitter), and publishes the telemetry at 1 Hz. The same\n"
    "start and seed give the same telemetry.\n\n"
    "Examples:\n"
    "  satcs-reference --duration 12h --speed 600\n"
    "  satcs-reference --start 2017-07-01T06:00:00Z --duration 3d --speed max --seed 7 --json\n"
    "  satcs-reference --duration 6h --csv reference.csv\n"
    "  satcs-reference --duration 12h --speed 600 --simulated\n"
    "  satcs-reference --duration 30d --speed max --life capacity_fade@+5d/+25d*0.2#1 \\\n"
    "      --life lost_string@2017-07-11#4\n"
    "  satcs-reference --duration 2d --speed max --fault stuck@+6h/+8h:V_BUS \\\n"
    "      --fault bias_step@+1d/+30h:I_BUS*0.5 --fault passes_lost@+12h/+36h\n"
    "  satcs-reference --family platform --duration 30d --speed max --life "
    "bearing_wear@+9d*0.5#1\n\n"
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
  add_parsed(
      app, "--family", options.family, parse_family,
      "What is simulated: power, the electrical power subsystem; or platform, thermal nodes,\n"
      "reaction wheels and a transmitter, by default of the spacecraft PLATFORM",
      "power or platform")
      ->type_name("FAMILY")
      ->default_str("power");
}

/// Throws BadRequest.
std::vector<reference::LifeEvent> parse_life(const std::vector<std::string>& texts,
                                             reident::storage::Time start, Family family) {
  std::vector<reference::LifeEvent> life;
  for (const std::string& text : texts) {
    const auto parsed = parse_life_event(text, start);
    if (const auto* error = std::get_if<LifeError>(&parsed)) {
      throw BadRequest("--life: " + error->message);
    }
    life.push_back(std::get<reference::LifeEvent>(parsed));
    if (!reference::happens_to(family, life.back().kind)) {
      throw BadRequest(fmt::format(
          "--life: '{}' does not happen to the family {}; give --family {}", text, name(family),
          name(family == Family::power ? Family::platform : Family::power)));
    }
  }
  return life;
}

/// What the ground receives of `truth`. Throws BadRequest.
std::unique_ptr<FrameStream> with_faults(std::unique_ptr<FrameStream> truth,
                                         const std::vector<std::string>& texts,
                                         const ReferenceOptions& options) {
  const auto parameters = truth->parameters();
  std::vector<Fault> faults;
  for (const std::string& text : texts) {
    auto parsed = parse_fault(text, options.start, mix(options.seed + faults.size()));
    if (const auto* error = std::get_if<FaultError>(&parsed)) {
      throw BadRequest("--fault: " + error->message);
    }
    auto& fault = std::get<Fault>(parsed);
    if (const auto error = obstacle(fault, parameters))
      throw BadRequest("--fault: " + error->message);
    faults.push_back(std::move(fault));
  }
  return std::make_unique<FaultyStream>(
      std::move(truth), faults,
      FaultInjectorOptions{options.constants, options.life, options.seed, options.family});
}

}  // namespace

int reference_main(int argc, char** argv) {
  CLI::App app(about_reference, "satcs-reference");
  ReferenceOptions options;
  Sender sender{.source = "reference"};
  PublisherOptions publisher;
  publisher.spacecraft = "REFERENCE";
  bool json = false;
  bool simulated = false;
  bool replace = false;
  std::string csv;
  std::vector<std::string> life, faults;
  add_reference_options(app, options);
  app.add_option("--csv", csv, "Write the telemetry to this file and publish nothing")
      ->type_name("FILE");
  app.add_flag("--replace", replace, "Replace a file of --csv that exists");
  app.add_flag("--simulated", simulated,
               "The telemetry of a simplified, hand-written simulation of the same spacecraft and\n"
               "operations instead, from source 'simulator' with origin 'simulated'");
  app.add_option("--life", life,
                 "What happens to the spacecraft at a time, or between two, or as many durations\n"
                 "after the start; may be given again. Kinds: " +
                     life_kind_names())
      ->type_name("KIND@TIME[/TIME][*MAGNITUDE][#UNIT]")
      ->allow_extra_args(false);
  app.add_option("--fault,--lie", faults,
                 "What befalls the telemetry between two times, or two durations after the start;\n"
                 "may be given again. Kinds: " +
                     fault_kind_names())
      ->type_name("KIND@FROM/TO[:PARAMETER[,OTHER]][*MAGNITUDE][#SEED]")
      ->allow_extra_args(false);
  add_publisher_options(app, sender, publisher, json);
  return run_program(app, argc, argv, [&]() -> int {
    if (simulated) {
      sender.origin = reident::storage::Origin::simulated;
      if (app.count("--source") == 0) sender.source = "simulator";
    }
    if (options.family == Family::platform && app.count("--spacecraft") == 0)
      publisher.spacecraft = "PLATFORM";
    options.life = parse_life(life, options.start, options.family);
    auto stream =
        simulated ? handwritten_stream(options, sender) : reference_stream(options, sender);
    if (!faults.empty()) stream = with_faults(std::move(stream), faults, options);
    const reident::StopSignal stop;
    if (csv.empty()) return publish_and_report(*stream, sender, publisher, json, stop);
    if (!replace && std::filesystem::exists(csv))
      throw BadRequest(csv + " exists; name another file, or replace it with --replace");
    using reident::OutputFile;
    OutputFile file(csv, replace ? OutputFile::Existing::replaced : OutputFile::Existing::kept);
    return write_csv(*stream, file, stop.token()) ? exit_complete : exit_signal + stop.number();
  });
}

}  // namespace reident::satcs
