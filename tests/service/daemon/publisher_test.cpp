// What is published is what was decided last, and nothing where nothing is left.
#include "service/daemon/publisher.hpp"

#include <mutex>

#include <gmock/gmock.h>

#include "tests/service/daemon_fixture.hpp"
#include "tests/service/dds/dds_fixture.hpp"
#include "tests/service/model/example_model.hpp"

namespace reident::test::publisher_test {
namespace {

using storage::DecisionKind;
using enum DecisionKind;

class PublisherTest : public DaemonTest {
 protected:
  const storage::EquipmentName bdr_{"CBERS4", "BDR"};
  storage::Database database_ = open();
  storage::Registry registry_{database_};
  dds::Participant service_{own_endpoint()};
  dds::Participant simulator_{own_endpoint()};
  Publisher publisher_{service_};

  std::int64_t version(DecisionKind kind) {
    storage::NewAttempt attempt;
    attempt.spacecraft = bdr_.spacecraft;
    attempt.equipment = bdr_.equipment;
    const EquipmentModel model = example_model();
    return registry_.record(attempt, {to_json(model).dump(), model_digest(model)},
                            {kind, "gate", ""});
  }
  void decide(std::int64_t version, DecisionKind kind) {
    registry_.decide(bdr_.spacecraft, bdr_.equipment, version, {kind, "Ana", ""}, 5);
  }
  /// The number of the next version that the reader gets.
  static std::int64_t next(dds::Reader<ModelVersion>& reader) {
    return take_all(reader, 1).at(0).number;
  }
};

TEST_F(PublisherTest, AChampionIsPublishedOnceWithWhoDecided) {
  dds::Reader<ModelVersion> reader(simulator_);
  version(approve);
  EXPECT_EQ(publisher_.publish_champions(registry_), 1U);
  EXPECT_EQ(next(reader), 1);
  EXPECT_TRUE(publisher_.publish_champion(registry_, bdr_));
  version(wait);
  decide(2, approve);
  EXPECT_TRUE(publisher_.publish_champion(registry_, bdr_));
  const ModelVersion second = take_all(reader, 1).at(0);
  EXPECT_EQ(second.number, 2) << "the first did not come twice";
  EXPECT_EQ(second.decided_by, "Ana");
  EXPECT_EQ(second.decided, 5);
}

TEST_F(PublisherTest, AnOlderVersionOnPurposeSaysSo) {
  dds::Reader<ModelVersion> reader(simulator_);
  const auto published = [&] {
    publisher_.publish_champion(registry_, bdr_);
    return take_all(reader, 1).at(0);
  };
  version(approve);
  version(wait);
  EXPECT_FALSE(published().rollback);
  version(approve);
  EXPECT_FALSE(published().rollback);
  decide(1, roll_back);
  EXPECT_TRUE(published().rollback);
  decide(2, approve);
  const ModelVersion approved = published();
  EXPECT_EQ(approved.number, 2);
  EXPECT_TRUE(approved.rollback) << "a simulator that missed the rollback runs version 3";
}

TEST_F(PublisherTest, AfterTheOnlyChampionWasWithdrawnALateSimulatorGetsNone) {
  dds::Reader<ModelVersion> early(simulator_);
  version(approve);
  publisher_.publish_champion(registry_, bdr_);
  EXPECT_EQ(next(early), 1);
  decide(1, withdraw);
  EXPECT_TRUE(publisher_.publish_champion(registry_, bdr_));
  dds::Reader<ModelVersion> late(simulator_);
  ASSERT_TRUE(eventually([&] { return late.matched_writers() == 1; }));
  version(approve);
  publisher_.publish_champion(registry_, bdr_);
  EXPECT_EQ(next(late), 2) << "and not the withdrawn one before it";
  EXPECT_EQ(next(early), 2);
}

TEST_F(PublisherTest, ADamagedVersionIsNotPublished) {
  storage::NewAttempt attempt;
  attempt.spacecraft = bdr_.spacecraft;
  attempt.equipment = bdr_.equipment;
  registry_.record(attempt, {to_json(example_model()).dump(), "another digest"},
                   {approve, "gate", ""});
  EXPECT_FALSE(publisher_.publish_champion(registry_, bdr_));
  EXPECT_EQ(publisher_.publish_champions(registry_), 0U);
}

TEST_F(PublisherTest, OfDecisionsOnTwoThreadsTheLastOneIsPublishedLast) {
  dds::Reader<ModelVersion> reader(simulator_);
  for (int i = 0; i < 3; ++i) version(approve);
  std::mutex one_writer;
  const auto operate = [&](std::int64_t first) {
    storage::Database own(path(), storage::Database::Mode::read_only);
    const storage::Registry view(own);
    for (std::int64_t i = 0; i < 100; ++i) {
      {
        const std::lock_guard lock(one_writer);
        const auto made = registry_.champion_decision(bdr_.spacecraft, bdr_.equipment);
        const std::int64_t target = 1 + (first + i) % 3;
        if (made->version != target) decide(target, roll_back);
      }
      publisher_.publish_champion(view, bdr_);
    }
  };
  std::thread ana(operate, 0), bo(operate, 1);
  ana.join();
  bo.join();
  const std::int64_t champion = registry_.champion(bdr_.spacecraft, bdr_.equipment)->number;
  std::int64_t last = 0;
  EXPECT_TRUE(eventually([&] {
    reader.take(1000, [&](ModelVersion&& message) { last = message.number; });
    return last == champion;
  }));
  dds::Reader<ModelVersion> late(simulator_);
  EXPECT_EQ(next(late), champion);
}

TEST_F(PublisherTest, WhoTakesOverPublishesAgainSoThatItRunsInstead) {
  dds::Reader<ModelVersion> reader(simulator_);
  version(approve);
  publisher_.publish_champions(registry_);
  EXPECT_FALSE(take_all(reader, 1).at(0).rollback);
  EXPECT_EQ(publisher_.publish_champions(registry_, true), 1U);
  const ModelVersion again = take_all(reader, 1).at(0);
  EXPECT_EQ(again.number, 1);
  EXPECT_TRUE(again.rollback) << "a simulator may run what was overruled";
}

TEST_F(PublisherTest, WhoRetiresLeavesNothingForLateSimulatorsAndMayBeginAgain) {
  dds::Reader<ModelVersion> early(simulator_);
  version(approve);
  publisher_.publish_champions(registry_);
  EXPECT_EQ(next(early), 1);
  publisher_.retire();
  EXPECT_TRUE(publisher_.published().empty());
  dds::Reader<ModelVersion> late(simulator_);
  ASSERT_TRUE(eventually([&] { return late.matched_writers() == 1; }));
  version(approve);
  publisher_.publish_champions(registry_);
  EXPECT_EQ(next(late), 2) << "and not the one before";
}

TEST_F(PublisherTest, WhatMayNotBePublishedIsNotUntilItMay) {
  bool may = false;
  Publisher asking(service_, [&](const storage::Registry&) { return may; });
  dds::Reader<ModelVersion> reader(simulator_);
  version(approve);
  EXPECT_FALSE(asking.publish_champion(registry_, bdr_));
  EXPECT_TRUE(asking.published().empty());
  may = true;
  EXPECT_TRUE(asking.publish_champion(registry_, bdr_));
  EXPECT_EQ(next(reader), 1);
}

}  // namespace
}  // namespace reident::test::publisher_test
