#include "tests/bench/archive/modes.hpp"

namespace reident::bench {
namespace {

struct AverageOptions {
  StoreChoice store;
  std::string extension;
  std::uint32_t parameter = 1;
  std::uint64_t skip_days = 1;
  std::uint64_t days = 30;
};

void run(const AverageOptions& options) {
  const auto store =
      open_store(options.store.kind, options.store.file, Access::read, options.extension);
  constexpr std::uint64_t day = 86'400;
  const storage::TimeRange range{MissionTelemetry::time(options.skip_days * day),
                                 MissionTelemetry::time((options.skip_days + options.days) * day)};
  const double begin = seconds_now();
  const double average = store->average(options.parameter, range);
  print({{"seconds", seconds_now() - begin}, {"average", average}});
}

}  // namespace

void add_average(CLI::App& app) {
  auto options = std::make_shared<AverageOptions>();
  CLI::App* mode = app.add_subcommand("average", "Average of a parameter over days, by SQL");
  options->store.add_to(*mode);
  mode->add_option("--extension", options->extension, "SQLite's module that shows the archive");
  mode->add_option("--parameter", options->parameter, "Which")->capture_default_str();
  mode->add_option("--skip-days", options->skip_days, "Days before them")->capture_default_str();
  mode->add_option("--days", options->days, "How many")->capture_default_str();
  mode->callback([options] { run(*options); });
}

}  // namespace reident::bench
