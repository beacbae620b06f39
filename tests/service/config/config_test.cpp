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

class ConfigMistakes : public ::testing::TestWithParam<Mistake> {};

TEST_P(ConfigMistakes, AreReportedOnceWithTheirLine) {
  const std::vector<std::string> found = mistakes_of(GetParam().text);
  ASSERT_THAT(found, SizeIs(1)) << ::testing::PrintToString(found);
  EXPECT_THAT(found[0], StartsWith(GetParam().expected));
}

/// The minimal file with one line changed.
std::string with(int line, const std::string& replacement) {
  std::string text;
  std::string rest = minimal;
  for (int at = 1; !rest.empty(); ++at) {
    const std::size_t end = rest.find('\n') + 1;
    text += at == line ? replacement + "\n" : rest.substr(0, end);
    rest.erase(0, end);
  }
  return text;
}

const Mistake structure[] = {
    {"nothing", "", "0: there is no spacecraft; add [[spacecraft]]"},
    {"unknown_section", minimal + "[servce]\n",
     "9: the file: servce is not known; did you mean service?"},
    {"unknown_key", "[archive]\ndatabse = \"x.db\"\n" + minimal,
     "2: [archive] databse is not known; did you mean database?"},
    {"strange_key", "[dds]\nqqqqqqq = 1\n" + minimal,
     "2: [dds] qqqqqqq is not known; known here: domain, partition"},
    {"section_is_no_table", "service = 3\n" + minimal, "1: the file: service must be a table"},
    {"spacecraft_in_single_brackets", "[spacecraft]\nname = \"A\"\n",
     "1: the file: spacecraft must be tables in double brackets"},
    {"no_equipment", "[[spacecraft]]\nname = \"A\"\n",
     "1: spacecraft A: has no equipment; add [[spacecraft.equipment]]"},
    {"no_spacecraft_name", with(2, ""), "1: [[spacecraft]] name is missing; add a line such as"},
    {"no_name", with(4, ""), "3: [[spacecraft.equipment]] name is missing"},
    {"empty_name", with(4, "name = \"\""), "4: [[spacecraft.equipment]] name must not be empty"},
    {"slash_in_a_name", with(4, "name = \"A/B\""),
     "4: [[spacecraft.equipment]] name must not hold / or @"},
    {"long_name", with(4, "name = \"" + std::string(129, 'x') + "\""),
     "4: [[spacecraft.equipment]] name must have at most 128 bytes, not 129"},
    {"no_inputs", with(5, ""), "3: equipment BDR: inputs is missing"},
    {"empty_inputs", with(5, "inputs = []"),
     "5: equipment BDR: inputs must be a list of at least one text"},
    {"inputs_is_a_text", with(5, "inputs = \"I\""), "5: equipment BDR: inputs must be a list"},
    {"inputs_of_numbers", with(5, "inputs = [1]"), "5: equipment BDR: inputs must be a list"},
    {"blank_input", with(5, "inputs = [\" I\"]"),
     "5: equipment BDR: each name in inputs must not begin or end with a blank"},
    {"input_twice", with(5, "inputs = [\"I\", \"I\"]"), "5: equipment BDR: inputs names I twice"},
    {"no_outputs", with(6, ""), "3: equipment BDR: outputs is missing"},
    {"output_is_input", with(6, "outputs = [\"I_BDRIN2\"]"),
     "6: equipment BDR: output I_BDRIN2 is also an input"},
    {"equipment_twice", minimal + minimal.substr(minimal.find("[[spacecraft.equipment]]")),
     "10: [[spacecraft.equipment]] name BDR is taken"},
    {"spacecraft_twice", minimal + minimal, "10: [[spacecraft]] name CBERS-4 is taken"},
};

