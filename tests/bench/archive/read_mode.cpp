#include <algorithm>
#include <bit>
#include <fcntl.h>
#include <random>
#include <unistd.h>

#include "tests/bench/archive/modes.hpp"

namespace reident::bench {
namespace {

struct ReadOptions {
  StoreChoice store;
  std::size_t windows = 30;
  std::uint64_t rows = 15'000;
  std::size_t series = 5;
  std::uint32_t parameters = 629;
  bool newest = false;
  bool cold = false;
};

/// Takes the file out of the kernel's cache.
void forget_pages(const std::string& file) {
  const int handle = ::open(file.c_str(), O_RDONLY);
  ::posix_fadvise(handle, 0, 0, POSIX_FADV_DONTNEED);
  ::close(handle);
}

// Order matters, place does not: the same samples give the same number in both stores.
void digest(const storage::Series& series, std::uint64_t& sum) {
  constexpr std::uint64_t prime = 1'099'511'628'211;
  for (std::size_t i = 0; i < series.time.size(); ++i)
    sum = (sum ^ std::bit_cast<std::uint64_t>(series.value[i]) ^
           static_cast<std::uint64_t>(series.time[i]) ^
           static_cast<std::uint64_t>(series.quality[i])) *
          prime;
}

void run(const ReadOptions& options) {
  const auto store = open_store(options.store.kind, options.store.file, Access::read);
  const auto extent = store->extent();
  if (!extent) throw std::runtime_error(options.store.file + " is empty");
  const std::uint64_t first = MissionTelemetry::frame_at(extent->begin);
  const std::uint64_t last = MissionTelemetry::frame_at(extent->end - 1) + 1;
  if (last - first < options.rows) throw std::runtime_error("fewer samples than a window has");
  constexpr std::uint64_t seed = 1;
  std::mt19937_64 random(seed);
  const auto below = [&](std::uint64_t bound) { return random() % bound; };

  std::vector<storage::Series> window(options.series);
  std::vector<double> times;
  std::uint64_t sum = 0, samples = 0;
  for (std::size_t w = 0; w < options.windows; ++w) {
    const std::uint64_t begin =
        options.newest ? last - options.rows : first + below(last - first - options.rows + 1);
    std::vector<std::uint32_t> parameter(options.series);
    for (auto& id : parameter) id = static_cast<std::uint32_t>(1 + below(options.parameters));
    const storage::TimeRange range{MissionTelemetry::time(begin),
                                   MissionTelemetry::time(begin + options.rows)};
    if (options.cold) forget_pages(options.store.file);
    const double start = seconds_now();
    for (std::size_t i = 0; i < options.series; ++i) store->read(parameter[i], range, window[i]);
    times.push_back((seconds_now() - start) * 1e3);
    for (const storage::Series& series : window) {
      digest(series, sum);
      samples += series.time.size();
    }
  }
  if (samples != options.windows * options.series * options.rows)
    throw std::runtime_error("a window is not whole");
  print({{"window_ms", times}, {"digest", sum}, {"peak_mib", peak_mib()}});
}

}  // namespace

void add_read(CLI::App& app) {
  auto options = std::make_shared<ReadOptions>();
  CLI::App* mode = app.add_subcommand("read", "Reads windows of several parameters into arrays");
  options->store.add_to(*mode);
  mode->add_option("--windows", options->windows, "How many, at random")->capture_default_str();
  mode->add_option("--rows", options->rows, "Samples of each parameter")->capture_default_str();
  mode->add_option("--series", options->series, "Parameters of a window")->capture_default_str();
  mode->add_option("--parameters", options->parameters, "To choose from")->capture_default_str();
  mode->add_flag("--newest", options->newest, "The newest samples rather than any");
  mode->add_flag("--cold", options->cold, "With nothing of the file in the kernel's cache");
  mode->callback([options] { run(*options); });
}

}  // namespace reident::bench
