#include "service/cli/output/simulator_list.hpp"

#include <gmock/gmock.h>

namespace reident::cli::simulator_list_test {
namespace {

constexpr storage::Time second = 1'000'000'000;

/// A simulator of SAT/BDR that runs `version`.
ModelAcknowledgement running(const std::string& simulator, std::int64_t version) {
  ModelAcknowledgement said;
  said.simulator = simulator;
  said.spacecraft = "SAT";
  said.equipment = "BDR";
  said.version = said.running.version = version;
  said.digest = "aa";
  said.running.mode = "free";
  said.running.decided = 60 * second;
  return said;
}

SimulatorRow row(const ModelAcknowledgement& said, std::optional<PublishedVersion> champion,
                 std::size_t services = 1) {
  PartitionSurvey sight{{said}, {}, services};
  if (champion) sight.champions[{"SAT", "BDR"}] = *champion;
  return list_simulators(sight, {}).at(0);
}

const PublishedVersion champion{7, 3600 * second + 5, "aa"};

TEST(SimulatorState, IsThatOfTheRunningVersionBesideTheChampion) {
  struct Case {
    std::int64_t version;
    std::optional<PublishedVersion> champion;
    std::size_t services;
    const char* state;
    const char* text;
    bool is_old;
  };
  const PublishedVersion rival{7, 0, "bb"};
  for (const Case& one :
       {Case{7, champion, 1, "current", "current", false},
        {6, champion, 1, "old", "old by 1 version: 7 is out since 1970-01-01T01:00:00Z", true},
        {5, champion, 1, "old", "old by 2 versions: 7 is out since 1970-01-01T01:00:00Z", true},
        {9, champion, 1, "rolled_back",
         "newer than the champion: 7 is out since 1970-01-01T01:00:00Z", true},
        {7, rival, 2, "different",
         "another content than the champion's; do two services publish it?", true},
        {7, std::nullopt, 1, "unpublished", "no champion: what runs is no longer published", true},
        {7, std::nullopt, 0, "unknown", "champion not known", false},
        {0, champion, 1, "not_running", "not running", false}}) {
    const SimulatorRow found = row(running("a", one.version), one.champion, one.services);
    EXPECT_STREQ(name(found.state), one.state);
    EXPECT_EQ(found.text(), one.text);
    EXPECT_EQ(found.is_old(), one.is_old) << one.state;
  }
}

TEST(SimulatorState, SaysWhatWasKeptOfferedAndRefused) {
  ModelAcknowledgement said = running("a", 6);
  said.running.from_cache = true;
  EXPECT_EQ(row(said, {}, 0).text(), "from file, approved 1970-01-01T00:01:00Z");
  EXPECT_STREQ(name(row(said, {}, 0).state), "from_file");
  said.running.offered_version = 7;
  EXPECT_EQ(row(said, champion).text(),
            "old by 1 version: 7 is out since 1970-01-01T01:00:00Z; from file, approved "
            "1970-01-01T00:01:00Z; offered 7: other signals");
  said = running("a", 6);
  said.accepted = false;
  said.version = 7;
  said.reason = "it is unstable";
  EXPECT_EQ(row(said, champion).text(),
            "old by 1 version: 7 is out since 1970-01-01T01:00:00Z; refused 7: it is unstable");
}

TEST(SimulatorState, TakesTheDigestOfARefusedVersionForNoOthers) {
  ModelAcknowledgement said = running("a", 7);
  said.accepted = false;
  said.digest = "bb";
  EXPECT_EQ(row(said, champion).state, SimulatorState::current);
}

TEST(SimulatorList, IsSortedAndSelectedByEquipment) {
  PartitionSurvey sight;
  for (const char* simulator : {"b", "a"})
    for (const char* equipment : {"MEA", "BDR"})
      for (const char* spacecraft : {"SAT", "OLD"}) {
        ModelAcknowledgement said = running(simulator, 1);
        said.spacecraft = spacecraft;
        said.equipment = equipment;
        sight.simulators.push_back(said);
      }
  const auto names = [&](const storage::EquipmentName& wanted) {
    std::vector<std::string> found;
    for (const SimulatorRow& one : list_simulators(sight, wanted))
      found.push_back(one.said.simulator + " " + one.said.spacecraft + "/" + one.said.equipment);
    return found;
  };
  EXPECT_THAT(names({}),
              ::testing::ElementsAre("a OLD/BDR", "a OLD/MEA", "a SAT/BDR", "a SAT/MEA",
                                     "b OLD/BDR", "b OLD/MEA", "b SAT/BDR", "b SAT/MEA"));
  EXPECT_THAT(names({"", "BDR"}),
              ::testing::ElementsAre("a OLD/BDR", "a SAT/BDR", "b OLD/BDR", "b SAT/BDR"));
  EXPECT_THAT(names({"SAT", "BDR"}), ::testing::ElementsAre("a SAT/BDR", "b SAT/BDR"));
  sight.services = 1;
  sight.spacecraft = {"SAT"};
  EXPECT_THAT(names({"", "BDR"}), ::testing::ElementsAre("a SAT/BDR", "b SAT/BDR"))
      << "OLD is of another partition";
}

}  // namespace
}  // namespace reident::cli::simulator_list_test
