// What the screens for sensor faults leave out of a file's telemetry, window by window as the
// daemon would: rows and ranges by kind. On clean telemetry it is the share of false alarms. And
// how many faults they find that are put into this telemetry, one at a time.
//
// Prints one JSON object.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <random>
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

TickSet excluded_by(const std::vector<SensorFault>& faults) {
  std::vector<TickRange> ranges;
  for (const SensorFault& fault : faults) ranges.push_back(fault.ticks);
  return united(std::move(ranges));
}

/// Returns what is excluded of the window.
TickSet screen(const Record& window, const std::vector<std::string>& names, Tally& tally) {
  const auto begin = std::chrono::steady_clock::now();
  const auto faults = sensor_faults(window, std::vector<bool>(names.size(), true));
  const auto taken = std::chrono::steady_clock::now() - begin;
  tally.milliseconds += std::chrono::duration<double, std::milli>(taken).count();
  for (const SensorFault& fault : faults) {
    const std::string kind(name(fault.kind));
    ++tally.by_kind[kind];
    tally.rows_by_kind[kind] += size({fault.ticks});
    ++tally.by_channel[names[static_cast<std::size_t>(fault.channel)] + " " + kind];
  }
  tally.rows += window.rows();
  ++tally.windows;
  if (!faults.empty()) ++tally.windows_with_faults;
  TickSet excluded = excluded_by(faults);
  tally.left_out += size(excluded);
  return excluded;
}

/// Changes a channel's values at rows of its choice, which it returns.
struct InjectedFault {
  const char* name;
  std::function<std::vector<Index>(Eigen::Ref<Vector>, std::mt19937&)> inject;
};

double deviation(const Vector& values) {
  return std::sqrt((values.array() - values.mean()).square().mean());
}

std::vector<Index> rows_from(Index begin, Index count) {
  std::vector<Index> rows;
  for (Index i = 0; i < count; ++i) rows.push_back(begin + i);
  return rows;
}

/// So many rows in a row that lie within the values, at chance.
Index any_place(Index rows, Index count, std::mt19937& random) {
  return std::uniform_int_distribution<Index>(10, rows - count - 10)(random);
}

/// `share` of the rows have this value, each alone.
std::vector<Index> fill_with(double value, double share, Eigen::Ref<Vector> values,
                             std::mt19937& random) {
  std::vector<Index> rows;
  std::bernoulli_distribution is_filled(share);
  for (Index i = 1; i + 1 < values.size(); ++i)
    if (is_filled(random)) rows.push_back(i);
  for (const Index row : rows) values(row) = value;
  return rows;
}

std::vector<Index> spike_of(double deviations, Eigen::Ref<Vector> values, std::mt19937& random) {
  const Index row = any_place(values.size(), 1, random);
  values(row) += (random() % 2 == 0 ? 1 : -1) * deviations * deviation(values);
  return {row};
}

std::vector<Index> stick_for(Index count, Eigen::Ref<Vector> values, std::mt19937& random) {
  const Index begin = any_place(values.size(), count, random);
  values.segment(begin, count).setConstant(values(begin));
  return rows_from(begin, count);
}

std::vector<Index> noise_of(double deviations, Index count, Eigen::Ref<Vector> values,
                            std::mt19937& random) {
  const Index begin = any_place(values.size(), count, random);
  std::normal_distribution<double> noise(0, deviations * deviation(values));
  for (Index i = begin; i < begin + count; ++i) values(i) += noise(random);
  return rows_from(begin, count);
}

const std::vector<InjectedFault>& injected_faults() {
  static const std::vector<InjectedFault> all = {
      {"-999 in 1 % of the rows",
       [](auto values, auto& random) { return fill_with(-999, 0.01, values, random); }},
      {"-999 in 10 % of the rows",
       [](auto values, auto& random) { return fill_with(-999, 0.1, values, random); }},
      {"a row of three deviations",
       [](auto values, auto& random) { return spike_of(3, values, random); }},
      {"a row of ten deviations",
       [](auto values, auto& random) { return spike_of(10, values, random); }},
      {"one value for 100 rows",
       [](auto values, auto& random) { return stick_for(100, values, random); }},
      {"one value for 1000 rows",
       [](auto values, auto& random) { return stick_for(1000, values, random); }},
      {"300 rows with noise of half a deviation",
       [](auto values, auto& random) { return noise_of(0.5, 300, values, random); }},
      {"300 rows with noise of two deviations",
       [](auto values, auto& random) { return noise_of(2, 300, values, random); }}};
  return all;
}

