// What two registries share: the same rows with the same ids, or what one gave up where it can be
// seen.
#include "storage/registry/journal.hpp"

#include <algorithm>
#include <limits>

#include "tests/storage/registry/registry_fixture.hpp"

namespace reident::storage::test::journal_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr std::size_t everything = std::numeric_limits<std::size_t>::max();
const std::string all_rows =
    "SELECT * FROM term; SELECT * FROM journal; SELECT * FROM attempt; SELECT * FROM version; "
    "SELECT * FROM decision; SELECT * FROM hold; SELECT * FROM command; SELECT * FROM alarm; "
    "SELECT * FROM change; SELECT * FROM simulator; SELECT hex(output_mean), * FROM block; "
    "SELECT hex(state), * FROM score; SELECT * FROM overruled";

class JournalTest : public RegistryTest {
 protected:
  Journal ours{database};
  std::filesystem::path other_path = folder / "other.db";
  Database other{other_path, Mode::read_write};
  Registry other_registry{other};
  Journal theirs{other};

  /// Copies what the other one does not have, in parts of so many bytes.
  void copy(std::size_t bytes = everything) {
    while (theirs.last() < ours.last()) theirs.apply(ours.part(theirs.last(), bytes));
  }
  /// A row of each kind at least.
  void record_everything() {
    ++times_;
    version(10, DecisionKind::approve);
    const std::int64_t second = version(20, DecisionKind::wait);
    registry.record(attempt(30));
    decide(second, DecisionKind::approve, 40);
    registry.put_on_hold("CB4", "BDR", {"Ana", "training", 50});
    registry.release("CB4", "BDR", {"Ana", "over", 55});
    registry.execute({"console", times_, "hold", "CB4", "BDR", 0, "Ana", ""}, 60, [] {
      return CommandOutcome{true, "held"};
    });
    registry.raise({"disk", {}, "full " + std::to_string(times_), 70});
    registry.record_change({"CB4", "BDR"}, {second, 5, 6}, 80);
    SimulatorState simulator;
    simulator.simulator = "trainer";
    simulator.equipment = {"CB4", "BDR"};
    registry.record_simulator(simulator);
    Block block;
    block.range = {static_cast<Time>(60 * times_), static_cast<Time>(60 * times_ + 60)};
    block.believed = 0.1;
    block.output_mean = {-0.0, 1e-300};
    registry.record_scores(
        "CB4", "BDR", block,
        {{second, block.range.begin, 5, {0.1}, {0.2}, {}, {{1, 2}, 7, {3}, 4}, {0.5}}});
  }

 private:
  std::uint64_t times_ = 0;
};

TEST_F(JournalTest, OfARegistryWithoutAPairIsEmpty) {
  record_everything();
  EXPECT_EQ(ours.last(), 0);
  EXPECT_THAT(ours.terms(), IsEmpty());
  EXPECT_TRUE(ours.is_of_no_pair());
}

TEST_F(JournalTest, ItsFirstTermTakesUpWhatThereIs) {
  record_everything();
  ours.begin_term(2, "a", 100);
  record_everything();
  EXPECT_EQ(ours.terms(), (std::vector<Term>{{2, "a", 100, 1}}));
  copy();
  EXPECT_THAT(rows(other_path, all_rows), ::testing::ElementsAreArray(rows(path, all_rows)));
  EXPECT_EQ(other_registry.champion("CB4", "BDR")->number, registry.champion("CB4", "BDR")->number);
}

TEST_F(JournalTest, EveryRowIsCopiedToTheLastBitInAnyParts) {
  ours.begin_term(1, "a", 5);
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{700}, everything}) {
    record_everything();
    if (bytes == 700) ours.begin_term(4, "b", 90);
    copy(bytes);
    EXPECT_THAT(rows(other_path, all_rows), ::testing::ElementsAreArray(rows(path, all_rows)));
  }
  EXPECT_THAT(rows(other_path, "PRAGMA foreign_key_check; PRAGMA integrity_check"),
              ElementsAre("ok"));
}

TEST_F(JournalTest, APartThatComesTwiceChangesNothing) {
  ours.begin_term(1, "a", 5);
  record_everything();
  const JournalPart first = ours.part(0, 350);
  EXPECT_THAT(theirs.apply(first), ElementsAre(1));
  EXPECT_THAT(theirs.apply(first), IsEmpty());
  EXPECT_THAT(theirs.apply(ours.part(0, everything)), ElementsAre(2, 3));
  EXPECT_THAT(rows(other_path, all_rows), ::testing::ElementsAreArray(rows(path, all_rows)));
}

