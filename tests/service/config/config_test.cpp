#include "service/config/config.hpp"

#include <filesystem>
#include <fstream>
#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/service/config/config_text.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::config_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

TEST(Config, SaysHowLongTelemetryIsKeptAndInHowMuchRoom) {
  const Config config = config_of("[archive]\nkeep = \"400 d\"\nmax_size = \"200 GB\"\n" + minimal);
  EXPECT_EQ(config.keep, 400 * 24 * 60 * min);
  EXPECT_EQ(config.max_size, 200'000'000'000U);
}

TEST(Config, AMinimalFileHasGoodDefaults) {
  const Config config = config_of(minimal);
  EXPECT_EQ(config.service_name, "reident");
  EXPECT_EQ(config.database, "/folder/reident.db");
  EXPECT_EQ(config.partition, "operations");
  EXPECT_EQ(config.batch_delay, 100 * ms);
  EXPECT_EQ(config.durability, storage::Durability::power_cut);
  EXPECT_EQ(config.max_clock_lead, 60 * min);
  EXPECT_EQ(config.settle, s);
  EXPECT_EQ(config.keep, std::nullopt);
  EXPECT_EQ(config.max_size, std::nullopt);
  ASSERT_THAT(config.spacecraft, SizeIs(1));
  ASSERT_THAT(config.spacecraft[0].equipment, SizeIs(1));
  const EquipmentConfig& bdr = config.spacecraft[0].equipment[0];
  EXPECT_THAT(bdr.inputs, ElementsAre("I_BDRIN1", "I_BDRIN2"));
  EXPECT_EQ(bdr.sample_hold, 3 * s);
  EXPECT_EQ(bdr.window, 100 * min);
  EXPECT_EQ(bdr.slide, 30 * min) << "the validation part of the window";
  EXPECT_EQ(bdr.min_order, 1);
  EXPECT_EQ(bdr.max_order, 10);
  EXPECT_EQ(bdr.horizon, std::nullopt);
  EXPECT_EQ(bdr.baseline_mrse_percent, std::nullopt);
  EXPECT_EQ(bdr.approval, ApprovalPolicy::automatic);
}

TEST(Config, LeavesThePhaseToTelemetryWhereNoneIsGiven) {
  const auto phase = [](const std::string& text) {
    return config_of(text).spacecraft[0].equipment[0].phase;
  };
  EXPECT_EQ(phase(minimal), std::nullopt);
  EXPECT_EQ(phase(minimal + "phase = \"0s\""), 0);
  EXPECT_EQ(phase(minimal + "phase = \"180ms\""), 180 * ms);
}

TEST(Config, CutOfTheNetworkIsALengthAndARate) {
  const Config config = config_of("[dds]\ncut = \"60s\"\nrate = \"6/min\"\n" + minimal);
  EXPECT_EQ(config.cut, 60'000'000'000);
  EXPECT_EQ(config.rate, 0.1);
  EXPECT_EQ(config_of(minimal).cut, 0);
}

TEST(Config, TheServicesOfAPairAreCalledByTheirStrength) {
  const auto pair = [](const std::string& keys) {
    return config_of("[service]\n" + keys + minimal);
  };
  EXPECT_EQ(pair("").pair, "");
  const Config config = pair("name = \"flight\"\nstandby = true\nstrength = 1\n");
  EXPECT_EQ(config.pair, "flight");
  EXPECT_EQ(config.service_name, "flight-1");
  EXPECT_EQ(config.strength, 1);
  EXPECT_EQ(pair("standby = false\n").service_name, "reident");
}

TEST(Config, EveryKeyIsRead) {
  const Config config = config_of(R"(
[service]
name = "second"
log_level = "debug"
workers = 4
[archive]
database = "/var/lib/archive.db"
batch_frames = 100
batch_delay = "250ms"
recent_samples = 50000
durability = "kill"
[dds]
domain = 42
partition = "training"
[limits]
queue_frames = 64
queue_mib = 3
max_frame_samples = 1000
max_clock_lead = "10s"
settle = "300ms"
[[spacecraft]]
name = "C"
[[spacecraft.equipment]]
name = "X"
inputs = ["u"]
outputs = ["y", "z"]
sample_period = "500ms"
hold = "4s"
window = "1h"
slide = "1.5min"
validation_share = 0.4
tune_share = 0.25
confidence = 95
cycle = "20min"
members = 7
min_interval = "3h"
min_coverage = 0.75
order = [2, 6]
horizon = 12
max_mrse = 15
bias = "approve"
on_failure = "withdraw"
margin = 0
baseline_mrse = 16.4
approval = "by_hand"
[[spacecraft.equipment]]
name = "Y"
inputs = ["u"]
outputs = ["y"]
sample_period = "1ms"
window = "1min"
order = 3
horizon = "auto"
)");
  EXPECT_EQ(config.service_name, "second");
  EXPECT_EQ(config.log_level, "debug");
  EXPECT_EQ(config.workers, 4u);
  EXPECT_EQ(config.database, "/var/lib/archive.db");
  EXPECT_EQ(config.batch_frames, 100u);
  EXPECT_EQ(config.batch_delay, 250 * ms);
  EXPECT_EQ(config.recent_samples, 50000u);
  EXPECT_EQ(config.durability, storage::Durability::kill);
  EXPECT_EQ(config.domain, 42u);
  EXPECT_EQ(config.partition, "training");
  EXPECT_EQ(config.queue_frames, 64u);
  EXPECT_EQ(config.queue_mib, 3u);
  EXPECT_EQ(config.max_frame_samples, 1000u);
  EXPECT_EQ(config.max_clock_lead, 10 * s);
  EXPECT_EQ(config.settle, 300 * ms);
  ASSERT_THAT(config.spacecraft, SizeIs(1));
  ASSERT_THAT(config.spacecraft[0].equipment, SizeIs(2));
  const EquipmentConfig& x = config.spacecraft[0].equipment[0];
  EXPECT_THAT(x.outputs, ElementsAre("y", "z"));
  EXPECT_EQ(x.sample_period, 500 * ms);
  EXPECT_EQ(x.sample_hold, 4 * s);
  EXPECT_EQ(x.window, 60 * min);
  EXPECT_EQ(x.slide, 90 * s);
  EXPECT_EQ(x.validation_share, 0.4);
  EXPECT_EQ(x.tune_share, 0.25);
  EXPECT_EQ(x.confidence_percent, 95);
  EXPECT_EQ(x.cycle, 20 * min);
  EXPECT_EQ(x.members, 7);
  EXPECT_EQ(x.min_interval, 180 * min);
  EXPECT_EQ(x.min_coverage, 0.75);
  EXPECT_EQ(x.min_order, 2);
  EXPECT_EQ(x.max_order, 6);
  EXPECT_EQ(x.horizon, 12);
  EXPECT_EQ(x.max_mrse_percent, 15);
  EXPECT_EQ(x.bias, BiasPolicy::approve);
  EXPECT_EQ(x.on_failure, FailurePolicy::withdraw);
  EXPECT_EQ(x.margin_percent, 0);
  EXPECT_EQ(x.baseline_mrse_percent, 16.4);
  EXPECT_EQ(x.approval, ApprovalPolicy::by_hand);
  const EquipmentConfig& y = config.spacecraft[0].equipment[1];
  EXPECT_EQ(y.sample_period, ms);
  EXPECT_EQ(y.min_order, 3);
  EXPECT_EQ(y.max_order, 3);
  EXPECT_EQ(y.horizon, std::nullopt);
}

TEST(Config, AllMistakesAreReportedAtOnceByLine) {
  EXPECT_THAT(mistakes_of("[service]\n"
                          "name = no quotes\n"
                          "workers = 0\n"
                          "lgo_level = \"info\"\n"
                          "[[spacecraft]]\n"
                          "name = \"A\"\n"
                          "[[spacecraft.equipment]]\n"
                          "name = \"X\"\n"
                          "inputs = [\"a\", \"b\"\n"
                          "outputs = [\"c\"]\n"
                          "window = 5\n"
                          "horizon = \n"
                          "margin = 101\n"),
              ElementsAre(StartsWith("2: mistake in value"), StartsWith("3: [service] workers"),
                          StartsWith("4: [service] lgo_level"), StartsWith("9: mistake in array"),
                          StartsWith("11: equipment X: window"),
                          StartsWith("12: mistake in key-value pair"),
                          StartsWith("13: equipment X: margin")))
      << "what a line with a syntax mistake hides is not reported as missing";
}

TEST(Config, AnInputMayFollowFromParameters) {
  const EquipmentConfig bdr = config_of(with_derived(0, "")).spacecraft.at(0).equipment.at(0);
  EXPECT_THAT(bdr.inputs, ElementsAre("I_BDRIN1", "P"));
  EXPECT_THAT(bdr.derived, ElementsAre(DerivedInput{"P", "U * I_BDRIN1", "W"}));
}

TEST(Config, RegimesAreFurtherInputs) {
  const EquipmentConfig equipment =
      config_of(with(5, "inputs = [\"I_BDRIN1\"]\nregimes = [\"ECL\", \"U < 2\"]"))
          .spacecraft.at(0)
          .equipment.at(0);
  EXPECT_THAT(equipment.inputs, ElementsAre("I_BDRIN1", "in ECL", "I_BDRIN1 in ECL", "in U < 2",
                                            "I_BDRIN1 in U < 2"));
  EXPECT_EQ(equipment.derived.size(), 4U);
  EXPECT_EQ(equipment.regime_inputs, 4);
}

TEST(Config, VersionsAreAQuarterOfTheSlideApart) {
  const EquipmentConfig bdr =
      config_of(minimal + "slide = \"40min\"").spacecraft.at(0).equipment.at(0);
  EXPECT_EQ(bdr.min_interval, 10 * min);
}

TEST(Config, TheCycleIsTheValidationPart) {
  const EquipmentConfig bdr = config_of(minimal).spacecraft.at(0).equipment.at(0);
  EXPECT_EQ(bdr.cycle, 30 * min);
}

TEST(Config, AWindowThatJustHoldsEnoughIsAccepted) {
  EXPECT_THAT(mistakes_of(with(8, "window = \"176s\"")), IsEmpty());
  EXPECT_THAT(mistakes_of(with(8, "window = \"175s\"")), SizeIs(1));
}

TEST(Config, TheDigestIsTheSha256OfTheBytes) {
  // sha256sum of a file with the minimal text
  EXPECT_EQ(config_of(minimal).digest,
            "ce1f6adf0d7625d098c9be893d877aad413eba1f0730441e39546080814dcdbd");
  EXPECT_NE(config_of(minimal).digest, config_of(minimal + "# a comment\n").digest);
}

class ConfigFile : public ::testing::Test {
 protected:
  std::vector<ConfigMistake> mistakes(const std::filesystem::path& path) {
    auto loaded = load_config(path);
    return std::holds_alternative<Config>(loaded)
               ? std::vector<ConfigMistake>()
               : std::get<std::vector<ConfigMistake>>(std::move(loaded));
  }

  const test::TemporaryFolder folder;
};

TEST_F(ConfigFile, ARelativeDatabaseStandsBesideTheFile) {
  std::ofstream(folder / "a.toml") << "[archive]\ndatabase = \"data/x.db\"\n" << minimal;
  const auto loaded = load_config(folder / "a.toml");
  ASSERT_TRUE(std::holds_alternative<Config>(loaded));
  EXPECT_EQ(std::get<Config>(loaded).database, folder / "data/x.db");
}

TEST_F(ConfigFile, AMissingFileAFolderAndAHugeFileAreRefused) {
  ASSERT_THAT(mistakes(folder / "none.toml"), SizeIs(1));
  EXPECT_THAT(mistakes(folder / "none.toml")[0].message, HasSubstr("No such file"));
  ASSERT_THAT(mistakes(folder.path()), SizeIs(1));
  EXPECT_THAT(mistakes(folder.path())[0].message, HasSubstr("folder"));
  std::ofstream(folder / "huge.toml") << std::string(5u << 20, '#');
  ASSERT_THAT(mistakes(folder / "huge.toml"), SizeIs(1));
  EXPECT_THAT(mistakes(folder / "huge.toml")[0].message, HasSubstr("larger than 4 MiB"));
}

TEST(ConfigExamples, AreCompleteAndRight) {
  const auto cbers = load_config(REIDENT_EXAMPLES "/reident.toml");
  ASSERT_TRUE(std::holds_alternative<Config>(cbers));
  const SpacecraftConfig& spacecraft = std::get<Config>(cbers).spacecraft.at(0);
  ASSERT_THAT(spacecraft.equipment, SizeIs(3));
  EXPECT_THAT(spacecraft.equipment[1].inputs,
              ElementsAre("I_BAT1", "I_SAG1A", "I_SGBCHC", "V_BUS"));
  const auto bupt = load_config(REIDENT_EXAMPLES "/bupt1.toml");
  ASSERT_TRUE(std::holds_alternative<Config>(bupt));
  EXPECT_THAT(std::get<Config>(bupt).spacecraft.at(0).equipment, SizeIs(2));
  const auto reference = load_config(REIDENT_EXAMPLES "/reference.toml");
  ASSERT_TRUE(std::holds_alternative<Config>(reference));
  EXPECT_THAT(std::get<Config>(reference).spacecraft.at(0).equipment, SizeIs(9));
  const auto platform = load_config(REIDENT_EXAMPLES "/reference-platform.toml");
  ASSERT_TRUE(std::holds_alternative<Config>(platform));
  EXPECT_THAT(std::get<Config>(platform).spacecraft.at(0).equipment, SizeIs(11));
}

}  // namespace
}  // namespace reident::config_test