/// What became of faults of one kind. One is found where at least half of its rows are excluded.
struct Injected {
  int faults = 0, found = 0;
  std::int64_t other_rows = 0;  // that are excluded with it, and not without
};

/// `excluded` of the window as it is.
void inject(const Record& window, const TickSet& excluded, const InjectedFault& kind,
            std::mt19937& random, Injected& tally) {
  Record faulty = window;
  const auto channels = static_cast<std::size_t>(window.u.cols() + window.y.cols());
  const auto channel = static_cast<Index>(random() % channels);
  const bool is_input = channel < faulty.u.cols();
  const std::vector<Index> rows =
      is_input ? kind.inject(faulty.u.col(channel), random)
               : kind.inject(faulty.y.col(channel - faulty.u.cols()), random);
  std::vector<TickRange> injected;
  for (const Segment& segment : window.segments)
    for (const Index row : rows)
      if (row >= segment.begin && row < segment.end)
        injected.push_back({segment.first_tick + row - segment.begin,
                            segment.first_tick + row - segment.begin + 1});
  const TickSet own = united(std::move(injected));
  const TickSet found = excluded_by(sensor_faults(faulty, std::vector<bool>(channels, true)));
  std::int64_t hit = 0;
  for (const TickRange& range : own) hit += size(inside(found, range));
  TickSet expected = excluded;
  expected.insert(expected.end(), own.begin(), own.end());
  std::int64_t others = size(found);
  for (const TickRange& range : united(std::move(expected))) others -= size(inside(found, range));
  ++tally.faults;
  if (2 * hit >= size(own)) ++tally.found;
  tally.other_rows += others;
}

int run(const reident::cli::DataRequest& request, int window_rows, int faults) {
  auto read = reident::cli::read_data(request);
  if (const auto* refusal = std::get_if<reident::cli::Refusal>(&read)) {
    fmt::print(stderr, "screening: {}\n", refusal->message);
    return 2;
  }
  const Record& record = std::get<reident::cli::IdentifyData>(read).record;
  std::vector<std::string> names = request.inputs;
  names.insert(names.end(), request.outputs.begin(), request.outputs.end());
  Tally tally;
  std::vector<Injected> injected(injected_faults().size());
  std::mt19937 random(1);
  for (Index begin = 0; begin + window_rows <= record.rows(); begin += window_rows / 4) {
    const RowRange rows{begin, begin + window_rows};
    const Record window{record.period_s, record.u.middleRows(begin, window_rows),
                        record.y.middleRows(begin, window_rows), segments_from(record, rows)};
    const TickSet excluded = screen(window, names, tally);
    for (int i = 0; i < faults; ++i)
      for (std::size_t kind = 0; kind < injected.size(); ++kind)
        inject(window, excluded, injected_faults()[kind], random, injected[kind]);
  }
  ordered_json result = {
      {"windows", tally.windows},
      {"windows_with_faults", tally.windows_with_faults},
      {"rows_left_out_percent", 100.0 * double(tally.left_out) / double(tally.rows)},
      {"stretches", tally.by_kind},
      {"rows", tally.rows_by_kind},
      {"by_channel", tally.by_channel},
      {"milliseconds_a_window", tally.milliseconds / double(tally.windows)}};
  for (std::size_t kind = 0; faults > 0 && kind < injected.size(); ++kind)
    result["injected"][injected_faults()[kind].name] = {
        {"faults", injected[kind].faults},
        {"found", injected[kind].found},
        {"other_rows_percent", 100.0 * double(injected[kind].other_rows) /
                                   double(injected[kind].faults) / double(window_rows)}};
  fmt::print("{}\n", result.dump());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What the screens for sensor faults leave out of a file's telemetry");
  reident::cli::DataRequest request;
  request.screening = false;  // that is what is measured
  int window_rows = 30'000, faults = 0;
  app.add_option("FILE", request.file, "CSV file")->required();
  app.add_option("--input", request.inputs, "Columns of one equipment")->required();
  app.add_option("--output", request.outputs, "The same")->required();
  app.add_option("--time", request.reading.time.column, "Column of the time");
  app.add_option("--period", request.period_s, "Of the grid");
  app.add_option("--window", window_rows, "Rows of a window")->check(CLI::Range(100, 10'000'000));
  app.add_option("--faults", faults, "So many of each kind are put into each window")
      ->check(CLI::Range(0, 1000));
  CLI11_PARSE(app, argc, argv);
  return run(request, window_rows, faults);
}