const Mistake values[] = {
    {"no_sample_period", with(7, ""), "3: equipment BDR: sample_period is missing"},
    {"period_is_a_number", with(7, "sample_period = 1"),
     "7: equipment BDR: sample_period must be a duration in quotes with its unit"},
    {"period_without_unit", with(7, "sample_period = \"1\""),
     "7: equipment BDR: sample_period must be a duration in quotes with its unit (ns, us, ms, s, "
     "min, h, d), from \"1ms\" to \"1d\", not the text \"1\""},
    {"period_too_short", with(7, "sample_period = \"1us\""),
     "7: equipment BDR: sample_period must be a duration"},
    {"negative_window", with(8, "window = \"-1h\""), "8: equipment BDR: window must be a duration"},
    {"endless_window", with(8, "window = \"99999999999999999999d\""),
     "8: equipment BDR: window must be a duration"},
    {"no_window", with(8, ""), "3: equipment BDR: window is missing"},
    {"short_window", with(8, "window = \"10s\""),
     "8: equipment BDR: window 10s holds 10 samples of 1s; orders up to 10 with 2 inputs and 1 "
     "outputs need 176: make it at least 176s or lower the order"},
    {"short_window_for_the_horizon", with(8, "window = \"3min\"\nhorizon = 50"),
     "8: equipment BDR: window 3min holds 180 samples of 1s; orders up to 10 with 2 inputs and 1 "
     "outputs need 800: make it at least 800s"},
    {"window_below_period", with(8, "window = \"1s\"\nhold = \"1min\"") + "",
     "8: equipment BDR: window 1s holds 1 samples"},
    {"huge_window", with(8, "window = \"3650d\"\nslide = \"1d\""),
     "8: equipment BDR: window 3650d holds 315360000 samples of 1s; at most"},
    {"odd_window", with(8, "window = \"6000500ms\""),
     "8: equipment BDR: window must be a multiple of sample_period 1s; 100min is"},
    {"long_slide", minimal + "slide = \"101min\"",
     "9: equipment BDR: slide 101min is longer than the window 100min"},
    {"odd_slide", minimal + "slide = \"1500ms\"",
     "9: equipment BDR: slide must be a multiple of sample_period 1s; 2s is"},
    {"slide_is_no_duration", minimal + "slide = \"soon\"",
     "9: equipment BDR: slide must be a duration"},
    {"short_hold", minimal + "hold = \"500ms\"",
     "9: equipment BDR: hold 500ms is shorter than sample_period 1s"},
    {"shares_that_leave_nothing", minimal + "validation_share = 0.6\ntune_share = 0.35",
     "10: equipment BDR: tune_share 0.35 and validation_share 0.6 leave less than a tenth of the "
     "window to identify from; make their sum at most 0.9"},
    {"certainty", minimal + "confidence = 100",
     "9: equipment BDR: confidence must be a number from 50 to 99.99, not the number 100"},
    {"interval_without_a_unit", minimal + "min_interval = 50",
     "9: equipment BDR: min_interval must be a duration"},
    {"small_share", minimal + "validation_share = 0.01",
     "9: equipment BDR: validation_share must be a number from 0.05 to 0.8, not the number 0.01"},
    {"large_share", minimal + "validation_share = 1",
     "9: equipment BDR: validation_share must be a number from 0.05 to 0.8, not the number 1"},
    {"share_is_nan", minimal + "validation_share = nan",
     "9: equipment BDR: validation_share must be a number"},
    {"coverage_above_one", minimal + "min_coverage = 50",
     "9: equipment BDR: min_coverage must be a number from 0 to 1"},
    {"order_zero", minimal + "order = 0",
     "9: equipment BDR: order must be \"auto\" or a whole number from 1 to 100, not the number 0"},
    {"order_reversed", minimal + "order = [5, 2]", "9: equipment BDR: order must be [least, most]"},
    {"order_of_texts", minimal + "order = [\"a\"]",
     "9: equipment BDR: order must be [least, most]"},
    {"order_misspelt", minimal + "order = \"automatic\"",
     "9: equipment BDR: order must be \"auto\" or a whole number"},
    {"short_horizon", minimal + "horizon = 5",
     "9: equipment BDR: horizon 5 is too short for orders up to 10; make it at least 11"},
    {"short_horizon_for_three_outputs", with(6, "outputs = [\"a\", \"b\", \"c\"]\nhorizon = 4"),
     "7: equipment BDR: horizon 4 is too short for orders up to 10; make it at least 5"},
    {"standby", "[service]\nstandby = true\n" + minimal,
     "2: [service] a pair of services needs a strength each: strength = 2 for the one that leads "
     "when both start, and 1 for the other"},
    {"standby_type", "[service]\nstandby = \"yes\"\n" + minimal,
     "2: [service] standby must be true or false, not the text \"yes\""},
    {"strength", "[service]\nstrength = 1\n" + minimal,
     "2: [service] strength counts in a pair alone: add standby = true, or remove it"},
    {"log_level", "[service]\nlog_level = \"loud\"\n" + minimal,
     "2: [service] log_level must be one of \"debug\", \"info\", \"warning\", \"error\""},
    {"durability", "[archive]\ndurability = \"full\"\n" + minimal,
     "2: [archive] durability must be one of \"power_cut\", \"kill\", not \"full\""},
    {"no_worker", "[service]\nworkers = 0\n" + minimal,
     "2: [service] workers must be a whole number from 1 to 256, not the number 0"},
    {"half_a_worker", "[service]\nworkers = 0.5\n" + minimal,
     "2: [service] workers must be a whole number"},
    {"empty_database", "[archive]\ndatabase = \"\"\n" + minimal,
     "2: [archive] database must be the path of a file"},
    {"keep_without_unit", "[archive]\nkeep = \"400\"\n" + minimal,
     "2: [archive] keep must be a duration in quotes with its unit"},
    {"keep_shorter_than_a_window", "[archive]\nkeep = \"2h\"\n" + minimal,
     "2: [archive] keep 2h is shorter than window and slide of CBERS-4/BDR; make it at least "
     "130min"},
    {"max_size_without_unit", "[archive]\nmax_size = 200\n" + minimal,
     "2: [archive] max_size must be a size in quotes with its unit"},
    {"max_size_too_small", "[archive]\nmax_size = \"1 kB\"\n" + minimal,
     "2: [archive] max_size must be a size in quotes with its unit (B, kB, MB, GB, TB, KiB, MiB, "
     "GiB, TiB), at least \"1 MB\""},
    {"database_is_a_number", "[archive]\ndatabase = 1\n" + minimal,
     "2: [archive] database must be a text in double quotes, not the number 1"},
    {"wild_partition", "[dds]\npartition = \"*\"\n" + minimal,
     "2: [dds] partition must be one name"},
    {"empty_partition", "[dds]\npartition = \"\"\n" + minimal,
     "2: [dds] partition must not be empty"},
    {"large_domain", "[dds]\ndomain = 231\n" + minimal,
     "2: [dds] domain must be a whole number from 0 to 230, not the number 231"},
};

