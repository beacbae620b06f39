#include <gmock/gmock.h>

#include "tests/service/config/config_text.hpp"

namespace reident::config_mistakes_test {
namespace {

using ::testing::SizeIs;
using ::testing::StartsWith;

class ConfigMistakes : public ::testing::TestWithParam<Mistake> {};

TEST_P(ConfigMistakes, AreReportedOnceWithTheirLine) {
  const std::vector<std::string> found = mistakes_of(GetParam().text);
  ASSERT_THAT(found, SizeIs(1)) << ::testing::PrintToString(found);
  EXPECT_THAT(found[0], StartsWith(GetParam().expected));
}

const Mistake structure[] = {
    {"nothing", "", "0: there is no spacecraft; add [[spacecraft]]"},
    {"unknown_section", minimal + "[servce]\n",
     "9: the file: servce is not known; did you mean service?"},
    {"unknown_key", "[archive]\ndatabse = \"x.db\"\n" + minimal,
     "2: [archive] databse is not known; did you mean database?"},
    {"strange_key", "[dds]\nqqqqqqq = 1\n" + minimal,
     "2: [dds] qqqqqqq is not known; known here: cut, domain, partition, rate"},
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
    {"bad_window_beside_what_depends_on_it",
     with(8, "window = \"soon\"\ncycle = \"50min\"\nmin_interval = \"5min\"\nslide = \"5min\""),
     "8: equipment BDR: window must be a duration"},
    {"bad_period_beside_what_depends_on_it",
     with(7, "sample_period = \"soon\"\ncycle = \"50min\"\nmin_interval = \"5min\""),
     "7: equipment BDR: sample_period must be a duration"},
    {"bad_input_beside_regimes", with(5, "inputs = [\"\"]\nregimes = [\"SUN > 0\"]"),
     "5: equipment BDR: each name in inputs must not be empty"},
    {"long_slide", minimal + "slide = \"101min\"",
     "9: equipment BDR: slide 101min is longer than the window 100min"},
    {"odd_slide", minimal + "slide = \"1500ms\"",
     "9: equipment BDR: slide must be a multiple of sample_period 1s; 2s is"},
    {"slide_is_no_duration", minimal + "slide = \"soon\"",
     "9: equipment BDR: slide must be a duration"},
    {"short_hold", minimal + "hold = \"500ms\"",
     "9: equipment BDR: hold 500ms is shorter than sample_period 1s"},
    {"long_phase", minimal + "phase = \"1s\"",
     "9: equipment BDR: phase 1s must be below sample_period 1s"},
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
};

const Mistake of_service[] = {
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
    {"cut_without_rate", "[dds]\ncut = \"60s\"\n" + minimal,
     "2: [dds] cut and rate belong together"},
    {"rate_without_cut", "[dds]\nrate = \"100/s\"\n" + minimal,
     "2: [dds] cut and rate belong together"},
    {"rate_without_unit", "[dds]\ncut = \"60s\"\nrate = \"100\"\n" + minimal,
     "3: [dds] rate must be the frames that a source sends"},
    {"endless_cut", "[dds]\ncut = \"2d\"\nrate = \"100/s\"\n" + minimal,
     "2: [dds] cut must be a duration in quotes with its unit"},
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

const Mistake regimes[] = {
    {"no_expression", minimal + "regimes = [\"ECL >\"]",
     "9: equipment BDR: regime \"ECL >\" at byte 6: a number"},
    {"output", minimal + "regimes = [\"I_BDROUT > 1\"]",
     "9: equipment BDR: regime \"I_BDROUT > 1\" uses the output I_BDROUT"},
    {"twice", minimal + "regimes = [\"ECL\", \"ECL\"]",
     "9: equipment BDR: regimes names \"ECL\" twice"},
    {"no_list", minimal + "regimes = \"ECL\"", "9: equipment BDR: regimes"},
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
    {"header_without_a_name", minimal + "[\n", "9: mistake in key: expected bare key"},
    {"letter_outside_quotes_in_a_header", minimal + "[\u00e9quipement]\n",
     "9: mistake in key: expected bare key"},
    {"long_text_not_closed", minimal + "approval = \"\"\"automatic\n\n",
     "9: mistake in string: encountered end-of-file"},
    {"no_utf8", with(4, "name = \"\xff\""), "4: "},
};

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
INSTANTIATE_TEST_SUITE_P(OfService, ConfigMistakes, ::testing::ValuesIn(of_service), name_of);
INSTANTIATE_TEST_SUITE_P(Rule, ConfigMistakes, ::testing::ValuesIn(rule), name_of);
INSTANTIATE_TEST_SUITE_P(Derived, ConfigMistakes, ::testing::ValuesIn(derived), name_of);
INSTANTIATE_TEST_SUITE_P(Regimes, ConfigMistakes, ::testing::ValuesIn(regimes), name_of);
INSTANTIATE_TEST_SUITE_P(Syntax, ConfigMistakes, ::testing::ValuesIn(syntax), name_of);

}  // namespace
}  // namespace reident::config_mistakes_test
