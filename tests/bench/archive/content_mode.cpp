#include <bit>

#include "tests/bench/archive/modes.hpp"

namespace reident::bench {
namespace {

struct ContentOptions {
  std::string file;
  std::vector<std::string> spacecraft;
  std::uint64_t frames = 0;
  std::size_t parameters = 0;
};

/// What differs between what was sent and what an archive holds.
struct Differences {
  std::uint64_t lost = 0, wrong = 0, surplus = 0;
};

void compare(const storage::Series& stored, const MissionTelemetry& telemetry,
             std::size_t parameter, std::uint64_t frames, Differences& found) {
  std::uint64_t k = 0, matched = 0;
  for (std::size_t i = 0; i < stored.time.size(); ++i) {
    while (k < frames && MissionTelemetry::time(k) < stored.time[i]) ++k;
    if (k == frames || MissionTelemetry::time(k) != stored.time[i]) {
      ++found.surplus;
      continue;
    }
    const bool same = std::bit_cast<std::uint64_t>(stored.value[i]) ==
                          std::bit_cast<std::uint64_t>(telemetry.value(parameter, k)) &&
                      stored.quality[i] == storage::Quality::good;
    ++(same ? matched : found.wrong);
    ++k;
  }
  found.lost += frames - matched;
}

void run(const ContentOptions& options) {
  const MissionTelemetry telemetry(options.parameters);
  storage::Database database(options.file, storage::Database::Mode::read_only);
  const storage::Archive archive(database);
  Differences found;
  for (const std::string& spacecraft : options.spacecraft)
    for (std::size_t i = 0; i < options.parameters; ++i)
      compare(archive.read(spacecraft, storage::Origin::real, static_cast<std::uint32_t>(i + 1),
                           {INT64_MIN, INT64_MAX}),
              telemetry, i, options.frames, found);
  std::uint64_t repeated = 0, missing = 0;
  for (const storage::SourceCounts& source : archive.sources()) {
    repeated += source.duplicates + source.conflicts;
    missing += source.missing;
  }
  print({{"samples", archive.sample_count()},
         {"expected", options.frames * options.parameters * options.spacecraft.size()},
         {"lost", found.lost},
         {"wrong", found.wrong},
         {"surplus", found.surplus},
         {"received_again", repeated},
         {"sequence_missing", missing}});
}

}  // namespace

void add_content(CLI::App& app) {
  auto options = std::make_shared<ContentOptions>();
  CLI::App* mode =
      app.add_subcommand("content", "Compares an archive with what was sent, sample by sample");
  mode->add_option("file", options->file, "The archive")->required();
  mode->add_option("--spacecraft", options->spacecraft, "Those that were sent")->required();
  mode->add_option("--frames", options->frames, "Frames of each, from the first on")->required();
  mode->add_option("--parameters", options->parameters, "Samples of a frame")->required();
  mode->callback([options] { run(*options); });
}

}  // namespace reident::bench