const Mistake rule[] = {
    {"former_fit", minimal + "min_fit = 5",
     "9: equipment BDR: min_fit is no key any more: remove it"},
    {"former_disagreement", minimal + "max_disagreement = 5",
     "9: equipment BDR: max_disagreement is no key any more: remove it"},
    {"former_confirmation", minimal + "confirmation = \"1h\"",
     "9: equipment BDR: confirmation is no key any more: remove it"},
    {"former_unvouched", minimal + "unvouched = \"wait\"",
     "9: equipment BDR: unvouched is no key any more: use bias, with the same values"},
    {"no_members", minimal + "members = 0",
     "9: equipment BDR: members must be a whole number from 1 to 100"},
    {"unknown_bias", minimal + "bias = \"believe\"", "9: equipment BDR: bias must be"},
    {"unknown_failure", minimal + "on_failure = \"panic\"", "9: equipment BDR: on_failure must be"},
    {"unknown_approval", minimal + "approval = \"by hand\"",
     "9: equipment BDR: approval must be one of \"automatic\", \"by_hand\", not \"by hand\""},
};

const Mistake syntax[] = {
    {"no_quotes", with(4, "name = BDR"),
     "4: mistake in value: a text or a duration needs double quotes"},
    {"duration_without_quotes", with(8, "window = 10min"),
     "8: mistake in value: a text or a duration needs double quotes"},
    {"key_twice", minimal + "window = \"2h\"", "9: mistake in key-value pair: cannot redefine"},
    {"list_not_closed", with(5, "inputs = [\"a\",\n \"b\""),
     "5: mistake in array: expected comma or closing ']', saw 'o' (noticed on line 7)"},
    {"list_not_closed_at_the_end", minimal + "order = [1,\n2\n\n",
     "9: mistake in array: encountered end-of-file"},
    {"text_not_closed", with(4, "name = \"BDR"), "4: mistake in string"},
    {"long_text_not_closed", minimal + "approval = \"\"\"automatic\n\n",
     "9: mistake in string: encountered end-of-file"},
    {"no_utf8", with(4, "name = \"\xff\""), "4: "},
};

