#include "service/satcs/program.hpp"

#include <cstdio>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/support/command_line.hpp"
#include "service/support/csv.hpp"
#include "service/support/log.hpp"
#include "service/support/rate_text.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/terminal.hpp"
#include "service/support/time_text.hpp"

namespace reident::satcs {
namespace {

std::optional<double> parse_speed(std::string_view text) {
  if (text == "max") return std::numeric_limits<double>::infinity();
  const auto speed = csv::to_number(text);
  return speed && *speed > 0 ? speed : std::nullopt;
}

std::optional<storage::Origin> parse_origin(std::string_view text) {
  for (const auto origin : {storage::Origin::real, storage::Origin::simulated}) {
    if (text == storage::name(origin)) return origin;
  }
  return std::nullopt;
}

std::optional<std::chrono::nanoseconds> parse_wait(std::string_view text) {
  const auto duration = parse_duration(text);
  if (!duration || *duration < 0) return std::nullopt;
  return std::chrono::nanoseconds(*duration);
}

std::optional<std::string> parse_name(std::string_view text) {
  if (text.empty()) return std::nullopt;
  return std::string(text);
}

/// For people; --json is for programs.
std::string sentence(const PublisherSummary& summary) {
  if (summary.frames == 0) return fmt::format("{}: no frame was published", name(summary.outcome));
  std::string text = fmt::format(
      "{}: {} frames with {} samples ({} invalid) of {} parameters, {} to {}, in {:.2f} s",
      name(summary.outcome), summary.frames, summary.samples, summary.invalid_samples,
      summary.parameters, time_text(summary.first_time), time_text(summary.last_time),
      summary.wall_s);
  if (summary.frames_missed > 0)
    text += fmt::format("; {} frames reached no archive", summary.frames_missed);
  return text;
}

/// For programs.
std::string to_json(const PublisherSummary& summary, const Sender& sender,
                    const PublisherOptions& options, const std::function<std::string()>& more) {
  nlohmann::ordered_json json = {
      {"outcome", name(summary.outcome)}, {"spacecraft", options.spacecraft},
      {"source", sender.source},          {"origin", storage::name(sender.origin)},
      {"parameters", summary.parameters}, {"frames", summary.frames},
      {"samples", summary.samples},       {"invalid_samples", summary.invalid_samples}};
  const bool any = summary.frames > 0;
  json["first_sequence"] = any ? nlohmann::ordered_json(summary.first_sequence) : nullptr;
  json["last_sequence"] = any ? nlohmann::ordered_json(summary.last_sequence) : nullptr;
  json["first_time"] = any ? nlohmann::ordered_json(time_text(summary.first_time)) : nullptr;
  json["last_time"] = any ? nlohmann::ordered_json(time_text(summary.last_time)) : nullptr;
  json["frames_missed"] = summary.frames_missed;
  json["wall_s"] = summary.wall_s;
  json["lost"] = nlohmann::ordered_json::array();
  for (const LostFrames& lost : summary.lost)
    json["lost"].push_back({{"frames", lost.frames},
                            {"first_time", time_text(lost.first_time)},
                            {"last_time", time_text(lost.last_time)}});
  if (more) json.update(nlohmann::ordered_json::parse(more()));
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// What to do about an outcome that is not the one asked for; empty where there is nothing.
std::string remedy(Outcome outcome, const PublisherOptions& options) {
  if (outcome == Outcome::no_readers) {
    return fmt::format(
        "fewer than {} readers came within the time-out; start reidentd on domain {} and partition "
        "'{}', or wait longer with --wait-timeout (a simulator alone is no archive)",
        options.wait_readers, options.endpoint.domain, options.endpoint.partition);
  }
  if (outcome == Outcome::not_acknowledged) {
    return "a reader did not take everything within the time-out; see whether it still runs, and "
           "replay again (what it has already is not stored twice)";
  }
  return {};
}

int exit_code(Outcome outcome, int signal) {
  switch (outcome) {
    case Outcome::complete:
      return exit_complete;
    case Outcome::stopped:
      return exit_signal + signal;
    case Outcome::no_readers:
    case Outcome::not_acknowledged:
      break;
  }
  return exit_not_delivered;
}

/// Throws BadRequest where a service would refuse what is sent, such as a name that is not UTF-8.
void check_names(const FrameStream& stream, const Sender& sender, const PublisherOptions& options) {
  storage::TelemetryFrame frame;
  frame.spacecraft = options.spacecraft;
  frame.source = sender.source;
  if (const auto reason = dds::refusal(frame)) throw BadRequest(*reason + "; give another name");
  for (auto descriptor : stream.parameters()) {
    descriptor.spacecraft = options.spacecraft;
    if (const auto reason = dds::refusal(descriptor))
      throw BadRequest(fmt::format("parameter '{}': a service would refuse it: {}; correct it",
                                   descriptor.name, *reason));
  }
}

int complain(const CLI::App& app, std::string_view message, int code) {
  print_error("{}: {}", app.get_name(), message);
  return code;
}

}  // namespace

void add_publisher_options(CLI::App& app, Sender& sender, PublisherOptions& options, bool& json) {
  add_parsed(app, "--spacecraft", options.spacecraft, parse_name, "Name of the spacecraft",
             "a name")
      ->type_name("NAME")
      ->default_str(options.spacecraft);
  add_parsed(app, "--source", sender.source, parse_name,
             "Name of the station or gateway that sends", "a name")
      ->type_name("NAME")
      ->default_str(sender.source);
  add_parsed(app, "--origin", sender.origin, parse_origin,
             "real, or simulated for telemetry of the simulator itself", "'real' or 'simulated'")
      ->type_name("ORIGIN")
      ->default_str("real");
  add_parsed(app, "--speed", options.speed, parse_speed,
             "Times real time, or max for as fast as the readers take it",
             "a number above 0 or 'max'")
      ->type_name("N|max")
      ->default_str("1");
  app.add_option("--first-sequence", sender.first_sequence, "Sequence number of the first frame")
      ->capture_default_str();
  app.add_option("--wait-readers", options.wait_readers,
                 "Write nothing while fewer readers are there, or no archive (a reader that keeps\n"
                 "all, as reidentd does) is among them; 0: write for whoever is there")
      ->capture_default_str();
  add_parsed(app, "--wait-timeout", options.wait_timeout, parse_wait,
             "Give up when readers, or their acknowledgments, are missing for so long",
             "a duration such as 30s")
      ->type_name("DURATION")
      ->default_str("never");
  app.add_option("--history", options.history, "Frames kept for readers that join late")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N")
      ->default_str("what --cut needs, or 2 MB of them");
  add_parsed(app, "--cut", options.cut.length, parse_wait,
             "Lose nothing while the network is cut for so long; needs --rate",
             "a duration such as 60s")
      ->type_name("DURATION");
  add_parsed(app, "--rate", options.cut.frames_per_s, parse_rate,
             "Frames that are sent meanwhile, for --cut", "a rate such as 100/s")
      ->type_name("N/s")
      ->needs("--cut");
  app.get_option("--cut")->needs("--rate");
  add_parsed(app, "--linger", options.linger, parse_wait,
             "Stay for readers that join late, so long after the last frame",
             "a duration such as 30s")
      ->type_name("DURATION")
      ->default_str("0s");
  app.add_option("--domain", options.endpoint.domain, "DDS domain")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  app.add_option("--partition", options.endpoint.partition, "DDS partition")->capture_default_str();
  app.add_option("--security", options.endpoint.security,
                 "On a secured domain: folder of the gateway's certificate")
      ->envname("REIDENT_SECURITY")
      ->type_name("FOLDER");
  app.add_flag("--json", json, "Print the summary as one JSON object");
}

int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& work) {
  if (const auto status = parse_command_line(app, argc, argv)) return *status;
  try {
    return work();
  } catch (const BadRequest& error) {
    return complain(app, error.what(), exit_bad_request);
  } catch (const std::exception& error) {
    return complain(app, error.what(), exit_failed);
  }
}

int publish_and_report(FrameStream& stream, const Sender& sender, const PublisherOptions& options,
                       bool json, const StopSignal& stop,
                       const std::function<std::string()>& more) {
  check_names(stream, sender, options);
  const PublisherSummary summary = publish(stream, options, stop.token());
  fmt::print("{}\n", json ? to_json(summary, sender, options, more) : sentence(summary));
  if (const std::string what = remedy(summary.outcome, options); !what.empty()) {
    log::error("satcs", what);
  }
  return exit_code(summary.outcome, stop.number());
}

}  // namespace reident::satcs
