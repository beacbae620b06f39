#include <limits>

#include "storage/registry/registry.hpp"
#include "tests/storage/registry/registry_fixture.hpp"

namespace reident::storage::test::registry_scores_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double inf = std::numeric_limits<double>::infinity();

Block block(Time begin) {
  return {{begin, begin + 10}, 7, 0.7, {1.5, -2}, {4, 5}, {-1}, {1}, {}};
}

BlockScore score(std::int64_t version, Time begin) {
  return {version,
          begin,
          7,
          {0.1, -0.0},
          {0.01, inf},
          {1e-9, 5e-324},
          {{1, 2, 3}, 42, {0.07, 1}, 7},
          {1, 2, 3, -4, 5, -0.0}};
}

TEST_F(RegistryTest, GivesBlocksAndScoresBackToTheLastBit) {
  version(10, DecisionKind::wait);
  registry.record_scores("CB4", "BDR", block(0), {score(1, 0)});
  BlockScore first = score(1, 10);
  first.state = {};
  registry.record_scores("CB4", "BDR", block(10), {first});
  const auto blocks = registry.blocks("CB4", "BDR", INT64_MIN);
  ASSERT_THAT(blocks, SizeIs(2));
  EXPECT_EQ(blocks[0].range, (TimeRange{0, 10}));
  EXPECT_EQ(blocks[0].rows, 7);
  EXPECT_EQ(blocks[0].believed, 0.7);
  EXPECT_THAT(blocks[0].output_mean, ElementsAre(1.5, -2));
  EXPECT_THAT(blocks[0].output_square, ElementsAre(4, 5));
  EXPECT_THAT(blocks[0].input_low, ElementsAre(-1));
  EXPECT_THAT(blocks[0].input_high, ElementsAre(1));
  EXPECT_THAT(blocks[0].baseline_square, IsEmpty());
  EXPECT_THAT(registry.blocks("CB4", "BDR", 10), SizeIs(1));
  EXPECT_EQ(registry.last_block_end("CB4", "BDR"), 20);

  const auto scores = registry.scores("CB4", "BDR", 1, INT64_MIN);
  ASSERT_THAT(scores, SizeIs(2));
  EXPECT_EQ(scores[0].version, 1);
  EXPECT_EQ(scores[0].rows, 7);
  EXPECT_THAT(scores[0].mean, ElementsAre(0.1, 0.0));
  EXPECT_TRUE(std::signbit(scores[0].mean[1]));
  EXPECT_THAT(scores[0].square, ElementsAre(0.01, inf));
  EXPECT_THAT(scores[0].noise, ElementsAre(1e-9, 5e-324));
  EXPECT_THAT(scores[0].state.x, ElementsAre(1, 2, 3));
  EXPECT_EQ(scores[0].state.tick, 42);
  EXPECT_THAT(scores[0].state.square_errors, ElementsAre(0.07, 1));
  EXPECT_EQ(scores[0].state.rows, 7);
  EXPECT_THAT(scores[0].bias_effects, ElementsAre(1, 2, 3, -4, 5, 0.0));
  EXPECT_EQ(scores[1].state.tick, std::nullopt);
}

TEST_F(RegistryTest, HasNoBlocksOfOthers) {
  version(10, DecisionKind::wait);
  registry.record_scores("CB4", "BDR", block(0), {score(1, 0)});
  EXPECT_THAT(registry.blocks("CB4", "MEA", INT64_MIN), IsEmpty());
  EXPECT_THAT(registry.scores("CB4", "BDR", 2, INT64_MIN), IsEmpty());
  EXPECT_EQ(registry.last_block_end("CB4", "MEA"), std::nullopt);
}

TEST_F(RegistryTest, RefusesABlockOrAScoreThatIsThereAndRecordsNothingThen) {
  version(10, DecisionKind::wait);
  version(20, DecisionKind::wait);
  registry.record_scores("CB4", "BDR", block(0), {score(1, 0)});
  EXPECT_THROW(registry.record_scores("CB4", "BDR", block(0), {score(2, 0)}), Error);
  EXPECT_THROW(registry.record_scores("CB4", "BDR", block(10), {score(2, 10), score(1, 0)}), Error);
  EXPECT_THAT(registry.blocks("CB4", "BDR", INT64_MIN), SizeIs(1));
  EXPECT_THAT(registry.scores("CB4", "BDR", 2, INT64_MIN), IsEmpty());
}

TEST_F(RegistryTest, ScoresNoVersionThatIsNotThere) {
  EXPECT_THROW(registry.record_scores("CB4", "BDR", block(0), {score(1, 0)}), Error);
  EXPECT_THAT(registry.blocks("CB4", "BDR", INT64_MIN), IsEmpty());
}

TEST_F(RegistryTest, ReadsNoBlockOrScoreOfWhichAListIsDamaged) {
  version(10, DecisionKind::wait);
  BlockScore lost = score(1, 0);
  lost.square.pop_back();
  registry.record_scores("CB4", "BDR", {}, {lost});
  EXPECT_THROW(registry.scores("CB4", "BDR", 1, INT64_MIN), Error);
  EXPECT_THAT(registry.scores("CB4", "BDR", 1, 10), IsEmpty()) << "others are read";
  Block damaged = block(0);
  damaged.input_high.clear();
  registry.record_scores("CB4", "BDR", damaged, {});
  EXPECT_THROW(registry.blocks("CB4", "BDR", INT64_MIN), Error);
}

}  // namespace
}  // namespace reident::storage::test::registry_scores_test