/// With P = U * I_BDRIN1 as a second input on lines 5 and 9 to 12, line `line` replaced.
std::string with_derived(std::size_t line, const std::string& text) {
  const std::vector<std::string> table = {"[[spacecraft.equipment.derived]]", "name = \"P\"",
                                          "expression = \"U * I_BDRIN1\"", "unit = \"W\""};
  std::string result = with(5, "inputs = [\"I_BDRIN1\", \"P\"]");
  for (std::size_t i = 0; i < table.size(); ++i) result += (9 + i == line ? text : table[i]) + "\n";
  return result;
}

const Mistake derived[] = {
    {"no_name", with_derived(10, ""), "9: equipment BDR: derived input: name is missing"},
    {"no_expression", with_derived(11, ""),
     "9: equipment BDR: derived input P: expression is missing; add a line such as expression = "},
    {"no_unit", with_derived(12, ""), "9: equipment BDR: derived input P: unit is missing"},
    {"no_text", with_derived(11, "expression = 3"),
     "11: equipment BDR: derived input P: expression"},
    {"unknown_key", with_derived(12, "unit = \"W\"\nlimit = 3"),
     "13: equipment BDR: derived input P: limit is not known"},
    {"syntax", with_derived(11, "expression = \"U *\""),
     "11: equipment BDR: derived input P: expression at byte 4: a number"},
    {"constant", with_derived(11, "expression = \"2\""),
     "11: equipment BDR: derived input P: expression uses no parameter"},
    {"output", with_derived(11, "expression = \"U * I_BDROUT\""),
     "11: equipment BDR: derived input P: expression uses the output I_BDROUT; a model cannot"},
    {"in_itself", with_derived(11, "expression = \"P * 2\""),
     "11: equipment BDR: derived input P: expression uses its own name P"},
    {"unused", with_derived(10, "name = \"Q\""),
     "10: equipment BDR: derived input Q: name Q is not used; add it to the inputs"},
    {"no_table", minimal + "derived = 3", "9: equipment BDR: derived must be tables in double"},
};

INSTANTIATE_TEST_SUITE_P(Structure, ConfigMistakes, ::testing::ValuesIn(structure), name_of);
INSTANTIATE_TEST_SUITE_P(Values, ConfigMistakes, ::testing::ValuesIn(values), name_of);
INSTANTIATE_TEST_SUITE_P(Rule, ConfigMistakes, ::testing::ValuesIn(rule), name_of);
INSTANTIATE_TEST_SUITE_P(Derived, ConfigMistakes, ::testing::ValuesIn(derived), name_of);
INSTANTIATE_TEST_SUITE_P(Syntax, ConfigMistakes, ::testing::ValuesIn(syntax), name_of);

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
