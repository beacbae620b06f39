#include "service/daemon/simulator_book.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace reident::simulator_book_test {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr storage::Time second = 1'000'000'000;

ModelAcknowledgement runs(const std::string& simulator, std::int64_t version, double error) {
  ModelAcknowledgement said;
  said.simulator = simulator;
  said.spacecraft = "SAT";
  said.equipment = "BDR";
  said.running.version = version;
  said.running.mrse_percent = error;
  return said;
}

TEST(SimulatorBook, AChangeIsARowWithTheErrorThatTheOneBeforeCameTo) {
  SimulatorBook book({}, 0);
  EXPECT_TRUE(book.hear(runs("a", 1, NAN), 1 * second));
  EXPECT_FALSE(book.hear(runs("a", 1, 2.5), 2 * second));
  EXPECT_FALSE(book.hear(runs("a", 1, 2.25), 3 * second));
  EXPECT_TRUE(book.hear(runs("a", 2, NAN), 4 * second));
  const auto changes = book.take_changes(5 * second);
  ASSERT_THAT(changes, SizeIs(2));
  EXPECT_EQ(changes[0].version, 1);
  EXPECT_TRUE(std::isnan(changes[0].error_before_percent));
  EXPECT_EQ(changes[1].version, 2);
  EXPECT_EQ(changes[1].error_before_percent, 2.25);
  EXPECT_EQ(changes[1].time, 4 * second);
  EXPECT_THAT(book.take_changes(6 * second), IsEmpty());
}

TEST(SimulatorBook, WhoLeavesIsNotThereAnyMore) {
  SimulatorBook book({}, 0);
  book.hear(runs("a", 1, 2.5), second);
  book.hear(runs("b", 1, 3), second);
  book.leave(runs("a", 0, 0), 2 * second);
  book.leave(runs("nobody", 0, 0), 2 * second);
  const auto changes = book.take_changes(3 * second);
  ASSERT_THAT(changes, SizeIs(3));
  EXPECT_FALSE(changes[2].is_there);
  EXPECT_EQ(changes[2].error_before_percent, 2.5);
  ASSERT_THAT(book.present(), SizeIs(1));
  EXPECT_EQ(book.present()[0].simulator, "b");
}

TEST(SimulatorBook, WhoAnEarlierRunKnewAndIsNotHeardOfHasLeft) {
  storage::SimulatorState before;
  before.simulator = "a";
  before.equipment = {"SAT", "BDR"};
  before.version = 1;
  auto other = before;
  other.simulator = "b";
  SimulatorBook book({before, other}, 0);
  EXPECT_FALSE(book.hear(runs("a", 1, 2), second)) << "it does what it did";
  EXPECT_THAT(book.take_changes(9 * second), IsEmpty());
  const auto changes = book.take_changes(11 * second);
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(changes[0].simulator, "b");
  EXPECT_FALSE(changes[0].is_there);
}

TEST(SimulatorBook, WhatCannotBeKeptComesAgain) {
  SimulatorBook book({}, 0);
  book.hear(runs("a", 1, 2), second);
  auto changes = book.take_changes(second);
  book.hear(runs("a", 2, 2), 2 * second);
  book.give_back(std::move(changes));
  changes = book.take_changes(3 * second);
  ASSERT_THAT(changes, SizeIs(2));
  EXPECT_EQ(changes[0].version, 1);
  EXPECT_EQ(changes[1].version, 2);
}

}  // namespace
}  // namespace reident::simulator_book_test
