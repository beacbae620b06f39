// What the screens for sensor faults leave out of a file's telemetry, window by window as the
// daemon would: rows and ranges by kind. On clean telemetry it is the share of false alarms.
//
// Prints one JSON object.

#include <chrono>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "identification/samples/tick_ranges.hpp"
#include "identification/screening/sensor_screening.hpp"
#include "service/cli/identify_data.hpp"

namespace {

using namespace reident::identification;
using nlohmann::ordered_json;

struct Tally {
  Index rows = 0, windows = 0, windows_with_faults = 0;
  std::int64_t left_out = 0;
  double milliseconds = 0;
  std::map<std::string, int> by_kind, by_channel;
  std::map<std::string, std::int64_t> rows_by_kind;
};

void screen(const Record& window, const std::vector<std::string>& names, Tally& tally) {
  const auto begin = std::chrono::steady_clock::now();
  const auto faults = sensor_faults(window, std::vector<bool>(names.size(), true));
  const auto taken = std::chrono::steady_clock::now() - begin;
  tally.milliseconds += std::chrono::duration<double, std::milli>(taken).count();
  std::vector<TickRange> ranges;
  for (const SensorFault& fault : faults) {
    ranges.push_back(fault.ticks);
    const std::string kind(name(fault.kind));
    ++tally.by_kind[kind];
    tally.rows_by_kind[kind] += size({fault.ticks});
    ++tally.by_channel[names[static_cast<std::size_t>(fault.channel)] + " " + kind];
  }
  tally.rows += window.rows();
  ++tally.windows;
  if (!faults.empty()) ++tally.windows_with_faults;
  tally.left_out += size(united(std::move(ranges)));
}

int run(const reident::cli::DataRequest& request, int window_rows) {
  auto read = reident::cli::read_data(request);
  if (const auto* refusal = std::get_if<reident::cli::Refusal>(&read)) {
    fmt::print(stderr, "screening: {}\n", refusal->message);
    return 2;
  }
  const Record& record = std::get<reident::cli::IdentifyData>(read).record;
  std::vector<std::string> names = request.inputs;
  names.insert(names.end(), request.outputs.begin(), request.outputs.end());
  Tally tally;
  for (Index begin = 0; begin + window_rows <= record.rows(); begin += window_rows / 4) {
    const RowRange rows{begin, begin + window_rows};
    screen({record.period_s, record.u.middleRows(begin, window_rows),
            record.y.middleRows(begin, window_rows), segments_from(record, rows)},
           names, tally);
  }
  const ordered_json result = {
      {"windows", tally.windows},
      {"windows_with_faults", tally.windows_with_faults},
      {"rows_left_out_percent", 100.0 * double(tally.left_out) / double(tally.rows)},
      {"stretches", tally.by_kind},
      {"rows", tally.rows_by_kind},
      {"by_channel", tally.by_channel},
      {"milliseconds_a_window", tally.milliseconds / double(tally.windows)}};
  fmt::print("{}\n", result.dump());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What the screens for sensor faults leave out of a file's telemetry");
  reident::cli::DataRequest request;
  request.screening = false;  // that is what is measured
  int window_rows = 30'000;
  app.add_option("FILE", request.file, "CSV file")->required();
  app.add_option("--input", request.inputs, "Columns of one equipment")->required();
  app.add_option("--output", request.outputs, "The same")->required();
  app.add_option("--time", request.reading.time.column, "Column of the time");
  app.add_option("--period", request.period_s, "Of the grid");
  app.add_option("--window", window_rows, "Rows of a window")->check(CLI::Range(100, 10'000'000));
  CLI11_PARSE(app, argc, argv);
  return run(request, window_rows);
}
