// `identify` and, through the archive, the service get the same rows from the same file.
#include "service/cli/identify_data.hpp"

#include <fstream>
#include <functional>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "service/windows/ticks.hpp"
#include "service/windows/window_data.hpp"
#include "storage/archive/archive.hpp"
#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::identify_data_test {
namespace {

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t begin_s = 1'709'157'600;  // 2024-02-28T22:00:00Z
constexpr int rows = 120;

/// A row each 10 s, u changes in every fourth; the texts have three decimals.
struct Row {
  std::string date, ordinal, u, y;
  std::int64_t ms = 0;
  bool changes = false;
};

std::vector<Row> telemetry() {
  std::mt19937 random(34);
  std::normal_distribution<double> normal;
  std::vector<Row> made;
  for (int i = 0; i < rows; ++i) {
    const std::string clock = fmt::format("22:{:02}:{:02}", i / 6, i % 6 * 10);
    Row row{"2024-02-28T" + clock,
            "2024:059:" + clock,
            {},
            fmt::format("{:.3f}", 28 + normal(random)),
            (begin_s + 10 * i) * 1000,
            i % 4 == 0};
    row.u = row.changes ? fmt::format("{:.3f}", 3 + normal(random)) : made.back().u;
    made.push_back(row);
  }
  return made;
}

/// Seconds since 1970, so many ms behind the row.
std::string later(const Row& row, std::int64_t ms) {
  return fmt::format("{:.3f}", double(row.ms + ms) / 1000);
}

std::string with_commas(std::string text) {
  std::replace(text.begin(), text.end(), '.', ',');
  return text;
}

struct Dress {
  const char* name;
  const char* header;
  std::string (*line)(const Row& row);
  std::int64_t hold_s = 30;
  bool has_phase = false;
};

class IdentifyRows : public test::CliTest {
 protected:
  IdentifyData of_file(const Dress& dress, const std::string& file, const std::string& time) const {
    DataRequest request;
    request.file = folder() / file;
    request.inputs = {"u"};
    request.outputs = {"y"};
    request.reading.time.column = time;
    request.period_s = 10;
    request.hold_ns = dress.hold_s * second;
    request.screening = false;
    request.reading.clock_may_go_back = true;
    auto read = read_data(request);
    if (const auto* refusal = std::get_if<Refusal>(&read))
      throw std::runtime_error(refusal->message);
    return std::get<IdentifyData>(std::move(read));
  }
  /// A window that begins and ends with the file, on the ticks that a service has.
  static WindowData of_archive(const Dress& dress, const std::filesystem::path& file,
                               const identification::Record& here) {
    storage::Database database(file, storage::Database::Mode::read_write);
    const storage::Archive archive(database);
    EquipmentConfig equipment;
    equipment.inputs = {"u"};
    equipment.outputs = {"y"};
    equipment.sample_period = 10 * second;
    equipment.sample_hold = dress.hold_s * second;
    equipment.window = 3600 * second;
    equipment = with_phase(equipment, "SAT-1", archive, storage::Registry(database));
    const auto& last = here.segments.back();
    auto loaded = load_window(archive, request_of("SAT-1", equipment),
                              {here.segments.front().first_tick * 10 * second,
                               (last.first_tick + last.size()) * 10 * second});
    return std::get<WindowData>(std::move(loaded));
  }
};

TEST_F(IdentifyRows, AreThoseOfTheServiceInEachDress) {
  const Dress dresses[] = {
      {"plain", "time,u,y\n", [](const Row& r) { return r.date + "Z," + r.u + "," + r.y + "\n"; }},
      {"european", "Export\n\ntime;u;y\n;A;V\n",
       [](const Row& r) {
         return "28.02.2024 " + r.date.substr(11) + ";" + with_commas(r.u) + ";" +
                with_commas(r.y) + "\r\n";
       }},
      {"days", "time\tu\ty\n",
       [](const Row& r) { return r.ordinal + "\t" + r.u + "\t" + r.y + "\n"; }},
      {"epoch", "time_ms,u,y\n",
       [](const Row& r) { return fmt::format("{},{},{}\n", r.ms, r.u, r.y); }},
      {"packets", "time,u,y\n",
       [](const Row& r) {
         return r.date + ".000Z," + r.u + ",\n" + r.date + ".180Z,," + r.y + "\n";
       },
       30, true},
      {"late_sensor", "time,u,y\n",
       [](const Row& r) {
         return r.date + "Z," + r.u + ",\n" + later(r, 2500) + ",," + r.y + "\n";
       },
       30, true},
      {"packets_that_jitter", "time,u,y\n",
       [](const Row& r) {
         const std::int64_t jitter = r.ms / 10'000 % 5 * 40 - 80;
         return later(r, jitter) + "," + r.u + ",\n" + later(r, 400 + jitter) + ",," + r.y + "\n";
       },
       30, true},
      {"on_change", "time,u,y\n",
       [](const Row& r) { return r.date + "Z," + (r.changes ? r.u : "") + "," + r.y + "\n"; }, 40},
      {"samples", "time,name,value\n",
       [](const Row& r) { return r.date + "Z,u," + r.u + "\n" + r.date + "Z,y," + r.y + "\n"; }},
      {"jitter", "time,u,y\n",
       [](const Row& r) {
         return fmt::format("{},{},{}\n", double(r.ms + r.ms / 10'000 % 7 * 10) / 1000, r.u, r.y);
       },
       30, true},
  };
  const auto table = telemetry();
  for (const Dress& dress : dresses) {
    const std::string file = dress.name + std::string(".csv"),
                      archive = dress.name + std::string(".db");
    std::string text = dress.header;
    for (const Row& row : table) text += dress.line(row);
    write(file, text);
    const test::Ran ran = reident({"import", file, "--db", archive, "--spacecraft", "SAT-1"});
    ASSERT_EQ(ran.status, 0) << dress.name << ran.err;
    const std::string header = dress.header;
    const auto data = of_file(dress, file, header.find("time_ms") == 0 ? "time_ms" : "time");
    EXPECT_EQ(data.phase_ns != 0, dress.has_phase) << dress.name;
    const auto& here = data.record;
    const auto there = of_archive(dress, folder() / archive, here).record;
    EXPECT_GE(here.rows(), rows - 2) << dress.name;
    EXPECT_EQ(here.segments, there.segments) << dress.name;
    EXPECT_EQ(here.u, there.u) << dress.name;
    EXPECT_EQ(here.y, there.y) << dress.name;
  }
}

TEST_F(IdentifyRows, ThatCameLateAreInTheirPlace) {
  std::vector<std::string> lines;
  const auto table = telemetry();
  for (std::size_t i = 0; i < table.size(); ++i)
    lines.push_back(fmt::format("{},{},{}\n", 10 * i, table[i].u, table[i].y));
  write("ordered.csv", fmt::format("t,u,y\n{}", fmt::join(lines, "")));
  std::swap(lines[40], lines[41]);
  std::swap(lines[60], lines[63]);
  write("late.csv", fmt::format("t,u,y\n{}", fmt::join(lines, "")));
  const IdentifyData ordered = of_file({}, "ordered.csv", "t"), late = of_file({}, "late.csv", "t");
  EXPECT_EQ(late.record.segments, ordered.record.segments);
  EXPECT_EQ(late.record.u, ordered.record.u);
  EXPECT_EQ(late.record.y, ordered.record.y);
}

/// Ticks with a value for all columns, where y is written in some of 400 rows; by default.
identification::Index complete_ticks(const std::filesystem::path& folder,
                                     const std::function<std::optional<double>(int)>& y) {
  std::string text = "time,u,y\n";
  for (int i = 0; i < 400; ++i) {
    const auto value = y(i);
    text += fmt::format("{},{},{}\n", i, i / 20 % 3, value ? fmt::format("{:.6g}", *value) : "");
  }
  std::ofstream(folder / "silent.csv") << text;
  DataRequest request;
  request.file = folder / "silent.csv";
  request.inputs = {"u"};
  request.outputs = {"y"};
  request.reading.time.column = "time";
  request.screening = false;
  return std::get<IdentifyData>(read_data(request)).record.rows();
}

TEST_F(IdentifyRows, AreLeftOutWhereAColumnOfEveryTickIsSilent) {
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  int written = 0;
  const auto missing = [&](int i) -> std::optional<double> {
    if (i % 7 == 3 || i % 11 == 5) return std::nullopt;
    ++written;
    return 20 + normal(random);
  };
  EXPECT_EQ(complete_ticks(folder(), missing), written);
}

TEST_F(IdentifyRows, KeepWhatAColumnSaidWhereItComesWhenItChanges) {
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  double truth = 20, sent = 0;
  const auto beyond_a_dead_band = [&](int) -> std::optional<double> {
    truth += normal(random);
    if (std::abs(truth - sent) < 0.4) return std::nullopt;
    return sent = truth;
  };
  EXPECT_GT(complete_ticks(folder(), beyond_a_dead_band), 380);  // a value serves three ticks
}

TEST_F(IdentifyRows, KeepWhatAColumnSaidWhereItsQuantumComesWhenItChanges) {
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  double sent = 0;
  const auto another_value = [&](int) -> std::optional<double> {
    const double value = std::round(20 + 7 * normal(random));
    if (value == sent) return std::nullopt;
    return sent = value;
  };
  EXPECT_EQ(complete_ticks(folder(), another_value), 400);
}

}  // namespace
}  // namespace reident::cli::identify_data_test
