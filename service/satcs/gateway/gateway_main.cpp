// satcs-gateway: CCSDS space packets as SATCS telemetry, by an XTCE database.

#include <algorithm>
#include <csignal>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "service/satcs/gateway/database_text.hpp"
#include "service/satcs/gateway/packet_stream.hpp"
#include "service/satcs/gateway/xtce_reader.hpp"
#include "service/satcs/program.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/terminal.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

namespace {

using namespace reident::satcs;
using reident::StopSignal;
using reident::csv::Error;

constexpr const char* about =
    "Publishes the telemetry in CCSDS space packets as SATCS telemetry frames, one frame a "
    "packet.\n"
    "An XTCE 1.2 database says what is in the packets.\n\n"
    "Examples:\n"
    "  satcs-gateway eps.xml --list\n"
    "  satcs-gateway eps.xml packets.bin --time cuc:4.2 --check\n"
    "  satcs-gateway eps.xml packets.bin --spacecraft SAT-1 --time cds:2.2 --speed max\n"
    "  satcs-gateway eps.xml --udp 10015 --spacecraft SAT-1 --time pfield\n\n"
    "Exit status: 0 every reader has every frame; 1 failure; 2 bad request; 3 readers were "
    "missing\n"
    "or did not take everything; 128 + N stopped by signal N before that.\n";

struct Arguments {
  std::string database;
  std::string packets;
  std::uint16_t udp = 0, tcp = 0;
  std::optional<TimeCode> time;
  std::optional<reident::storage::Time> epoch;
  bool counts_leap_seconds = false;
  bool is_strict = false, lists = false, checks = false;
  PacketOptions options;
};

void add_gateway_options(CLI::App& app, Arguments& arguments) {
  app.add_option("database", arguments.database, "XTCE database")->required()->type_name("XML");
  app.add_option("packets", arguments.packets,
                 "File of packets, one behind the other; - for "
                 "standard input")
      ->type_name("FILE");
  app.add_option("--udp", arguments.udp, "Take packets from datagrams to this port of 127.0.0.1")
      ->check(CLI::Range(1, 65535))
      ->type_name("PORT");
  app.add_option("--tcp", arguments.tcp, "Take packets from connections to this port of 127.0.0.1")
      ->check(CLI::Range(1, 65535))
      ->type_name("PORT");
  add_parsed(app, "--time", arguments.time, parse_time_code,
             "Where a packet's time is: " + std::string(time_code_form), "a time code")
      ->type_name("CODE");
  add_parsed(app, "--epoch", arguments.epoch, reident::parse_time,
             "The time's epoch, where it is not 1958-01-01 (TAI, whose leap seconds are taken out)",
             "a time such as 2000-01-01T12:00:00Z")
      ->type_name("TIME");
  app.add_flag("--leap-seconds", arguments.counts_leap_seconds,
               "Seconds since --epoch count on through leap seconds");
  app.add_option("--prefix", arguments.options.prefix_bytes, "Bytes before each packet to skip")
      ->check(CLI::Range(0, 4096))
      ->type_name("BYTES");
  app.add_option("--only", arguments.options.only, "Parameters to publish, separated by commas")
      ->delimiter(',')
      ->type_name("NAMES");
  app.add_flag("--force-times", arguments.options.force_times,
               "Take times before 1990 or later than tomorrow");
  app.add_flag("--strict", arguments.is_strict,
               "Stop where the database has anything that the gateway does not know");
  app.add_flag("--list", arguments.lists, "Show the parameters that packets bring, and no more");
  app.add_flag("--check", arguments.checks,
               "Show what the database and the packets yield, and publish nothing");
}

/// Throws BadRequest.
template <class T>
T accepted(std::variant<T, Error>&& result) {
  if (const auto* error = std::get_if<Error>(&result)) throw BadRequest(error->message);
  return std::get<T>(std::move(result));
}

bool has_source(const Arguments& arguments) {
  return !arguments.packets.empty() || arguments.udp != 0 || arguments.tcp != 0;
}

std::unique_ptr<PacketSource> open_source(const Arguments& arguments) {
  if ((arguments.packets.empty() ? 0 : 1) + (arguments.udp != 0) + (arguments.tcp != 0) != 1)
    throw BadRequest("give a file of packets, --udp or --tcp, and one of them alone");
  if (arguments.udp != 0) return udp_source(arguments.udp);
  if (arguments.tcp != 0) return tcp_source(arguments.tcp);
  return file_source(arguments.packets);
}

void choose_time(Arguments& arguments) {
  if (!arguments.time)
    throw BadRequest("give --time, where a packet's time is: " + std::string(time_code_form));
  if (arguments.counts_leap_seconds && !arguments.epoch)
    throw BadRequest("--leap-seconds is about --epoch; that of 1958 has them taken out already");
  constexpr reident::storage::Time latest = 7'258'118'400 * reident::storage::second_ns;  // 2200
  if (arguments.epoch && (*arguments.epoch < -latest || *arguments.epoch > latest))
    throw BadRequest("--epoch is too far away");
  arguments.options.time = *arguments.time;
  arguments.options.time.epoch = arguments.epoch;
  arguments.options.time.counts_leap_seconds = arguments.counts_leap_seconds;
}

/// Says what the gateway does not know; throws BadRequest where that is not allowed.
void say_notes(const xtce::Database& database, const Arguments& arguments) {
  for (const std::string& line : note_lines(database, arguments.database))
    reident::print_error("satcs-gateway: {}", line);
  if (arguments.is_strict && !database.notes.empty())
    throw BadRequest(
        fmt::format("{}: {} things are not known to the gateway; correct them, or "
                    "leave --strict out",
                    arguments.database, database.notes.size()));
}

int check(PacketStream& stream) {
  reident::storage::TelemetryFrame frame;
  std::uint64_t frames = 0, samples = 0;
  reident::storage::TimeRange range;
  while (stream.next(frame)) {
    if (frames == 0) range = {frame.generation_time, frame.generation_time};
    range.begin = std::min(range.begin, frame.generation_time);
    range.end = std::max(range.end, frame.generation_time);
    samples += frame.samples.size();
    ++frames;
  }
  fmt::print("{} frames with {} samples", frames, samples);
  if (frames > 0)
    fmt::print(", {} to {}", reident::time_text(range.begin), reident::time_text(range.end));
  fmt::print("\n");
  for (const std::string& line : stream.counts().sentences()) fmt::print("{}\n", line);
  return exit_complete;
}

int run(Arguments& arguments, const Sender& sender, const PublisherOptions& publisher, bool json) {
  const auto database = accepted(xtce::read_database(arguments.database));
  say_notes(database, arguments);
  auto parameters = accepted(gateway_parameters(database, arguments.options.only));
  if (arguments.checks) fmt::print("{}\n", summary_line(database, parameters));
  if (arguments.lists)
    for (const std::string& line : parameter_lines(database, parameters)) fmt::print("{}\n", line);
  if (arguments.lists || (arguments.checks && !has_source(arguments))) return exit_complete;
  if (!arguments.checks && publisher.spacecraft.empty())
    throw BadRequest("--spacecraft is required; see satcs-gateway --help");
  choose_time(arguments);
  auto source = open_source(arguments);
  const StopSignal stop;
  PacketStream stream(database, std::move(parameters), arguments.options, std::move(source), sender,
                      reident::utc_now, stop.token());
  if (arguments.checks) return check(stream);
  const int status = publish_and_report(stream, sender, publisher, json, stop,
                                        [&stream] { return stream.counts().json(); });
  for (const std::string& line : stream.counts().sentences())
    reident::print_error("satcs-gateway: {}", line);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // who reads the log may end; the gateway goes on
  CLI::App app(about, "satcs-gateway");
  Arguments arguments;
  Sender sender{.source = "gateway"};
  PublisherOptions publisher;
  bool json = false;
  add_gateway_options(app, arguments);
  add_publisher_options(app, sender, publisher, json);
  return run_program(app, argc, argv, [&] {
    if ((arguments.udp != 0 || arguments.tcp != 0) && app.count("--speed") == 0)
      publisher.speed = std::numeric_limits<double>::infinity();
    return run(arguments, sender, publisher, json);
  });
}
