#include "service/satcs/replay/replay.hpp"

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/replay/replay_columns.hpp"

namespace reident::satcs::replay_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::int64_t second = 1'000'000'000;

class Replay : public testing::Test {
 protected:
  Replay() {
    std::filesystem::create_directories(folder_);
    options_.reading.force_times = true;  // of rows whose times are small numbers
  }
  ~Replay() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& text) {
    options_.file = folder_ / "t.csv";
    std::ofstream(options_.file, std::ios::binary) << text;
  }
  ReplayPlan plan() {
    auto result = plan_replay(options_);
    if (const auto* error = std::get_if<csv::Error>(&result)) ADD_FAILURE() << error->message;
    auto* plan = std::get_if<ReplayPlan>(&result);
    return plan ? *plan : ReplayPlan{};
  }
  /// What the plan for these options complains of, the folder left out.
  std::string complaint() {
    auto result = plan_replay(options_);
    const auto* error = std::get_if<csv::Error>(&result);
    if (!error) return "none";
    std::string message = error->message;
    const auto at = message.find(folder_.string() + "/");
    return at == std::string::npos ? message : message.erase(at, folder_.string().size() + 1);
  }
  /// "name:unit" of each parameter.
  std::vector<std::string> parameters() {
    std::vector<std::string> names;
    for (const auto& column : plan().columns) {
      EXPECT_EQ(column.parameter.id, parameter_id(column.parameter.name));
      names.push_back(column.parameter.name + ":" + column.parameter.unit);
    }
    return names;
  }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                  ("reident-replay-" + std::to_string(getpid()) + "-" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
  ReplayOptions options_;
};

TEST(ReplayNames, LoseTheUnitAtTheirEnd) {
  struct Case {
    const char* column;
    NameAndUnit expected;
  };
  for (const auto& [column, expected] : {
           Case{"bus_u_mv", {"bus_u", "mV"}},
           Case{"mppt1_iin_ma", {"mppt1_iin", "mA"}},
           Case{"voltage_v", {"voltage", "V"}},
           Case{"temp_c", {"temp", "degC"}},
           Case{"xmit_a_ma", {"xmit_a", "mA"}},
           Case{"capacity_mah", {"capacity", "mAh"}},
           Case{"V_BUS", {"V_BUS", ""}},
           Case{"I_SAG1A", {"I_SAG1A", ""}},
           Case{"u1", {"u1", ""}},
           Case{"_mv", {"_mv", ""}},
           Case{"mv", {"mv", ""}},
           Case{"x_mv_", {"x_mv_", ""}},
       }) {
    EXPECT_EQ(split_unit(column), expected) << column;
  }
}

TEST(ReplayMapping, IsColumnParameterAndUnit) {
  const auto full = parse_mapping("bus_u_mv=V_BUS:mV");
  ASSERT_TRUE(full);
  EXPECT_THAT((std::vector{full->column, full->parameter, full->unit}),
              ElementsAre("bus_u_mv", "V_BUS", "mV"));
  const auto bare = parse_mapping("a=b");
  ASSERT_TRUE(bare);
  EXPECT_EQ(bare->unit, "");
  for (const char* text : {"", "a", "a=", "=b", "a=:V"}) EXPECT_FALSE(parse_mapping(text)) << text;
}

