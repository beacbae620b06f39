// reident-simulator as a process, over the real middleware.
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "tests/service/client/live_telemetry.hpp"
#include "tests/service/dds/child.hpp"
#include "tests/service/dds/dds_fixture.hpp"

namespace reident::test::simulator_program_test {
namespace {

class SimulatorProgram : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::vector<std::string> command() const {
    // A shell of its own sends the output to a file; exec keeps the process id.
    return {"/bin/sh", "-c",
            std::string("exec ") + SIMULATOR +
                " --spacecraft CBERS4 --equipment BDR --name trainer --json --report 0.1"
                " --cache " +
                (folder_ / "cache").string() + " --domain " + std::to_string(endpoint_.domain) +
                " --partition " + endpoint_.partition + " > " + output().string()};
  }
  std::filesystem::path output() const { return folder_ / "out"; }
  std::vector<nlohmann::json> events(const std::string& kind) const {
    std::vector<nlohmann::json> found;
    std::ifstream file(output());
    for (std::string line; std::getline(file, line);) {
      auto event = nlohmann::json::parse(line, nullptr, false);
      if (!event.is_discarded() && event["event"] == kind) found.push_back(std::move(event));
    }
    return found;
  }

  dds::Endpoint endpoint_ = own_endpoint();
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("simulator-test-" + std::to_string(getpid()));
  dds::Participant participant_{endpoint_};
  dds::Writer<ModelVersion> versions_{participant_};
  dds::Writer<storage::ParameterDescriptor> descriptors_{participant_};
  dds::Writer<storage::TelemetryFrame> frames_{participant_, {.history = 1000}};
  dds::Reader<ModelAcknowledgement> acknowledgements_{participant_};
};

TEST_F(SimulatorProgram, StartedLateRunsTheChampionAndSwapsWhileItRuns) {
  versions_.write(example_version(1));
  for (const auto& descriptor : example_descriptors()) descriptors_.write(descriptor);
  ExamplePlant plant;
  std::int64_t k = 0;
  for (; k < 300; ++k) frames_.write(plant.frame(k));

  Child simulator(command());
  ASSERT_TRUE(eventually([&] { return !events("adopted").empty(); }));
  ModelVersion damaged = example_version(2);
  damaged.model.dynamics.B *= 2;
  versions_.write(damaged);
  ASSERT_TRUE(eventually([&] { return !events("refused").empty(); }));
  versions_.write(example_version(3));
  ASSERT_TRUE(eventually([&] { return events("adopted").size() == 2; }));
  ASSERT_TRUE(eventually([&] {
    frames_.write(plant.frame(k++));
    const auto reports = events("running");
    return !reports.empty() && reports.back()["version"] == 3 && reports.back()["ticks"] > 10;
  }));
  simulator.signal(SIGTERM);
  EXPECT_EQ(simulator.wait(), 0);

  EXPECT_EQ(events("adopted")[0]["version"], 1);
  EXPECT_EQ(events("adopted")[1]["version"], 3);
  const auto last = events("finished").back();
  EXPECT_EQ(last["version"], 3);
  EXPECT_LT(last["mrse_percent"][0], 1e-3);
  EXPECT_EQ(last["gaps"], 0);

  std::vector<std::pair<std::int64_t, bool>> said;
  acknowledgements_.take(1000, [&](ModelAcknowledgement&& message) {
    if (message.simulator == "trainer") said.emplace_back(message.version, message.accepted);
  });
  ASSERT_FALSE(said.empty());
  EXPECT_EQ(said.back(), std::make_pair(std::int64_t{3}, true));
}

TEST_F(SimulatorProgram, WaitsWithoutAServiceAndStopsCleanly) {
  Child simulator(command());
  ASSERT_TRUE(eventually([&] { return versions_.matched_readers() == 1; }));
  ASSERT_TRUE(eventually([&] { return !events("unpublished").empty(); }));
  EXPECT_EQ(events("unpublished")[0]["equipment"], "BDR");
  simulator.signal(SIGINT);
  EXPECT_EQ(simulator.wait(), 0);
}

TEST(SimulatorOptions, ThatAreWrongEndWithStatus2) {
  for (const std::string options : {"", "--spacecraft", "--spacecraft A --domain 999",
                                    "--spacecraft A --report 0", "--spacecraft A --unknown"}) {
    Child simulator({"/bin/sh", "-c", std::string(SIMULATOR) + " " + options + " 2>/dev/null"});
    EXPECT_EQ(simulator.wait(), 2) << options;
  }
}

}  // namespace
}  // namespace reident::test::simulator_program_test
