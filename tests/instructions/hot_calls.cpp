// Calls that users wait for, one a run, for callgrind: what is counted is the call alone. With a
// name it makes that call; without, it prints the names.
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include <valgrind/callgrind.h>

#include "identification/screening/sensor_screening.hpp"
#include "identification/search/identify.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/statistics/betting.hpp"
#include "service/model/model_json.hpp"
#include "service/windows/window_data.hpp"
#include "storage/archive/archive.hpp"
#include "tests/support/systems.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/version_pairs.hpp"

namespace {

using namespace reident;
using identification::Identified;
using identification::IdentifyOptions;
using identification::Index;
using identification::LagSums;
using identification::Matrix;
using identification::Record;

/// Counts from its beginning to its end.
struct Counted {
  Counted() { CALLGRIND_TOGGLE_COLLECT; }
  ~Counted() { CALLGRIND_TOGGLE_COLLECT; }
};

Record record_of(Index rows) {
  test::Noise noise(1);
  return test::excited(test::random_system(noise, 4, 4, 1), noise, rows, 0.05);
}

IdentifyOptions fixed_options() {
  IdentifyOptions options;
  options.order = 4;
  options.horizon = 20;
  options.weighting = identification::Weighting::moesp;
  options.direct_feedthrough = true;
  options.response_fit = identification::ResponseFit::simulation;
  return options;
}

void one_shot() {
  const Record record = record_of(15'000);
  const Counted counted;
  identify(record, record.all(), fixed_options());
}

void slide() {
  constexpr Index window = 15'000, step = 500;
  const Record record = record_of(window + 2 * step);
  const IdentifyOptions options = fixed_options();
  LagSums kept({5, block_rows_needed(options), step});
  identify(record, {0, window}, options, &kept);
  identify(record, {step, window + step}, options, &kept);
  const Counted counted;
  identify(record, {2 * step, window + 2 * step}, options, &kept);
}

void choice() {
  const Record record = record_of(1'500);
  const Counted counted;
  identify(record, record.all(), {});
}

void free_run() {
  test::Noise noise(1);
  const auto model = test::random_system(noise, 4, 4, 1);
  const Record record = test::excited(model, noise, 20'000, 0.05);
  const Counted counted;
  identification::free_run(model, record, record.all());
}

void screening() {
  const Record record = record_of(10'000);
  const Counted counted;
  sensor_faults(record, std::vector<bool>(5, true));
}

void betting() {
  test::Noise noise(1);
  const identification::Vector scores = 0.3 * noise.normal(200, 1).cwiseMax(-3).cwiseMin(3);
  const Counted counted;
  identification::Bet({scores, 1, 4, 0}).lower_mean(3);
}

void model_codec() {
  EquipmentModel model = test::version_pair(3).before;
  model.validation.mrse_percent = model.validation.fit_percent =
      identification::Vector::Constant(model.dynamics.outputs(), 2);
  const Counted counted;
  model_digest(equipment_model_from_json(to_json(model).dump()));
}

/// An archive of three parameters, a sample a second.
struct Telemetry {
  test::TemporaryFolder folder{"/tmp"};
  storage::Database database{folder / "archive.db", storage::Database::Mode::read_write};
  storage::Archive archive{database};
  std::uint64_t sequence = 0;

  std::vector<storage::TelemetryFrame> next(int count) {
    std::vector<storage::TelemetryFrame> frames;
    for (int i = 0; i < count; ++i) {
      storage::TelemetryFrame frame;
      frame.spacecraft = "SAT";
      frame.source = "station";
      frame.sequence = ++sequence;
      frame.generation_time = frame.reception_time =
          static_cast<storage::Time>(sequence) * 1'000'000'000;
      for (std::uint32_t id = 1; id <= 3; ++id)
        frame.samples.push_back({.parameter = id,
                                 .quality = storage::Quality::good,
                                 .value = static_cast<double>(sequence * id % 997) / 8});
      frames.push_back(std::move(frame));
    }
    return frames;
  }

  void describe() {
    std::vector<storage::ParameterDescriptor> descriptors;
    for (const std::uint32_t id : {1u, 2u, 3u}) {
      storage::ParameterDescriptor descriptor;
      descriptor.spacecraft = "SAT";
      descriptor.id = id;
      descriptor.name = "P" + std::to_string(id);
      descriptors.push_back(descriptor);
    }
    archive.describe(descriptors);
  }
};

void append() {
  Telemetry telemetry;
  telemetry.archive.append(telemetry.next(5'000));
  const auto frames = telemetry.next(2'000);
  const Counted counted;
  telemetry.archive.append(frames);
}

void window_read() {
  Telemetry telemetry;
  telemetry.describe();
  for (int i = 0; i < 10; ++i) telemetry.archive.append(telemetry.next(2'000));
  telemetry.archive.compact();
  WindowRequest request;
  request.spacecraft = "SAT";
  request.inputs = {"P1", "P2"};
  request.outputs = {"P3"};
  request.period = request.sample_hold = 1'000'000'000;
  const Counted counted;
  load_window(telemetry.archive, request, {1'000'000'000, 20'000'000'000'000});
}

const std::map<std::string, std::function<void()>> calls = {
    {"append", append},           {"betting", betting},
    {"choice", choice},           {"free_run", free_run},
    {"model_codec", model_codec}, {"one_shot", one_shot},
    {"screening", screening},     {"slide", slide},
    {"window_read", window_read}};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    for (const auto& [name, call] : calls) std::printf("%s\n", name.c_str());
    return 0;
  }
  const auto found = calls.find(argv[1]);
  if (found == calls.end()) return 2;
  found->second();
}
