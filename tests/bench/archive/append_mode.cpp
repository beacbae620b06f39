#include <algorithm>

#include "tests/bench/archive/modes.hpp"

namespace reident::bench {
namespace {

struct AppendOptions {
  StoreChoice store;
  std::uint64_t frames = 0;
  std::size_t batch = 512;
  std::size_t parameters = 629;
  std::vector<std::string> spacecraft{mission};
  bool load = false;
  bool leave = false;
};

struct Times {
  double append = 0, longest = 0, processor = 0;
};

// The frames of a batch are made before its time begins. Of several spacecraft they alternate.
Times append_batches(TelemetryStore& store, const MissionTelemetry& telemetry, std::uint64_t first,
                     const AppendOptions& options) {
  Times times;
  std::vector<storage::TelemetryFrame> batch;
  const std::uint64_t all = options.frames * options.spacecraft.size();
  for (std::uint64_t done = 0; done < all; done += batch.size()) {
    batch.resize(std::min<std::uint64_t>(options.batch, all - done));
    for (std::size_t i = 0; i < batch.size(); ++i)
      telemetry.fill(first + (done + i) / options.spacecraft.size(),
                     options.spacecraft[(done + i) % options.spacecraft.size()], batch[i]);
    const double begin = seconds_now(), processor = processor_seconds();
    store.append(batch);
    const double took = seconds_now() - begin;
    times.processor += processor_seconds() - processor;
    times.append += took;
    times.longest = std::max(times.longest, took);
  }
  return times;
}

void run(const AppendOptions& options) {
  const MissionTelemetry telemetry(options.parameters);
  auto store = open_store(options.store.kind, options.store.file, Access::write);
  const auto extent = store->extent();
  const std::uint64_t first = extent ? MissionTelemetry::frame_at(extent->end - 1) + 1 : 0;
  for (const std::string& spacecraft : options.spacecraft)
    store->describe(telemetry.descriptors(spacecraft));
  const double own_mib = peak_mib();
  Times times;
  const double begin = seconds_now();
  if (options.load)
    store->load(telemetry, first, options.frames);
  else
    times = append_batches(*store, telemetry, first, options);
  const double appended = seconds_now(), processor = processor_seconds();
  if (!options.leave) store->settle();
  store.reset();  // folds the log into the file
  const double end = seconds_now();
  times.processor += processor_seconds() - processor;
  if (options.load) times.append = appended - begin;
  print({{"samples", options.frames * options.spacecraft.size() * options.parameters},
         {"append_s", times.append},
         {"settle_s", end - appended},
         {"processor_s", times.processor},
         {"longest_append_ms", times.longest * 1e3},
         {"peak_mib", peak_mib()},
         {"own_mib", own_mib}});
}

}  // namespace

void add_append(CLI::App& app) {
  auto options = std::make_shared<AppendOptions>();
  CLI::App* mode = app.add_subcommand("append", "Appends frames behind those that are there");
  options->store.add_to(*mode);
  mode->add_option("--frames", options->frames, "How many of each spacecraft")->required();
  mode->add_option("--batch", options->batch, "Frames of a transaction")->capture_default_str();
  mode->add_option("--parameters", options->parameters, "Samples of a frame")
      ->capture_default_str();
  mode->add_option("--spacecraft", options->spacecraft, "Whose")->capture_default_str();
  mode->add_flag("--load", options->load, "As fast as it can be: measures nothing but the end");
  mode->add_flag("--leave", options->leave, "Leaves the work that append puts off");
  mode->callback([options] { run(*options); });
}

}  // namespace reident::bench
