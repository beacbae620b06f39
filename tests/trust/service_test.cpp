// The suite's fast part: some short scenarios through the real service.

#include <algorithm>

#include <gmock/gmock.h>

#include "service/support/log.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/trust/outcome_folder.hpp"
#include "tests/trust/picture.hpp"
#include "tests/trust/report.hpp"
#include "tests/trust/suite_config.hpp"

namespace reident::trust::service_test {
namespace {

using satcs::FaultKind;
using satcs::reference::LifeKind;

constexpr Duration hour = 3'600'000'000'000;
constexpr storage::Time start = 1'498'867'200'000'000'000;  // 2017-07-01T00:00:00Z

LifeGroup group_of(std::string equipment, int hours) {
  LifeGroup group;
  group.seed = 1000;
  group.equipment = {std::move(equipment)};
  group.start = start;
  group.duration = hours * hour;
  return group;
}

std::vector<ScenarioOutcome> run(const LifeGroup& group) {
  log::set_level("error");  // drift is a warning, and expected
  const test::TemporaryFolder folder;
  return run_group(group, suite_config(), folder.path());
}

TEST(Trust, AFailedCellIsFollowed) {
  LifeGroup group = group_of("BAT1", 110);
  const storage::Time change = start + 50 * hour;
  group.life = "failed_cell";
  group.events = {{LifeKind::failed_cell, change, change, 2, 1}};
  group.scenarios = {{1, "none", {}}};
  const ScenarioOutcome outcome = run(group).front();
  const Figures figures = figures_of({&outcome});
  EXPECT_EQ(figures.changes, 1) << story(outcome);
  EXPECT_EQ(figures.recovered, 1) << story(outcome);
  EXPECT_GE(figures.versions, 2) << story(outcome);

  // As a run that was interrupted finds it again.
  const test::TemporaryFolder folder;
  OutcomeFolder(folder.path(), 7).keep(outcome);
  const OutcomeFolder kept(folder.path(), 7);
  const auto found = kept.find(group, group.scenarios.front());
  ASSERT_TRUE(found);
  EXPECT_EQ(story(*found), story(outcome));
  EXPECT_EQ(picture(*found), picture(outcome));
  EXPECT_FALSE(kept.find(group, {2, "none", {}}));
  const auto refused = [&](const OutcomeFolder& by) {
    EXPECT_THROW(by.find(group, group.scenarios.front()), std::runtime_error);
  };
  refused(OutcomeFolder(folder.path(), 8));
  refused(OutcomeFolder(folder.path(), 7, "margin = 5"));
  std::filesystem::resize_file(folder.path() / "1.cbor", 100);
  refused(kept);
}

TEST(Trust, ABiasedSensorIsNotFollowed) {
  LifeGroup group = group_of("BDR", 70);
  group.scenarios = {
      {1,
       "bias_step",
       {{FaultKind::bias_step, {start + 30 * hour, start + 60 * hour}, "I_BDROUT", {}, 0.8, 1}}}};
  const ScenarioOutcome outcome = run(group).front();
  const auto& attempts = outcome.equipment.front().attempts;
  EXPECT_TRUE(std::any_of(attempts.begin(), attempts.end(), [](const Attempted& attempt) {
    return attempt.outcome == "implausible";
  })) << story(outcome);
  const Figures figures = figures_of({&outcome});
  EXPECT_GE(figures.versions, 1) << story(outcome);
  EXPECT_EQ(figures.wrong, 0) << story(outcome);
}

TEST(Trust, AConverterIsNotTakenForUnstable) {
  // Its output tells the load more exactly than its inputs do, so that these seem to follow it.
  LifeGroup group = group_of("BDR", 110);
  group.scenarios = {{1, "none", {}}};
  const auto attempts = run(group).front().equipment.front().attempts;
  EXPECT_GE(attempts.size(), 15U);
  for (const Attempted& attempt : attempts)
    EXPECT_FALSE(attempt.outcome == "closed_loop" &&
                 attempt.reason.find("unstable") != std::string::npos)
        << attempt.reason;
}

TEST(Trust, AQuietSpacecraftGetsAModelAndTheSameOneEachTime) {
  LifeGroup group = group_of("BDR", 30);
  group.scenarios = {{1, "none", {}}, {2, "none", {}}};
  const auto outcomes = run(group);
  const auto& one = outcomes[0].equipment[0];
  const auto& two = outcomes[1].equipment[0];
  EXPECT_GE(one.publications.size(), 1U) << story(outcomes[0]);
  ASSERT_EQ(one.publications.size(), two.publications.size());
  for (std::size_t i = 0; i < one.publications.size(); ++i) {
    EXPECT_EQ(one.publications[i].time, two.publications[i].time);
    EXPECT_EQ(one.publications[i].mrse_percent, two.publications[i].mrse_percent);
    EXPECT_FALSE(one.publications[i].wrong());
  }
}

}  // namespace
}  // namespace reident::trust::service_test
