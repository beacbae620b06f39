#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/service/config/config_text.hpp"

namespace reident::config_relations_test {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;
using ::testing::StartsWith;

/// The minimal file with a relation, one line of which is another.
std::string with_relation(std::size_t line, const std::string& text) {
  const std::vector<std::string> table = {"[[spacecraft.relation]]", "name = \"sum\"",
                                          "expression = \"I_BDROUT + I_SG2 - I_BUS\"",
                                          "tolerance = 0.5"};
  std::string result = minimal;
  for (std::size_t i = 0; i < table.size(); ++i) result += (9 + i == line ? text : table[i]) + "\n";
  return result;
}

const Mistake relation[] = {
    {"no_name", with_relation(10, ""), "9: [[spacecraft.relation]] name is missing"},
    {"no_expression", with_relation(11, ""), "9: relation sum: expression is missing"},
    {"no_tolerance", with_relation(12, ""),
     "9: relation sum: tolerance is missing; add a line such as tolerance = 0.5"},
    {"no_tolerance_at_all", with_relation(12, "tolerance = 0"),
     "12: relation sum: tolerance must be a number from 1e-12"},
    {"tolerance_in_quotes", with_relation(12, "tolerance = \"0.5\""),
     "12: relation sum: tolerance must be a number"},
    {"unknown_key", with_relation(12, "tolerance = 0.5\nunit = \"A\""),
     "13: relation sum: unit is not known"},
    {"syntax", with_relation(11, "expression = \"I_BUS -\""),
     "11: relation sum: expression at byte"},
    {"constant", with_relation(11, "expression = \"1 - 1\""),
     "11: relation sum: expression uses no parameter"},
    {"name_twice", with_relation(0, "") + with_relation(0, "").substr(minimal.size()),
     "14: [[spacecraft.relation]] name sum is taken by a relation above"},
};

class RelationMistakes : public ::testing::TestWithParam<Mistake> {};

TEST_P(RelationMistakes, AreReportedOnceWithTheirLine) {
  const std::vector<std::string> found = mistakes_of(GetParam().text);
  ASSERT_THAT(found, SizeIs(1)) << ::testing::PrintToString(found);
  EXPECT_THAT(found[0], StartsWith(GetParam().expected));
}

INSTANTIATE_TEST_SUITE_P(Relation, RelationMistakes, ::testing::ValuesIn(relation), name_of);

TEST(ConfigRelations, ApplyToTheEquipmentThatUsesOneOfTheirParameters) {
  const std::string other = R"(
[[spacecraft.equipment]]
name = "BAT"
inputs = ["P"]
outputs = ["V_BAT"]
sample_period = "1s"
window = "100min"
screening = "off"
bias = "approve"
[[spacecraft.equipment.derived]]
name = "P"
expression = "I_BAT * V_BUS"
unit = "W"
[[spacecraft.relation]]
name = "battery"
expression = "I_BAT - I_CHARGE"
tolerance = 1
)";
  const SpacecraftConfig spacecraft = config_of(with_relation(0, "") + other).spacecraft.at(0);
  const Relation sum{"sum", "I_BDROUT + I_SG2 - I_BUS", 0.5};
  const Relation battery{"battery", "I_BAT - I_CHARGE", 1};
  EXPECT_THAT(spacecraft.relations, ElementsAre(sum, battery));
  EXPECT_THAT(spacecraft.equipment.at(0).relations, ElementsAre(sum));
  EXPECT_THAT(spacecraft.equipment.at(1).relations, ElementsAre(battery));
  EXPECT_TRUE(spacecraft.equipment.at(0).screening);
  EXPECT_FALSE(spacecraft.equipment.at(1).screening);
  EXPECT_EQ(spacecraft.equipment.at(0).bias, BiasPolicy::wait);
  EXPECT_EQ(spacecraft.equipment.at(1).bias, BiasPolicy::approve);
}

}  // namespace
}  // namespace reident::config_relations_test