TEST(ReplayBounds, AreTimesOrOffsets) {
  const auto bound = [](std::string_view text) {
    const auto parsed = parse_bound(text);
    return parsed ? std::pair(parsed->relative, parsed->ns) : std::pair(false, std::int64_t{-1});
  };
  EXPECT_EQ(bound("2h"), std::pair(true, 7200 * second));
  EXPECT_EQ(bound("+90"), std::pair(true, 90 * second));
  EXPECT_EQ(bound("1682785357"), std::pair(false, 1'682'785'357 * second));
  EXPECT_EQ(bound("2023-04-29T16:22:37Z"), std::pair(false, 1'682'785'357 * second));
  for (const char* text : {"", "+", "noon", "+-3", "-2h"}) EXPECT_FALSE(parse_bound(text)) << text;
}

TEST_F(Replay, TakesTheFirstColumnThatLooksLikeATime) {
  struct Case {
    const char* text;
    const char* column;
  };
  for (const auto& [text, column] : {
           Case{"x,unix_s\n1,2\n", "unix_s"},
           Case{"unix_s,src_time_minute,x\n1677715200,2023/3/2 00:00,1\n", "unix_s"},
           Case{"t,x\n1,2\n", "t"},
           Case{"x,iso_date\n1,2004-02-14\n", "iso_date"},
           Case{"x,when\n1,2004-02-14 10:00\n", "when"},
           Case{"timer_state,UTC,x\nidle,5,1\n", "UTC"},
       }) {
    write(text);
    EXPECT_EQ(plan().time_column, column) << text;
  }
  write("x,unix_s\n1,2\n");
  options_.reading.time.column = "x";
  EXPECT_EQ(plan().time_column, "x");
}

TEST_F(Replay, MakesParametersOfTheOtherColumns) {
  write("unix_s,bus_u_mv,mode,V_MEA,,empty\n1,16238,idle,7,9,\n");
  EXPECT_THAT(parameters(), ElementsAre("bus_u:mV", "V_MEA:"));
  EXPECT_THAT(plan().left_out, ElementsAre("mode", "empty"));
  options_.keep_names = true;
  EXPECT_THAT(parameters(), ElementsAre("bus_u_mv:", "V_MEA:"));
  options_.mappings = {{"bus_u_mv", "V_BUS", "mV"}, {"mode", "MODE", ""}};
  EXPECT_THAT(parameters(), ElementsAre("V_BUS:mV", "MODE:", "V_MEA:"));
  options_.only = {"mode", "bus_u_mv"};
  EXPECT_THAT(parameters(), ElementsAre("V_BUS:mV", "MODE:"));
}

TEST_F(Replay, SendsOneSampleARowAsTheTableThatItStandsFor) {
  write("time,name,value\n10,u,1\n20,u,2\n10,v,5\n");
  EXPECT_THAT(parameters(), ElementsAre("u:", "v:"));
  EXPECT_EQ(plan().rows, 2U);
  options_.invalid_blanks = true;
  EXPECT_FALSE(plan().invalid_blanks) << "v has no sample at 20";
}

TEST_F(Replay, RefusesWhatCannotBeReplayed) {
  struct Case {
    const char* text;
    std::function<void(ReplayOptions&)> change;
    const char* complaint;
  };
  const auto nothing = [](ReplayOptions&) {};
  const char* good = "t,a_mv,b\n1,2,3\n5,6,7\n";
  for (const auto& [text, change, expected] : {
           Case{"t,a\n", nothing,
                "t.csv: the header is not followed by a row; there is nothing to "
                "replay"},
           Case{"u1,y1\n1,2\n", nothing,
                "t.csv:2: no column looks like a time; name it with "
                "--time, or the line of the header with --header (the columns are: u1, y1)"},
           Case{"t,mode\n1,idle\n", nothing,
                "t.csv: no column holds numbers besides the time 't'; "
                "there is nothing to send or to import; column 'mode' is left out"},
           Case{"t,a\n1,2\nnoon,3\n", nothing, "t.csv:3: 'noon' in column 't' is no time"},
           Case{"t,a\n1,2\n2\n", nothing,
                "t.csv:3: the row has 1 cells, the header has 2; mend the row"},
           Case{"t,x_mv,x_v\n1,2,3\n", nothing,
                "columns 'x_mv' and 'x_v' would both be parameter "
                "'x'; give one of them another name with --map"},
           Case{good, [](auto& o) { o.reading.time.column = "when"; },
                "t.csv: there is no column 'when'; the columns are: t, a_mv, b"},
           Case{good, [](auto& o) { o.only = {"c"}; },
                "t.csv: there is no column 'c'; the columns are: t, a_mv, b"},
           Case{good,
                [](auto& o) {
                  o.mappings = {{"c", "C", ""}};
                },
                "t.csv: there is no column 'c'; the columns are: t, a_mv, b"},
           Case{good,
                [](auto& o) {
                  o.only = {"b"};
                  o.mappings = {{"a_mv", "A", ""}};
                },
                "column 'a_mv' is mapped but not among --only; add it there"},
           Case{good,
                [](auto& o) {
                  o.start = ReplayBound{false, 6 * second};
                },
                "t.csv: no row lies between the start and the end asked for; the rows go from "
                "1970-01-01T00:00:01Z to 1970-01-01T00:00:05Z"},
       }) {
    write(text);
    change(options_);
    EXPECT_THAT(complaint(), StartsWith(expected)) << text;
    options_ = {};
    options_.reading.force_times = true;
  }
}

TEST_F(Replay, RefusesAPipeBecauseItReadsTwice) {
  options_.file = folder_ / "pipe";
  ASSERT_EQ(mkfifo(options_.file.c_str(), 0600), 0);
  EXPECT_EQ(complaint(), "pipe: is no regular file and cannot be read twice; save it as one first");
}

TEST_F(Replay, GivesEveryRowInTheOrderOfTheFile) {
  write("t,a,b\n10,1,x\n9.5,,2\n9.5,nan,-0.5\n20,1e400,3\n");
  options_.invalid_blanks = true;
  const auto replayed = plan();
  EXPECT_EQ(replayed.rows, 4U);
  ReplayStream stream(replayed, {"station", storage::Origin::simulated, 7});
  std::uint64_t sequence = 7;
  struct Row {
    std::int64_t time;
    double a, b;  // NaN: invalid
  };
  const double none = std::nan("");
  for (const Row& row : {Row{10 * second, 1, none}, Row{19 * second / 2, none, 2},
                         Row{19 * second / 2, none, -0.5}, Row{20 * second, none, 3}}) {
    storage::TelemetryFrame frame;
    ASSERT_TRUE(stream.next(frame));
    EXPECT_EQ(frame.source, "station");
    EXPECT_EQ(frame.origin, storage::Origin::simulated);
    EXPECT_EQ(frame.sequence, sequence++);
    EXPECT_EQ(frame.generation_time, row.time);
    EXPECT_EQ(frame.reception_time, row.time);
    const auto& samples = frame.samples;
    ASSERT_EQ(samples.size(), 2U);
    for (const auto& [sample, expected] : {std::pair(samples[0], row.a), {samples[1], row.b}}) {
      EXPECT_EQ(std::isnan(sample.value), std::isnan(expected));
      if (!std::isnan(expected)) {
        EXPECT_EQ(sample.value, expected);
      }
      EXPECT_EQ(sample.quality,
                std::isnan(expected) ? storage::Quality::invalid : storage::Quality::good);
    }
  }
  storage::TelemetryFrame frame;
  EXPECT_FALSE(stream.next(frame));
  EXPECT_EQ(stream.progress(), 1);
}

TEST_F(Replay, TakesBlankCellsForNoSamplesAsAnImportDoes) {
  write("t,a,b\n1,1, \n2,,nan\n3,4,5\n");
  ReplayStream stream(plan(), {"station"});
  storage::TelemetryFrame frame;
  ASSERT_TRUE(stream.next(frame));
  ASSERT_EQ(frame.samples.size(), 1U);
  EXPECT_EQ(frame.samples[0].value, 1);
  ASSERT_TRUE(stream.next(frame));
  ASSERT_EQ(frame.samples.size(), 1U);
  EXPECT_EQ(frame.samples[0].quality, storage::Quality::invalid);
  ASSERT_TRUE(stream.next(frame));
  EXPECT_EQ(frame.samples.size(), 2U);
}

TEST_F(Replay, KeepsToTheRangeAskedFor) {
  write("t,a\n12,3\n10,1\n11,2\n13,4\n");
  const auto values = [&] {
    ReplayStream stream(plan(), {"station"});
    std::vector<double> result;
    storage::TelemetryFrame frame;
    while (stream.next(frame)) result.push_back(frame.samples[0].value);
    return result;
  };
  options_.start = ReplayBound{true, second};  // from the earliest row, not the first
  EXPECT_THAT(values(), ElementsAre(3, 2, 4));
  options_.end = ReplayBound{false, 13 * second};
  EXPECT_THAT(values(), ElementsAre(3, 2));
  options_.start.reset();
  EXPECT_THAT(values(), ElementsAre(3, 1, 2));
  options_.end = ReplayBound{true, std::numeric_limits<std::int64_t>::max()};
  EXPECT_THAT(values(), ElementsAre(3, 1, 2, 4));
  std::swap(options_.start, options_.end);
  EXPECT_THAT(complaint(), HasSubstr("no row lies between the start and the end asked for"));
}

TEST_F(Replay, FailsWhenTheFileChangesUnderIt) {
  write("t,a\n1,2\n2,3\n");
  const auto replayed = plan();
  write("t,a\n1,2\nnoon,3\n");
  ReplayStream stream(replayed, {"station"});
  storage::TelemetryFrame frame;
  EXPECT_TRUE(stream.next(frame));
  EXPECT_THROW(stream.next(frame), std::runtime_error);
  std::filesystem::remove(options_.file);
  EXPECT_THROW(ReplayStream(replayed, {"station"}), std::runtime_error);
}

}  // namespace
}  // namespace reident::satcs::replay_test
