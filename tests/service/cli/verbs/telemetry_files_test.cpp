// Files as people have them, by import and identify alike.
#include <random>

#include <fmt/format.h>

#include "storage/archive/archive.hpp"
#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::telemetry_files_test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A first-order plant, a row each 10 s from 2024-02-28T22:00:00Z on.
struct Plant {
  std::vector<double> u, y;
};

Plant plant(std::size_t rows) {
  std::mt19937 random(34);
  std::normal_distribution<double> normal;
  Plant made;
  double x = 0, u = 3;
  for (std::size_t row = 0; row < rows; ++row) {
    if (row % 4 == 0) u = 3 + normal(random);
    made.u.push_back(std::round(u * 1000) / 1000);
    made.y.push_back(std::round((28 + x + 0.001 * normal(random)) * 1000) / 1000);
    x = 0.9 * x - 0.1 * (u - 3);
  }
  return made;
}

std::string iso(std::size_t row) {
  const std::size_t s = 79'200 + 10 * row;
  return fmt::format("2024-02-{:02}T{:02}:{:02}:{:02}Z", 28 + s / 86'400, s / 3600 % 24,
                     s / 60 % 60, s % 60);
}

class TelemetryFiles : public test::CliTest {
 protected:
  std::vector<std::string> identify(const std::string& file,
                                    std::vector<std::string> more = {}) const {
    std::vector<std::string> words = {"identify", file,       "--time", "time",    "--input",
                                      "u",        "--output", "y",      "--order", "1"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static std::vector<std::string> import_of(const std::string& file,
                                            std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"import", file, "--db", "a.db", "--spacecraft", "SAT-1"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// The only pole, as it is printed.
  double pole(const std::vector<std::string>& words) const {
    const json model = json_of(words);
    return model.contains("A") ? model["A"][0][0].get<double>() : 0;
  }
  const Plant data_ = plant(240);
  std::string plain() const {
    std::string text = "time,u,y\n";
    for (std::size_t row = 0; row < data_.u.size(); ++row)
      text += fmt::format("{},{:.3f},{:.3f}\n", iso(row), data_.u[row], data_.y[row]);
    return text;
  }
};

TEST_F(TelemetryFiles, GiveTheSameModelInEachDress) {
  write("plain.csv", plain());
  const double expected = pole(identify("plain.csv"));
  EXPECT_NEAR(expected, 0.9, 0.01);
  std::string european = "Export: EPS\n\ntime;u;y\n;A;V\n", days = "time\tu\ty\n",
              grouped = "time,u,y\n", packets = "time,u,y\n";
  for (std::size_t row = 0; row < data_.u.size(); ++row) {
    std::string numbers = fmt::format(";{:.3f};{:.3f}\r\n", data_.u[row], data_.y[row]);
    std::replace(numbers.begin(), numbers.end(), '.', ',');
    const std::string time = iso(row);
    european += time.substr(8, 2) + ".02.2024 " + time.substr(11, 8) + numbers;
    days += fmt::format("2024:{:03}:{}\t{:.3f}\t{:.3f}\n", 31 + std::stoi(time.substr(8, 2)),
                        time.substr(11, 8), data_.u[row], data_.y[row]);
    grouped += fmt::format("{},{}{:.3f} A,{:.3f} V\n", time, data_.u[row] < 0 ? "\xE2\x88\x92" : "",
                           std::abs(data_.u[row]), data_.y[row]);
    packets += fmt::format("{},{:.3f},\n{}.180Z,,{:.3f}\n", time, data_.u[row], time.substr(0, 19),
                           data_.y[row]);
  }
  for (const auto& [name, text] : {std::pair("european.csv", european),
                                   {"days.csv", days},
                                   {"grouped.csv", grouped},
                                   {"packets.csv", packets}}) {
    write(name, text);
    EXPECT_EQ(pole(identify(name, {"--period", "10"})), expected) << name;
  }
  EXPECT_THAT(json_of(identify("european.csv"))["found"],
              "semicolons, header in line 3, units in line 4, decimal commas, UTF-8, time: dates");
}

TEST_F(TelemetryFiles, OfValuesOnChangeNeedAHoldThatIsNamed) {
  std::string sparse = "time,u,y\n";
  for (std::size_t row = 0; row < data_.u.size(); ++row)
    sparse += fmt::format("{},{},{:.3f}\n", iso(row),
                          row % 4 == 0 ? fmt::format("{:.3f}", data_.u[row]) : "", data_.y[row]);
  write("plain.csv", plain());
  write("sparse.csv", sparse);
  EXPECT_THAT(refusal_of(identify("sparse.csv", {"--period", "10"})),
              AllOf(HasSubstr("u, whose usual step is 40s"), HasSubstr("--hold 40s")));
  EXPECT_EQ(pole(identify("sparse.csv", {"--period", "10", "--hold", "40s"})),
            pole(identify("plain.csv")));
  EXPECT_EQ(json_of(identify("sparse.csv"))["sample_period_s"], 40) << "that of the slowest";
}

TEST_F(TelemetryFiles, WithCellsThatAreNoNumbersAreRefusedOrSaid) {
  std::string text = plain();
  const auto spoil = [&](std::size_t row, const std::string& word) {
    const auto at = text.find(iso(row)) + 21;
    text.replace(at, text.find(',', at) - at, word);
  };
  spoil(7, "OVR");
  write("one.csv", text);
  EXPECT_THAT(json_of(identify("one.csv"))["warnings"],
              Contains(HasSubstr("1 of 240 cells are neither numbers nor blank: 'OVR' in line 9")));
  for (std::size_t row = 20; row < 30; ++row) spoil(row, "OVR");
  write("many.csv", text);
  EXPECT_THAT(refusal_of(identify("many.csv")),
              AllOf(HasSubstr("11 of 240 cells"),
                    HasSubstr("'OVR' in line 9, 'OVR' in line 22, 'OVR' in line 23"),
                    HasSubstr("--missing")));
  EXPECT_EQ(reident(identify("many.csv", {"--missing", "OVR"})).status, 0);
  EXPECT_THAT(json_of(identify("many.csv", {"--skip-bad-lines"}))["warnings"],
              Contains(HasSubstr("11 rows left out for no number, the first: many.csv:9:")));
}

TEST_F(TelemetryFiles, OfOneSampleARowGiveTheModelOfTheTable) {
  write("plain.csv", plain());
  const double expected = pole(identify("plain.csv"));
  std::string turns = "Timestamp,Mnemonic,Value\n", series = "time;name;value\n", ys;
  for (std::size_t row = 0; row < data_.u.size(); ++row) {
    turns += fmt::format("{0},u,{1:.3f}\n{0},y,{2:.3f}\n", iso(row), data_.u[row], data_.y[row]);
    std::string u = fmt::format("{};u;{:.3f}\n", iso(row), data_.u[row]),
                y = fmt::format("{};y;{:.3f}\n", iso(row), data_.y[row]);
    for (char& c : u) c = c == '.' ? ',' : c;
    for (char& c : y) c = c == '.' ? ',' : c;
    series += u;
    ys += y;
  }
  write("turns.csv", turns);
  write("series.csv", series + ys);
  EXPECT_EQ(pole({"identify", "turns.csv", "--time", "Timestamp", "--input", "u", "--output", "y",
                  "--order", "1"}),
            expected);
  EXPECT_EQ(pole(identify("series.csv")), expected);
  EXPECT_THAT(json_of(identify("series.csv"))["found"], HasSubstr("one sample a row"));
  const json imported = json_of(import_of("series.csv"));
  EXPECT_EQ(imported["stored"], 480);
  EXPECT_EQ(imported["new_parameters"], 2);
  const test::Ran undone = reident({"import", "series.csv", "--db", "a.db", "--undo"});
  EXPECT_EQ(undone.out, "480 samples of 2 parameters removed; the file can be imported again\n");
}

TEST_F(TelemetryFiles, OfOneSampleARowTakeTheUnitOfElapsedTimesOnce) {
  std::string text = "time_ms,parameter,value\n";
  for (std::size_t row = 0; row < data_.u.size(); ++row)
    text += fmt::format("{0},u,{1:.3f}\n{0},y,{2:.3f}\n", 10'000 * row, data_.u[row], data_.y[row]);
  write("elapsed.csv", text);
  const json model = json_of({"identify", "elapsed.csv", "--time", "time_ms", "--input", "u",
                              "--output", "y", "--order", "1"});
  EXPECT_EQ(model["sample_period_s"], 10.0);
}

TEST_F(TelemetryFiles, WhoseTimesJitterOrAreRoundedGiveTheModelOfTheGrid) {
  write("plain.csv", plain());
  const double expected = pole(identify("plain.csv"));
  std::string jitter = "time,u,y\n", rounded = "t,u,y\n";
  std::mt19937 random(9);
  std::uniform_int_distribution<int> late_ms(-40, 40);
  for (std::size_t row = 0; row < data_.u.size(); ++row) {
    const double t = 1'709'157'600.0 + 10 * double(row) + late_ms(random) / 1000.0;
    jitter += fmt::format("{:.3f},{:.3f},{:.3f}\n", t, data_.u[row], data_.y[row]);
    rounded += fmt::format("{:.3f},{:.3f},{:.3f}\n", double(row) / 30, data_.u[row], data_.y[row]);
  }
  write("jitter.csv", jitter);
  write("rounded.csv", rounded);
  EXPECT_EQ(pole(identify("jitter.csv", {"--period", "10"})), expected);
  EXPECT_NE(pole(identify("jitter.csv", {"--period", "10", "--phase", "0"})), expected);
  const json thirty = json_of(
      {"identify", "rounded.csv", "--time", "t", "--input", "u", "--output", "y", "--order", "1"});
  EXPECT_EQ(thirty["A"][0][0], expected);
  EXPECT_NEAR(thirty["sample_period_s"].get<double>(), 1.0 / 30, 1e-5);
}

TEST_F(TelemetryFiles, OfSeveralRecordsFitAStateToEach) {
  // The second record begins at a state that has nothing to do with the end of the first one.
  const std::size_t half = data_.u.size() / 2;
  std::string apart = "run,t,u,y\n", mixed = "run,t,u,y\n";
  std::vector<std::string> first, second;
  for (std::size_t row = 0; row < half; ++row) {
    first.push_back(fmt::format("A,{},{:.3f},{:.3f}\n", 10 * row, data_.u[row], data_.y[row]));
    second.push_back(
        fmt::format("B,{},{:.3f},{:.3f}\n", 10 * row, data_.u[half + row], data_.y[half + row]));
  }
  for (const auto& line : first) apart += line;
  for (const auto& line : second) apart += line;
  for (std::size_t row = 0; row < half; ++row) mixed += first[row] + second[row];
  write("apart.csv", apart);
  write("mixed.csv", mixed);
  const auto words = [&](const char* file) {
    return std::vector<std::string>{"identify",  file,       "--time",     "t",       "--input",
                                    "u",         "--output", "y",          "--order", "1",
                                    "--segment", "run",      "--validate", "180:240"};
  };
  const json model = json_of(words("apart.csv"));
  EXPECT_NEAR(model["A"][0][0].get<double>(), 0.9, 0.01);
  EXPECT_THAT(model["warnings"], Contains(HasSubstr("2 stretches")));
  EXPECT_EQ(json_of(words("mixed.csv"))["A"], model["A"]);
  auto shown = words("mixed.csv");
  shown.push_back("--dry-run");
  EXPECT_EQ(reident(shown).status, 0);
  auto without_time = words("apart.csv");
  without_time.erase(without_time.begin() + 2, without_time.begin() + 4);
  EXPECT_EQ(json_of(without_time)["A"], model["A"]);
  EXPECT_THAT(
      refusal_of({"identify", "apart.csv", "--input", "u", "--output", "y", "--segment", "test"}),
      HasSubstr("--segment: apart.csv: there is no column 'test'"));
}

TEST_F(TelemetryFiles, OfOneSampleARowSayWhatIsWrongWithTheirLines) {
  std::string good = "time,name,value\n", bad = good;
  for (std::size_t row = 0; row < data_.u.size(); ++row) {
    const std::string u = fmt::format("{},u,{:.3f}\n", iso(row), data_.u[row]),
                      y = fmt::format("{},y,{:.3f}\n", iso(row), data_.y[row]);
    good += u + y;
    bad += u + y;
    if (row == 3) bad += "no time,u,1\n" + iso(row) + ",,1\n";       // lines 10 and 11
    if (row == 4) bad += iso(row) + ",u,99\ntime,name,value\n" + u;  // lines 14, 15 and 16
  }
  write("good.csv", good);
  write("bad.csv", bad);
  EXPECT_EQ(reident(import_of("good.csv", {"--dry-run"})).status, 0);
  EXPECT_THAT(refusal_of(identify("bad.csv")), HasSubstr("bad.csv:10: "));
  // Two rows more before the end of the range: one for each sample that came twice.
  const json model = json_of(identify("bad.csv", {"--skip-bad-lines", "--identify", "0:162"}));
  EXPECT_EQ(model["A"], json_of(identify("good.csv", {"--identify", "0:160"}))["A"]);
  EXPECT_THAT(model["warnings"],
              AllOf(Contains(HasSubstr("bad.csv:10: 'no time'")),
                    Contains(HasSubstr("bad.csv:11: '' in column 'name'")),
                    Contains(HasSubstr("bad.csv:15: the header stands here again")),
                    Contains(HasSubstr("column u: other values at the time of an earlier one: 1, "
                                       "the first in line 14"))));
  const test::Ran imported = reident(import_of("bad.csv", {"--skip-bad-lines"}));
  EXPECT_THAT(imported.out, HasSubstr("480 stored, 1 there already, 1 in conflict"));
  write("words.csv", good + iso(240) + ",y,3\n" + iso(240) + ",u,broken\n");
  EXPECT_THAT(json_of(identify("words.csv"))["warnings"],
              Contains(HasSubstr("column u: 1 of 241 cells are neither numbers nor blank: 'broken' "
                                 "in line 483")));
}

TEST_F(TelemetryFiles, OfOneSampleARowHaveStatesThatAreNamedByTheirParameter) {
  write("s.csv", "time,name,value\n" + iso(0) + ",heater,ON\n" + iso(0) + ",u,1\n" + iso(1) +
                     ",heater,OFF\n");
  EXPECT_THAT(refusal_of(import_of("s.csv")), HasSubstr("--map-states PARAMETER:STATE=NUMBER"));
  EXPECT_EQ(json_of(import_of("s.csv", {"--map-states", "heater:OFF=0,ON=1"}))["stored"], 3);
  storage::Database database(folder() / "a.db", storage::Database::Mode::read_write);
  const auto heater = storage::Archive(database).parameter("SAT-1", "heater");
  ASSERT_TRUE(heater);
  EXPECT_EQ(heater->kind, storage::ParameterKind::digital);
  EXPECT_EQ(heater->description, "states OFF=0, ON=1; imported from s.csv");
}

TEST_F(TelemetryFiles, OfAClockThatWasSetBackGoOnOrStop) {
  std::string text = "time,u,y\n";
  for (std::size_t row = 0; row < data_.u.size(); ++row) {
    const std::size_t s = 9'900 + 10 * row;  // 02:45
    const std::size_t shown = s >= 10'800 ? s - 3600 : s;
    text += fmt::format("2024-10-27 {:02}:{:02}:{:02},{:.3f},{:.3f}\n", shown / 3600,
                        shown / 60 % 60, shown % 60, data_.u[row], data_.y[row]);
  }
  write("local.csv", text);
  write("plain.csv", plain());
  const double expected = pole(identify("plain.csv"));
  EXPECT_EQ(pole(identify("local.csv", {"--period", "10"})), expected);
  EXPECT_EQ(pole(identify("local.csv", {"--period", "10", "--time-zone", "Europe/Berlin"})),
            expected);
  EXPECT_THAT(json_of(identify("local.csv"))["warnings"],
              Contains(AllOf(HasSubstr("local.csv:92: "), HasSubstr("daylight saving"))));
  EXPECT_THAT(refusal_of(identify("local.csv", {"--clock-back", "stop"})),
              HasSubstr("local.csv:92: "));
  EXPECT_THAT(refusal_of(import_of("local.csv")),
              AllOf(HasSubstr("local.csv:92: "), HasSubstr("--time-zone")));
  const test::Ran undone = reident({"import", "local.csv", "--db", "a.db", "--undo"});
  EXPECT_EQ(undone.out, "180 samples of 2 parameters removed; the file can be imported again\n");
  EXPECT_EQ(json_of(import_of("local.csv", {"--time-zone", "Europe/Berlin"}))["stored"], 480);
  storage::Database writable(folder() / "a.db", storage::Database::Mode::read_write);
  const auto extent = storage::Archive(writable).extent("SAT-1", storage::Origin::real);
  EXPECT_EQ(extent->begin, 1'729'989'900'000'000'000) << "2024-10-27T00:45:00Z";
  EXPECT_EQ(extent->end, extent->begin + 2'390'000'000'000 + 1);
}

TEST_F(TelemetryFiles, OfStatesBecomeNumbersByAMappingThatIsKept) {
  write("s.csv",
        "time,heater,mode\n2024-02-28T22:00:00Z,ON,SUN\n2024-02-28T22:00:10Z,OFF,ECLIPSE\n");
  const test::Ran ran = reident(import_of("s.csv"));
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.err,
              AllOf(HasSubstr("heater: OFF=0, ON=1"), HasSubstr("column 'mode' is left out"),
                    HasSubstr("--map-states mode:")));
  EXPECT_EQ(json_of(import_of("s.csv", {"--map-states", "mode:ECLIPSE=0,SUN=1"}))["stored"], 2);
  storage::Database database(folder() / "a.db", storage::Database::Mode::read_write);
  const auto heater = storage::Archive(database).parameter("SAT-1", "heater");
  ASSERT_TRUE(heater);
  EXPECT_EQ(heater->kind, storage::ParameterKind::digital);
  EXPECT_EQ(heater->description, "states OFF=0, ON=1; column heater of s.csv");
}

TEST_F(TelemetryFiles, WithTimesThatCannotBeAreNotStored) {
  write("tow.csv", "tow_ms,u\n338418.0,1\n338428.0,2\n");
  EXPECT_THAT(refusal_of(import_of("tow.csv")),
              AllOf(HasSubstr("tow.csv:2: '338418.0' in column 'tow_ms'"), HasSubstr("before 1990"),
                    HasSubstr("--epoch")));
  EXPECT_EQ(json_of(import_of("tow.csv", {"--epoch", "2024-02-25", "--time-unit", "s"}))["stored"],
            2);
  write("later.csv", "time,u\n2124-02-28T22:00:00Z,1\n");
  EXPECT_THAT(refusal_of(import_of("later.csv")), HasSubstr("--force-times"));
  EXPECT_EQ(json_of(import_of("later.csv", {"--force-times"}))["stored"], 1);
}

TEST_F(TelemetryFiles, AreShownWithoutStoringAnything) {
  write("plain.csv", plain());
  const test::Ran ran = reident(import_of("plain.csv", {"--dry-run"}));
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out,
              AllOf(HasSubstr("plain.csv: commas, header in line 1, UTF-8, time: ISO 8601\n"),
                    HasSubstr("line 2: 2024-02-28T22:00:00Z u=")));
  EXPECT_FALSE(std::filesystem::exists(folder() / "a.db"));
}

TEST_F(TelemetryFiles, OfSeveralSpacecraftAreShownWhereTheyAreTaken) {
  write(
      "long.csv",
      "time,spacecraft,parameter,value\n2024-02-28T22:00:00Z,A,u,1\n2024-02-28T22:00:00Z,B,u,2\n");
  const std::vector<std::string> import = {"import", "long.csv", "--db", "a.db"};
  for (const bool is_one : {false, true}) {
    std::vector<std::string> shown = import;
    shown.push_back("--dry-run");
    if (is_one) shown.insert(shown.end(), {"--spacecraft", "A"});
    EXPECT_EQ(reident(shown).status, is_one ? 2 : 0);
  }
  EXPECT_EQ(reident(import).status, 0);
}

}  // namespace
}  // namespace reident::cli::telemetry_files_test
