// The programs as an operator starts them, with a reader of their telemetry in the test.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/reference/reference_telemetry.hpp"
#include "tests/service/dds/child.hpp"
#include "tests/service/dds/dds_fixture.hpp"

namespace reident::test::program_test {
namespace {

using storage::ParameterDescriptor;
using storage::TelemetryFrame;
using testing::HasSubstr;

constexpr storage::Time second = 1'000'000'000;

std::string text_of(const std::filesystem::path& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class Programs : public testing::Test {
 protected:
  Programs() { std::filesystem::create_directories(folder_); }
  ~Programs() override { std::filesystem::remove_all(folder_); }

  /// `program` on the test's own domain, with its output in files.
  std::vector<std::string> command(const std::string& program, const std::string& arguments) {
    // What the program before it wrote must not be taken for what this one writes.
    std::filesystem::remove(folder_ / "out");
    std::filesystem::remove(folder_ / "err");
    return {"/bin/sh", "-c",
            "cd '" + folder_.string() + "' && exec '" + program + "' " + arguments + " --domain " +
                std::to_string(endpoint_.domain) + " --partition " + endpoint_.partition +
                " >out 2>err"};
  }
  std::vector<std::string> replay(const std::string& arguments) {
    return command(SATCS_REPLAY, "t.csv --spacecraft SAT-1 " + arguments);
  }
  nlohmann::json summary() { return nlohmann::json::parse(text_of(folder_ / "out")); }
  std::string errors() { return text_of(folder_ / "err"); }

  void write(const std::string& text) { std::ofstream(folder_ / "t.csv") << text; }
  /// Rows at 1 Hz: a = the row, b = blank in every third row.
  void write_rows(int rows) {
    std::string text = "unix_s,a,b_mv\n";
    for (int r = 0; r < rows; ++r) {
      text += std::to_string(1'700'000'000 + r) + "," + std::to_string(r) + "," +
              (r % 3 == 0 ? "" : std::to_string(2 * r)) + "\n";
    }
    write(text);
  }
  /// Whether `frame` is the row `r` of write_rows.
  static void expect_row(const TelemetryFrame& frame, std::uint64_t r) {
    ASSERT_EQ(frame.samples.size(), 2U);
    EXPECT_EQ(frame.generation_time, static_cast<storage::Time>(1'700'000'000 + r) * second);
    EXPECT_EQ(frame.reception_time, frame.generation_time);
    EXPECT_EQ(frame.samples[0].parameter, satcs::parameter_id("a"));
    EXPECT_EQ(frame.samples[0].value, static_cast<double>(r));
    EXPECT_EQ(frame.samples[1].parameter, satcs::parameter_id("b"));
    const bool blank = r % 3 == 0;
    EXPECT_EQ(frame.samples[1].quality, blank ? storage::Quality::invalid : storage::Quality::good);
    EXPECT_EQ(std::isnan(frame.samples[1].value), blank);
    if (!blank) {
      EXPECT_EQ(frame.samples[1].value, 2.0 * static_cast<double>(r));
    }
  }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                  ("reident-satcs-" + std::to_string(getpid()) + "-" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
  dds::Endpoint endpoint_ = own_endpoint();
};

TEST_F(Programs, ReplayBringsEveryRowAndItsDescriptors) {
  write_rows(1000);
  dds::Participant participant(endpoint_);
  dds::Reader<TelemetryFrame> frames(participant);
  dds::Reader<ParameterDescriptor> descriptors(participant);
  Child child(
      replay("--speed max --json --invalid-blanks --first-sequence 501 --source station --origin "
             "simulated"));
  const auto received = take_all(frames, 1000);
  ASSERT_EQ(received.size(), 1000U);
  for (std::uint64_t r = 0; r < 1000; ++r) {
    EXPECT_EQ(received[r].sequence, 501 + r);
    EXPECT_EQ(received[r].spacecraft, "SAT-1");
    EXPECT_EQ(received[r].source, "station");
    EXPECT_EQ(received[r].origin, storage::Origin::simulated);
    expect_row(received[r], r);
  }
  std::map<std::string, ParameterDescriptor> described;
  for (auto& d : take_all(descriptors, 2)) described[d.name] = d;
  EXPECT_EQ(described["a"].unit, "");
  EXPECT_EQ(described["b"].unit, "mV");
  EXPECT_EQ(described["b"].spacecraft, "SAT-1");
  EXPECT_EQ(described["b"].id, satcs::parameter_id("b"));

  EXPECT_EQ(child.wait(), 0) << errors();
  const auto json = summary();
  EXPECT_EQ(json["outcome"], "complete");
  EXPECT_EQ(json["frames"], 1000);
  EXPECT_EQ(json["samples"], 2000);
  EXPECT_EQ(json["invalid_samples"], 334);
  EXPECT_EQ(json["first_sequence"], 501);
  EXPECT_EQ(json["last_sequence"], 1500);
  EXPECT_EQ(json["first_time"], "2023-11-14T22:13:20Z");
  EXPECT_EQ(json["last_time"], "2023-11-14T22:29:59Z");
  EXPECT_EQ(json["frames_missed"], 0);
  EXPECT_THAT(json["found"].get<std::string>(), HasSubstr("header in line 1"));
  EXPECT_EQ(json["columns_left_out"], nlohmann::json::array());
}

TEST_F(Programs, ReplayAtFullSpeedLosesNothingToASlowReader) {
  constexpr std::uint64_t rows = 5'000;
  write_rows(rows);
  dds::Participant participant(endpoint_);
  dds::Reader<TelemetryFrame> frames(participant, {.max_samples = 32});
  dds::WaitSet wait_set(participant);
  wait_set.attach(frames);
  Child child(replay("--speed max --json --invalid-blanks"));
  std::uint64_t next = 0;
  while (next < rows && !HasFailure() && wait_set.wait(20s)) {
    frames.take(3, [&](TelemetryFrame&& frame) {
      EXPECT_EQ(frame.sequence, next + 1);
      expect_row(frame, next++);
    });
  }
  EXPECT_EQ(next, rows);
  EXPECT_EQ(child.wait(), 0) << errors();
  EXPECT_EQ(summary()["frames"], rows);
}

TEST_F(Programs, ReplayKeepsToItsSpeed) {
  write_rows(31);
  dds::Participant participant(endpoint_);
  dds::Reader<TelemetryFrame> frames(participant);
  Child child(replay("--speed 20 --json"));
  EXPECT_EQ(child.wait(), 0) << errors();
  EXPECT_GE(summary()["wall_s"].get<double>(), 1.5);
  EXPECT_EQ(take_all(frames, 31).size(), 31U);
}

TEST_F(Programs, ReplayWritesNothingBeforeItsReadersAreThere) {
  write_rows(10);
  Child child(replay("--speed max --json --wait-readers 2"));
  dds::Participant participant(endpoint_);
  dds::Reader<TelemetryFrame> first(participant);
  ASSERT_TRUE(
      eventually([&] { return errors().find("waiting for readers") != std::string::npos; }));
  ASSERT_TRUE(eventually([&] { return first.matched_writers() == 1; }));
  EXPECT_EQ(first.take(100, [](TelemetryFrame&&) {}), 0U);
  dds::Reader<TelemetryFrame> second_reader(participant);
  EXPECT_EQ(take_all(first, 10).size(), 10U);
  EXPECT_EQ(take_all(second_reader, 10).size(), 10U);
  EXPECT_EQ(child.wait(), 0) << errors();
}

TEST_F(Programs, ReplayPausesWhileItsReaderIsGone) {
  write_rows(2000);
  dds::Participant participant(endpoint_);
  Child child(replay("--speed 1000 --json --history 0"));
  std::vector<TelemetryFrame> received;
  {
    dds::Reader<TelemetryFrame> reader(participant);
    received = take_all(reader, 20);
  }
  ASSERT_GE(received.size(), 20U);
  ASSERT_TRUE(
      eventually([&] { return errors().find("waiting for readers") != std::string::npos; }));
  dds::Reader<TelemetryFrame> next_reader(participant);
  std::uint64_t last = 0;
  ASSERT_TRUE(eventually([&] {
    next_reader.take(1000, [&](TelemetryFrame&& frame) {
      EXPECT_TRUE(last == 0 || frame.sequence == last + 1);
      last = frame.sequence;
    });
    return last == 2000;
  }));
  EXPECT_EQ(child.wait(), 0) << errors();
}

TEST_F(Programs, ReplayGivesWhatItKeptToAReaderThatJoinsLate) {
  write_rows(50);
  Child child(replay("--speed max --wait-readers 0 --history 20 --linger 60s --json"));
  dds::Participant participant(endpoint_);
  dds::Reader<TelemetryFrame> late(participant);
  std::uint64_t last = 0;
  ASSERT_TRUE(eventually([&] {
    late.take(100, [&](TelemetryFrame&& frame) { last = frame.sequence; });
    return last == 50;
  }));
  child.signal(SIGTERM);  // ends the linger and takes nothing from what was delivered
  EXPECT_EQ(child.wait(), 0) << errors();
  EXPECT_EQ(summary()["outcome"], "complete");
}

TEST_F(Programs, StopAtAnyPointWithASummaryAndTheSignalInTheStatus) {
  write_rows(100'000);
  const std::map<std::string, int> ways = {{"--speed 1", SIGINT}, {"--speed max", SIGTERM}};
  for (const auto& [speed, signal] : ways) {
    dds::Participant participant(endpoint_);
    // Never taken from: at full speed the write blocks.
    dds::Reader<TelemetryFrame> full(participant, {.max_samples = 4});
    Child child(replay(speed + " --json"));
    ASSERT_TRUE(eventually([&] { return full.matched_writers() == 1; }));
    child.signal(signal);
    EXPECT_EQ(child.wait(), 128 + signal) << errors();
    EXPECT_EQ(summary()["outcome"], "stopped") << speed;
    EXPECT_LT(summary()["frames"], 100'000);
  }
  Child waiting(replay("--json"));
  ASSERT_TRUE(
      eventually([&] { return errors().find("waiting for readers") != std::string::npos; }));
  waiting.signal(SIGTERM);
  EXPECT_EQ(waiting.wait(), 128 + SIGTERM);
  EXPECT_EQ(summary()["frames"], 0);
  EXPECT_TRUE(summary()["last_time"].is_null());
}

TEST_F(Programs, SayWhenNobodyTookTheTelemetry) {
  write_rows(10);
  EXPECT_EQ(Child(replay("--speed max --json --wait-timeout 100ms")).wait(), 3);
  EXPECT_EQ(summary()["outcome"], "no_readers");
  EXPECT_THAT(errors(), HasSubstr("fewer than 1 readers came within the time-out; start reidentd"));

  write_rows(10);
  dds::Participant participant(endpoint_);
  dds::Reader<TelemetryFrame> full(participant, {.max_samples = 4});
  // All ten frames fit what the writer may have in flight, but the reader takes four. The reader
  // has to be found within the time-out too.
  EXPECT_EQ(Child(replay("--speed max --json --wait-timeout 10s")).wait(), 3);
  EXPECT_EQ(summary()["outcome"], "not_acknowledged");
  EXPECT_EQ(summary()["frames"], 10);
}

TEST_F(Programs, RefuseImpossibleRequestsInOneLine) {
  write("t,a\n1,2\n");
  struct Case {
    std::string arguments;
    const char* complaint;
  };
  for (const auto& [arguments, complaint] : {
           Case{"--speed 0",
                "satcs-replay: --speed: '0' is not a number above 0 or 'max'; see "
                "satcs-replay --help\n"},
           Case{"--origin moon",
                "satcs-replay: --origin: 'moon' is not 'real' or 'simulated'; see "
                "satcs-replay --help\n"},
           Case{"--map a",
                "satcs-replay: --map: 'a' is not COLUMN=PARAMETER[:UNIT]; see "
                "satcs-replay --help\n"},
           Case{"--start noon",
                "satcs-replay: --start: 'noon' is not a time, or an offset such as "
                "+90 or 2h; see satcs-replay --help\n"},
           Case{"--linger -1s",
                "satcs-replay: --linger: '-1s' is not a duration such as 30s; see "
                "satcs-replay --help\n"},
           Case{"--force-times --only b",
                "satcs-replay: t.csv: there is no column 'b'; the columns are: t, a\n"},
       }) {
    EXPECT_EQ(Child(replay(arguments)).wait(), 2) << arguments;
    EXPECT_EQ(errors(), complaint);
    EXPECT_EQ(text_of(folder_ / "out"), "");
  }
  EXPECT_EQ(Child(command(SATCS_REPLAY, "none.csv --spacecraft S")).wait(), 2);
  EXPECT_EQ(errors(), "satcs-replay: none.csv: there is no such file; check the path\n");
  EXPECT_EQ(Child(replay("--force-times --source \xe9")).wait(), 2);
  EXPECT_THAT(errors(), HasSubstr("satcs-replay: source is not UTF-8; give another name\n"));
  EXPECT_EQ(Child(replay("--force-times --map a=caf\xe9")).wait(), 2);
  EXPECT_THAT(errors(), HasSubstr("a service would refuse it: name is not UTF-8"));
  EXPECT_EQ(Child(command(SATCS_REFERENCE, "--fault stuk@+1h/+2h:V_BUS")).wait(), 2);
  EXPECT_THAT(errors(),
              HasSubstr("satcs-reference: --fault: 'stuk@+1h/+2h:V_BUS': there is no fault "
                        "'stuk'; the faults are: stuck, bias_step, "));
  EXPECT_EQ(Child(command(SATCS_REFERENCE, "--fault stuck@+1h/+2h")).wait(), 2);
  EXPECT_EQ(errors(),
            "satcs-reference: --fault: the fault stuck needs a parameter, such as :V_BUS\n");
  EXPECT_EQ(Child(command(SATCS_REFERENCE, "--duration 0s")).wait(), 2);
  EXPECT_EQ(errors(),
            "satcs-reference: --duration: '0s' is not a duration above 0 such as 12h; see "
            "satcs-reference --help\n");
}

TEST_F(Programs, HelpShowsAnExample) {
  for (const char* program : {SATCS_REPLAY, SATCS_REFERENCE}) {
    EXPECT_EQ(Child({"/bin/sh", "-c",
                     std::string(program) + " --help >'" + (folder_ / "out").string() + "'"})
                  .wait(),
              0);
    EXPECT_THAT(text_of(folder_ / "out"), HasSubstr("Example"));
  }
}

TEST_F(Programs, ReferencePublishesTheSameTelemetryForTheSameSeed) {
  const std::size_t points = satcs::reference::telemetry_points().size();
  const auto run = [&](const std::string& seed) {
    dds::Participant participant(endpoint_);
    dds::Reader<TelemetryFrame> frames(participant);
    dds::Reader<ParameterDescriptor> descriptors(participant);
    Child child(command(SATCS_REFERENCE, "--duration 5min --speed max --json --seed " + seed));
    auto received = take_all(frames, 300);
    EXPECT_EQ(take_all(descriptors, points).size(), points);
    EXPECT_EQ(child.wait(), 0) << errors();
    EXPECT_EQ(summary()["frames"], 300);
    EXPECT_EQ(summary()["spacecraft"], "REFERENCE");
    return received;
  };
  const auto first = run("3");
  const auto again = run("3");
  const auto other = run("4");
  ASSERT_EQ(first.size(), 300U);
  ASSERT_EQ(again.size(), 300U);
  ASSERT_EQ(other.size(), 300U);
  std::size_t differ = 0;
  for (std::size_t f = 0; f < 300; ++f) {
    EXPECT_EQ(first[f].generation_time,
              1'498'867'200 * second + static_cast<storage::Time>(f) * second);
    ASSERT_EQ(first[f].samples.size(), again[f].samples.size());
    ASSERT_EQ(first[f].samples.size(), other[f].samples.size());
    for (std::size_t s = 0; s < first[f].samples.size(); ++s) {
      EXPECT_EQ(first[f].samples[s].value, again[f].samples[s].value);
      differ += first[f].samples[s].value != other[f].samples[s].value;
    }
  }
  EXPECT_GT(differ, 3000U);
}

TEST_F(Programs, ReferenceWrittenAsAFileIsReplayedToTheSameTelemetry) {
  const auto received = [&](const std::vector<std::string>& command) {
    dds::Participant participant(endpoint_);
    dds::Reader<TelemetryFrame> frames(participant);
    Child child(command);
    auto result = take_all(frames, 120);
    EXPECT_EQ(child.wait(), 0) << errors();
    return result;
  };
  const auto direct = received(command(SATCS_REFERENCE, "--duration 2min --speed max"));
  ASSERT_EQ(Child(command(SATCS_REFERENCE, "--duration 2min --csv t.csv")).wait(), 0);
  const auto replayed = received(replay("--speed max"));
  ASSERT_EQ(direct.size(), 120U);
  ASSERT_EQ(replayed.size(), 120U);
  for (std::size_t f = 0; f < 120; ++f) {
    EXPECT_EQ(direct[f].generation_time, replayed[f].generation_time);
    // The blank cells of the points that were not due are no samples.
    std::map<std::uint32_t, double> of_file;
    for (const auto& sample : replayed[f].samples) of_file[sample.parameter] = sample.value;
    ASSERT_EQ(direct[f].samples.size(), of_file.size());
    for (const auto& sample : direct[f].samples) {
      EXPECT_EQ(sample.value, of_file.at(sample.parameter));
    }
  }
}

TEST_F(Programs, TheHandWrittenSimulationIsSentAsASimulator) {
  dds::Participant participant(endpoint_);
  dds::Reader<TelemetryFrame> frames(participant);
  Child child(command(SATCS_REFERENCE, "--duration 1min --speed max --simulated"));
  const auto received = take_all(frames, 60);
  EXPECT_EQ(child.wait(), 0) << errors();
  ASSERT_EQ(received.size(), 60U);
  EXPECT_EQ(received[0].source, "simulator");
  EXPECT_EQ(received[0].origin, storage::Origin::simulated);
  EXPECT_EQ(received[0].spacecraft, "REFERENCE");
  EXPECT_EQ(received[0].generation_time, 1'498'867'200 * second);
  EXPECT_GT(received[0].samples.size(), 17U);
}

TEST_F(Programs, ThePlatformIsAnotherSpacecraftWithItsOwnParametersAndLife) {
  dds::Participant participant(endpoint_);
  dds::Reader<TelemetryFrame> frames(participant);
  Child child(command(SATCS_REFERENCE,
                      "--family platform --duration 1min --speed max --life bearing_wear@+30s#1"));
  const auto received = take_all(frames, 60);
  EXPECT_EQ(child.wait(), 0) << errors();
  ASSERT_EQ(received.size(), 60U);
  EXPECT_EQ(received[0].spacecraft, "PLATFORM");
  EXPECT_EQ(received[0].samples[0].parameter, satcs::parameter_id("TQ_RW1"));

  ASSERT_EQ(Child(command(SATCS_REFERENCE,
                          "--family platform --duration 1min --csv t.csv "
                          "--simulated"))
                .wait(),
            0);
  EXPECT_THAT(text_of(folder_ / "t.csv"), testing::StartsWith("unix_s,TQ_RW1,"));
  EXPECT_EQ(Child(command(SATCS_REFERENCE, "--life bearing_wear@+1h")).wait(), 2);
  EXPECT_EQ(errors(),
            "satcs-reference: --life: 'bearing_wear@+1h' does not happen to the family power; "
            "give --family platform\n");
  EXPECT_EQ(Child(command(SATCS_REFERENCE, "--family moon")).wait(), 2);
  EXPECT_EQ(errors(),
            "satcs-reference: --family: 'moon' is not power or platform; see "
            "satcs-reference --help\n");
}

TEST_F(Programs, TheHandWrittenSimulationIsWrittenToAFile) {
  ASSERT_EQ(Child(command(SATCS_REFERENCE, "--duration 1min --csv t.csv --simulated")).wait(), 0);
  const std::string text = text_of(folder_ / "t.csv");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 61);
  EXPECT_THAT(text, testing::StartsWith("unix_s,I_BDRIN1,I_BDRIN2,I_BDROUT,I_BAT1,"));
  EXPECT_THAT(text, testing::Not(HasSubstr("V_MEA")));
}

TEST_F(Programs, AFileThatExistsIsReplacedWhereThatIsAskedForAlone) {
  std::ofstream(folder_ / "t.csv") << "kept";
  EXPECT_EQ(Child(command(SATCS_REFERENCE, "--duration 1min --csv t.csv")).wait(), 2);
  EXPECT_THAT(errors(), HasSubstr("t.csv exists"));
  EXPECT_EQ(text_of(folder_ / "t.csv"), "kept");
  EXPECT_EQ(Child(command(SATCS_REFERENCE, "--duration 1min --csv t.csv --replace")).wait(), 0);
  EXPECT_THAT(text_of(folder_ / "t.csv"), testing::StartsWith("unix_s,"));
}

}  // namespace
}  // namespace reident::test::program_test
