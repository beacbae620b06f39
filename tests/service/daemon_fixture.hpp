// A database in a folder of its own, and telemetry of a plant whose truth is known.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "service/config/config.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::test {

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t minute = 60 * second;
/// A multiple of every slide below.
constexpr storage::Time day = 19'000LL * 86'400 * second;

class DaemonTest : public testing::Test {
 protected:
  std::filesystem::path path() const { return folder_ / "reident.db"; }
  storage::Database open() const { return {path(), storage::Database::Mode::read_write}; }

  /// Makes what is in chunks of a parameter undecodable.
  void damage_chunks(std::uint32_t parameter) const {
    const std::string of_parameter =
        "SELECT data FROM chunk JOIN series ON series.id = chunk.series WHERE parameter = " +
        std::to_string(parameter);
    EXPECT_GT(run_sql("UPDATE chunk_data SET bytes = zeroblob(length(bytes)) WHERE id IN (" +
                      of_parameter + ")"),
              0);
  }

  /// Behind the back of the programs. How many rows it changed.
  int run_sql(const std::string& sql) const {
    sqlite3* handle = nullptr;
    EXPECT_EQ(sqlite3_open(path().c_str(), &handle), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(handle);
    const int changes = sqlite3_changes(handle);
    sqlite3_close(handle);
    return changes;
  }

  /// Inputs u (1) and v (2), output y (3).
  static std::vector<storage::ParameterDescriptor> descriptors() {
    std::vector<storage::ParameterDescriptor> result;
    for (const char* name : {"u", "v", "y"}) {
      storage::ParameterDescriptor one;
      one.spacecraft = "SAT";
      one.id = static_cast<std::uint32_t>(result.size() + 1);
      one.name = name;
      one.unit = "V";
      result.push_back(one);
    }
    return result;
  }

  /// One frame a second from `begin` on. The plant is of first order: its output follows
  /// gain * (u + v / 2) and two slow oscillations excite it.
  static std::vector<storage::TelemetryFrame> telemetry(storage::Time begin, int seconds,
                                                        double gain = 1, double noise = 0.01) {
    std::vector<storage::TelemetryFrame> frames;
    double state = 0;
    std::uint64_t random = 88172645463325252;
    for (int k = 0; k < seconds; ++k) {
      const double u = k / 40 % 3 - 1.0;
      const double v = std::sin(k * 0.07);
      random ^= random << 13, random ^= random >> 7, random ^= random << 17;
      const double disturbance = noise * (static_cast<double>(random >> 11) * 0x1p-52 - 1);
      storage::TelemetryFrame frame;
      frame.spacecraft = "SAT";
      frame.source = "station";
      frame.sequence = static_cast<std::uint64_t>((begin - day) / second + k);
      frame.generation_time = begin + k * second;
      frame.reception_time = frame.generation_time;
      const auto good = storage::Quality::good;
      frame.samples = {{1, good, u}, {2, good, v}, {3, good, 10 + state + disturbance}};
      frames.push_back(std::move(frame));
      state = 0.9 * state + 0.1 * gain * (u + v / 2);
    }
    return frames;
  }

  struct Operation {
    double u = 1, v = 1;  // of how the inputs else move
    double gain = 1;
    double offset = 0;
    double noise = 0.001;
    storage::Time since = INT64_MIN;  // from when on the inputs move so
  };
  /// Telemetry of the plant operated otherwise.
  static std::vector<storage::TelemetryFrame> operation(storage::Time begin, int seconds,
                                                        const Operation& now) {
    auto frames = telemetry(begin, seconds, 0, now.noise);
    double state = 0;
    for (auto& frame : frames) {
      if (frame.generation_time >= now.since) {
        frame.samples[0].value *= now.u;
        frame.samples[1].value *= now.v;
      }
      frame.samples[2].value += now.offset + state;
      state = 0.9 * state + 0.1 * now.gain * (frame.samples[0].value + frame.samples[1].value / 2);
    }
    return frames;
  }

  /// Windows of 10 minutes that slide by 5.
  static EquipmentConfig plant() {
    EquipmentConfig equipment;
    equipment.name = "PLANT";
    equipment.inputs = {"u", "v"};
    equipment.outputs = {"y"};
    equipment.sample_period = second;
    equipment.sample_hold = 3 * second;
    equipment.window = 10 * minute;
    equipment.slide = 5 * minute;
    equipment.cycle = minute;
    return equipment;
  }

  static Config config() {
    Config result;
    result.max_clock_lead = 60 * minute;
    result.settle = second;
    result.spacecraft = {{"SAT", {plant()}}};
    return result;
  }

 private:
  const TemporaryFolder folder_;
};

}  // namespace reident::test
