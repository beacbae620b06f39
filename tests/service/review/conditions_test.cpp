#include "service/review/conditions.hpp"

#include <gmock/gmock.h>

namespace reident {
namespace {

TEST(Conditions, AQuestionThatWasNotAskedShowsNoFigure) {
  Finding finding;
  finding.log_threshold = 4;
  EquipmentConfig limits;
  const auto bias = [&](std::string_view obstacle) {
    return conditions_of(finding, obstacle, limits).at(5);
  };
  EXPECT_EQ(bias("").holds, true);
  EXPECT_EQ(bias("").found, "not asked: relations bind the sensors, or it ran before");
  EXPECT_EQ(bias("bias_unverified").found, "0.00");
  finding.wealth_without_offset = 7.5;
  finding.mrse_without_offset = 2.5;
  EXPECT_EQ(bias("").found, "7.50; champion's MRSE 2.5 %");
  EXPECT_EQ(bias("not_better").holds, std::nullopt);
}

TEST(Conditions, AVersionWithoutACommonBlockShowsNoFigure) {
  const auto conditions = conditions_of(Finding(), "not_compared", EquipmentConfig());
  EXPECT_EQ(conditions.at(0).found, "no block yet");
  EXPECT_EQ(conditions.at(0).holds, false);
  EXPECT_EQ(conditions.at(1).holds, std::nullopt);
}

TEST(Conditions, AVersionThatAskedAnOperatorLeavesAFullLeagueWithThatQuestionOpen) {
  Finding finding;
  finding.log_threshold = 4;
  finding.log_wealth = 8;
  finding.champion_mrse_percent = 10;
  finding.mrse_percent = 1;
  finding.wealth_without_offset = 6;
  const auto bias = [&](double mrse_without_offset) {
    finding.mrse_without_offset = mrse_without_offset;
    return conditions_of(finding, "league_full", EquipmentConfig()).at(5);
  };
  EXPECT_EQ(bias(0.5).holds, false);
  EXPECT_EQ(bias(0.5).found, "6.00; champion's MRSE 0.5 %");
  EXPECT_EQ(bias(9).holds, true) << "no offset explains that";
  EXPECT_EQ(bias(0).holds, true) << "it was not asked";
}

TEST(Conditions, ErrorsOverTheRegimesAreShownWhereTheyAreKnown) {
  Finding finding;
  const EquipmentConfig limits;
  const auto found = [&] {
    return conditions_of(finding, "worse_over_regimes", limits).at(4).found;
  };
  EXPECT_EQ(found(), "");
  finding.over_regimes_mrse_percent = {2.5, 1.25};
  EXPECT_EQ(found(), "2.5 % against 1.25 %");
  finding.before_change_mrse_percent = {3, 1.5};
  EXPECT_EQ(found(), "2.5 % against 1.25 %; before the change 3 %, explained by it 1.5 %");
  finding.changed = 1'510'444'800'000'000'000;
  EXPECT_THAT(
      found(),
      testing::StartsWith("2.5 % against 1.25 % since the change of 2017-11-12T00:00:00Z; before"));
}

}  // namespace
}  // namespace reident
