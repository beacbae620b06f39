#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "identification/search/identify.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::verdicts_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Record driven(Index rows) {
  test::Noise noise(1);
  return test::excited(test::random_system(noise, 2, 2, 1), noise, rows, 0.05);
}

Verdict verdict_of(const Record& record, const IdentifyOptions& options = {}) {
  const IdentifyResult result = identify(record, record.all(), options);
  if (const auto* verdict = std::get_if<Verdict>(&result)) return *verdict;
  ADD_FAILURE() << "gave a model of order " << std::get<Identified>(result).model.order();
  return {};
}

TEST(Verdicts, TooFewSamplesNamesTheNumberNeeded) {
  const Record record = driven(100);
  for (const Index rows : {0, 1, 3, 12, 22}) {
    const IdentifyResult result = identify(record, {0, rows}, {});
    ASSERT_TRUE(std::holds_alternative<Verdict>(result)) << rows;
    const Verdict& verdict = std::get<Verdict>(result);
    EXPECT_EQ(verdict.code, VerdictCode::too_few_samples) << rows;
    EXPECT_THAT(verdict.reason, HasSubstr(" 26 rows"));
    EXPECT_THAT(verdict.reason, HasSubstr(" 200"));
  }
  const IdentifyResult result = identify(record, {0, 26}, {});
  const auto* verdict = std::get_if<Verdict>(&result);
  EXPECT_TRUE(!verdict || verdict->code != VerdictCode::too_few_samples);
}

TEST(Verdicts, AnOrderThatTheRowsDoNotFeedIsNamed) {
  const auto warnings = [](Index rows) {
    return std::get<Identified>(identify(driven(rows), {0, rows}, {})).warnings;
  };
  EXPECT_THAT(warnings(60), Contains(AllOf(HasSubstr("no order above 3"), HasSubstr(" 200 rows"))));
  EXPECT_THAT(warnings(199), Contains(HasSubstr("no order above 9")));
  EXPECT_THAT(warnings(200), IsEmpty());
}

TEST(Verdicts, SegmentsShorterThanTwiceTheHorizonAreTooFewSamples) {
  Record record = driven(600);
  record.segments.clear();
  for (Index k = 0; k < 600; k += 3) record.segments.push_back({k, k + 3, 2 * k});
  EXPECT_EQ(verdict_of(record).code, VerdictCode::too_few_samples);
  IdentifyOptions options;
  options.horizon = 200;
  EXPECT_EQ(verdict_of(driven(600), options).code, VerdictCode::too_few_samples);
}

TEST(Verdicts, NonFiniteValuesAreLocated) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Record record = driven(200);
    record.u(17, 1) = bad;
    const Verdict verdict = verdict_of(record);
    EXPECT_EQ(verdict.code, VerdictCode::non_finite);
    EXPECT_THAT(verdict.reason, HasSubstr("input 2 is not a finite number in row 17"));
    record = driven(200);
    record.y(3, 0) = bad;
    EXPECT_THAT(verdict_of(record).reason, HasSubstr("output 1"));
  }
}

TEST(Verdicts, ConstantChannels) {
  Record record = driven(300);
  record.u.setConstant(28.1);
  EXPECT_EQ(verdict_of(record).code, VerdictCode::constant_inputs);
  record = driven(300);
  record.y.setConstant(28.1);
  EXPECT_EQ(verdict_of(record).code, VerdictCode::constant_outputs);
}

TEST(Verdicts, ASineExcitesNoHighOrder) {
  Record record = driven(600);
  test::Noise noise(2);
  record.u.resize(600, 1);
  for (Index k = 0; k < 600; ++k) record.u(k, 0) = std::sin(0.2 * double(k));
  record.y = record.u + 0.01 * noise.normal(600, 1);
  IdentifyOptions options;
  options.order = 4;
  const Verdict verdict = verdict_of(record, options);
  EXPECT_EQ(verdict.code, VerdictCode::insufficient_excitation);
  EXPECT_THAT(verdict.reason, HasSubstr("input 1"));
}

TEST(Verdicts, InputsThatDoNotExplainTheOutputAreNoBetterThanTheMean) {
  Record record = driven(800);
  test::Noise noise(3);
  record.y = noise.normal(800, 1);
  const Verdict verdict = verdict_of(record);
  EXPECT_EQ(verdict.code, VerdictCode::no_better_than_mean);
  EXPECT_THAT(verdict.reason, HasSubstr("do not explain"));
}

TEST(Verdicts, AnUnstableSystemIsToldAsUnstable) {
  test::Noise noise(4);
  StateSpaceModel truth = test::random_system(noise, 1, 1, 1);
  truth.A(0, 0) = 1.02;
  IdentifyOptions options;
  options.order = 1;
  const Record record = test::excited(truth, noise, 900, 0);
  EXPECT_EQ(verdict_of(record, options).code, VerdictCode::unstable);
  options.may_enforce_stability = false;
  const Verdict verdict = verdict_of(record, options);
  EXPECT_EQ(verdict.code, VerdictCode::unstable);
  EXPECT_THAT(verdict.reason, HasSubstr("or let A be made stable"));
}

TEST(Verdicts, EquipmentThatIntegratesIsNotTakenForUnstable) {
  // A battery's voltage: its charge, a slower part and its resistance, over orbits.
  for (const std::uint64_t seed : {2U, 6U}) {
    test::Noise noise(seed);
    Matrix A(2, 2), C(1, 2);
    A << 1, 0, 0, 0.86;
    C << 2e-4, 0.007;
    const StateSpaceModel battery{A,
                                  Matrix::Ones(2, 1),
                                  C,
                                  Matrix::Constant(1, 1, 0.03),
                                  {},
                                  Vector::Zero(1),
                                  Vector::Zero(1),
                                  60};
    Matrix u = 0.5 * noise.normal(600, 1);
    for (Index t = 0; t < 600; ++t) u(t) += t % 94 < 60 ? 5 : -4;
    const Record record = contiguous_record(
        60, u, test::simulated(battery, u, Vector::Zero(2)) + 0.002 * noise.normal(600, 1));
    const IdentifyResult result = identify(record, record.all(), {});
    const auto* found = std::get_if<Identified>(&result);
    ASSERT_NE(found, nullptr) << std::get<Verdict>(result).reason;
    EXPECT_LT(*found->held_out_error, 0.03) << seed;
    EXPECT_NEAR(found->spectral_radius, 1, 1e-3) << seed;
  }
}

TEST(Options, EveryMistakeIsNamed) {
  EXPECT_THAT(mistakes({}), IsEmpty());
  IdentifyOptions options;
  options.order = -1;
  options.min_order = -1;
  options.max_order = -2;
  options.horizon = 1;
  options.tune_share = std::nan("");
  EXPECT_THAT(
      mistakes(options),
      ElementsAre(HasSubstr("the order must"), HasSubstr("smallest order"),
                  HasSubstr("largest order"), HasSubstr("horizon"), HasSubstr("tuning share")));
}

}  // namespace
}  // namespace reident::identification::verdicts_test