TEST_F(JournalTest, RowsThatDoNotFollowOrAreNoneAreRefusedAndChangeNothing) {
  ours.begin_term(1, "a", 5);
  record_everything();
  const auto before = rows(other_path, all_rows);
  EXPECT_THAT(error_of([&] { theirs.apply(ours.part(3, everything)); }),
              AllOf(StartsWith("failed: "), HasSubstr("rows from 4 on do not follow row 0")));
  JournalPart cut = ours.part(0, everything);
  cut.rows.pop_back();
  EXPECT_THAT(error_of([&] { theirs.apply(cut); }), StartsWith("corrupt: "));
  JournalPart foreign{0, 1, {3, 'a', 'b', 'c', 0}};
  EXPECT_THAT(error_of([&] { theirs.apply(foreign); }),
              AllOf(StartsWith("failed: "), HasSubstr("'abc'"), HasSubstr("of one version")));
  JournalPart nameless = ours.part(0, everything);  // its first attempt has no id
  const std::string row = {7, 'a', 't', 't', 'e', 'm', 'p', 't'};
  const auto name = std::search(nameless.rows.begin(), nameless.rows.end(), row.begin(), row.end());
  ASSERT_NE(name, nameless.rows.end());
  const auto id = name + static_cast<std::ptrdiff_t>(row.size()) + 1;
  *id = 'n';
  nameless.rows.erase(id + 1, id + 9);
  EXPECT_THAT(error_of([&] { theirs.apply(nameless); }),
              AllOf(StartsWith("corrupt: "), HasSubstr("'attempt'")));
  EXPECT_THAT(rows(other_path, all_rows), ::testing::ElementsAreArray(before));
  other_registry.record(attempt(1));
  EXPECT_THAT(error_of([&] { theirs.apply(ours.part(0, everything)); }),
              AllOf(HasSubstr("of no pair"), HasSubstr("empty database")));
}

TEST_F(JournalTest, WhatTwoDecidedApartIsOverruledAndStaysVisibleInBoth) {
  ours.begin_term(1, "a", 5);
  version(10, DecisionKind::approve);
  copy();
  const std::int64_t shared = ours.last();
  version(20, DecisionKind::approve);  // by a, in term 1, while it is cut off
  record_everything();
  theirs.begin_term(2, "b", 25);
  const std::int64_t number =
      other_registry.record(attempt(30), {"{}", "other"}, decision(DecisionKind::approve));

  ASSERT_EQ(common_end(ours.terms(), ours.last(), theirs.terms(), theirs.last()), shared);
  const JournalPart given_up = ours.part(shared, everything);
  theirs.keep_overruled(given_up, ours.term_at(shared), "a", 40);
  theirs.keep_overruled(given_up, ours.term_at(shared), "a", 41);  // comes twice
  ours.overrule(shared, 42);
  EXPECT_EQ(ours.last(), shared);
  EXPECT_EQ(champion_at(std::nullopt), 1);
  ours.apply(theirs.part(shared, everything));
  EXPECT_THAT(rows(path, all_rows), ::testing::ElementsAreArray(rows(other_path, all_rows)));
  EXPECT_EQ(champion_at(std::nullopt), number);
  EXPECT_THAT(rows(path, "SELECT term, service, version, kind FROM overruled_decision LIMIT 2"),
              ElementsAre("1|a|3|approve", "1|a|5|approve"));
  const auto overruled = ours.overruled_since(40);
  ASSERT_TRUE(overruled);
  EXPECT_EQ(overruled->decisions, 6) << "with hold, release and command";
  EXPECT_EQ(overruled->service, "a");
  EXPECT_FALSE(ours.overruled_since(41));
}

TEST_F(JournalTest, VersionsOfTwoTermsNeverShareANumber) {
  ours.begin_term(1, "a", 5);
  EXPECT_EQ(version(10, DecisionKind::approve), 1);
  EXPECT_EQ(version(11, DecisionKind::wait), 3);
  copy();
  EXPECT_EQ(version(12, DecisionKind::wait), 5);
  theirs.begin_term(2, "b", 20);
  EXPECT_EQ(other_registry.record(attempt(21), {"{}", "x"}, decision(DecisionKind::wait)), 4);
  const std::int64_t shared = ours.part(0, everything).last - 3;
  theirs.keep_overruled(ours.part(shared, everything), 1, "a", 30);
  ours.overrule(shared, 30);
  ours.apply(theirs.part(shared, everything));
  ours.begin_term(3, "a", 40);
  EXPECT_EQ(version(41, DecisionKind::wait), 7) << "5 was overruled, and is not given again";
}

TEST_F(JournalTest, RowsAreGuardedAsBeforeOnceSomeWereOverruled) {
  ours.begin_term(1, "a", 5);
  version(10, DecisionKind::approve);
  const char* schema = "SELECT type, name, sql FROM sqlite_master ORDER BY type, name";
  ours.overrule(1, 20);
  EXPECT_THAT(rows(path, schema), ::testing::ElementsAreArray(rows(other_path, schema)));
  version(30, DecisionKind::approve);
  EXPECT_THAT(rows(path, "DELETE FROM decision"), Contains(HasSubstr("never changed")));
}

TEST(CommonEnd, IsTheLastRowOfTheLastTermThatBothHave) {
  const Term one{1, "a", 10, 1}, two{2, "b", 20, 8}, three{3, "a", 30, 12}, same{3, "a", 31, 9};
  EXPECT_EQ(common_end({}, 0, {one}, 7), 0);
  EXPECT_EQ(common_end({one}, 5, {one}, 7), 5);
  EXPECT_EQ(common_end({one}, 9, {one, two}, 11), 7);
  EXPECT_EQ(common_end({one, two, three}, 20, {one, two}, 11), 11);
  EXPECT_EQ(common_end({one, same}, 20, {one, two, three}, 14), 7);
  EXPECT_EQ(common_end({same}, 20, {three}, 14), 0);
}

}  // namespace
}  // namespace reident::storage::test::journal_test
