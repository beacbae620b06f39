// What the programs that publish telemetry have in common: their options, exit statuses and
// summary.
#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>

#include "service/satcs/publisher.hpp"
#include "service/support/stop_signal.hpp"

namespace reident::satcs {

/// Exit statuses of satcs-replay and satcs-reference.
enum ExitCode : int {
  exit_complete = 0,       // every reader has every frame
  exit_failed = 1,         // the middleware or the machine failed
  exit_bad_request = 2,    // one line says what is wrong and what would mend it
  exit_not_delivered = 3,  // readers were missing, or did not take everything, within the time-out
  exit_signal = 128,       // plus the number of the signal that stopped it before it was complete
};

/// A request that cannot be met: what is wrong and what would mend it.
class BadRequest : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Adds an option whose text becomes `value` by `parse`, or is refused with a sentence on what it
/// takes. `value` has to live until the command line was parsed.
template <class T, class Parsed>
CLI::Option* add_parsed(CLI::App& app, const std::string& name, T& value,
                        std::optional<Parsed> (*parse)(std::string_view),
                        const std::string& description, const std::string& takes) {
  return app.add_option_function<std::string>(
      name,
      [&value, parse, takes, name](const std::string& text) {
        auto parsed = parse(text);
        if (!parsed) throw CLI::ValidationError(name, "'" + text + "' is not " + takes);
        value = *std::move(parsed);
      },
      description);
}

/// Adds --spacecraft, --source, --origin, --first-sequence, --speed and all that says how frames
/// are published. What the three hold before are the defaults.
void add_publisher_options(CLI::App& app, Sender& sender, PublisherOptions& options, bool& json);

/// Parses the command line and does the work; every failure becomes one line on standard error.
/// Returns the exit status.
int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& work);

/// Publishes all of `stream` until the stop, and prints the summary; `more` gives a JSON object
/// whose fields the summary gets too. Returns the exit status. Throws BadRequest where a service
/// would refuse a name, dds::Error, and what the stream throws.
int publish_and_report(FrameStream& stream, const Sender& sender, const PublisherOptions& options,
                       bool json, const StopSignal& stop,
                       const std::function<std::string()>& more = {});

}  // namespace reident::satcs
