#include "identification/search/identify.hpp"

#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gmock/gmock.h>

#include "identification/samples/tick_ranges.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/scores.hpp"
#include "tests/support/naive_n4sid.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::identify_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Score run_error(const Identified& found, const Record& record) {
  return score_free_run(found.model, record, record.all(), record.all(), found.x0);
}

Identified expect_model(const Record& record, RowRange rows, const IdentifyOptions& options = {}) {
  IdentifyResult result = identify(record, rows, options);
  if (const auto* verdict = std::get_if<Verdict>(&result)) {
    ADD_FAILURE() << name(verdict->code) << ": " << verdict->reason;
    return {};
  }
  return std::get<Identified>(std::move(result));
}

TEST(Identify, WithoutNoiseTheModelIsTheSystem) {
  test::Noise noise(11);
  struct {
    Index order, inputs, outputs;
  } const cases[] = {{1, 1, 1}, {2, 3, 1}, {3, 1, 2}, {4, 2, 1}, {6, 2, 3}};
  for (const auto& c : cases) {
    const StateSpaceModel truth = test::random_system(noise, c.order, c.inputs, c.outputs);
    const Record record = test::excited(truth, noise, 1200, 0);
    const Identified found = expect_model(record, record.all());
    EXPECT_EQ(found.model.order(), c.order);
    EXPECT_LT(test::pole_distance(found.model, truth), 1e-5) << c.order;
    EXPECT_LT(test::markov_distance(found.model, truth), 1e-5) << c.order;
    EXPECT_LT(run_error(found, record).mrse(), 1e-3);
    EXPECT_LT(found.held_out_error.value(), 1e-5);
    EXPECT_NEAR(found.spectral_radius, spectral_radius(truth), 1e-5);
  }
}

TEST(Identify, AModelThatIsTooSlowGivesWayToOneThatIsNot) {
  test::Noise noise(14);
  StateSpaceModel truth = test::random_system(noise, 2, 1, 1);
  truth.A << std::exp(-1.0 / 20'000), 0, 0, 0.5;
  truth.B << 0.02, 1;
  truth.C << 1, 1;
  truth.D << 0;
  const Record record = test::excited(truth, noise, 2000, 0.05);
  IdentifyOptions options;
  options.max_order = 3;
  EXPECT_GT(slowest_time_constant_s(expect_model(record, record.all(), options).model), 2000);
  options.longest_time_constant_s = 2000;
  const Identified second = expect_model(record, record.all(), options);
  EXPECT_LT(slowest_time_constant_s(second.model), 2000);
  EXPECT_THAT(second.warnings, Contains(AnyOf(HasSubstr("a mode that is slower than 2000 s"),
                                              HasSubstr("moved slowly by more"))));
  options.order = 2;
  options.longest_time_constant_s = 0.1;
  EXPECT_GT(slowest_time_constant_s(expect_model(record, record.all(), options).model), 0.1)
      << "there is no other";
  options.longest_time_constant_s = 0;
  EXPECT_THAT(mistakes(options), ElementsAre("the longest time constant must be positive"));
}

TEST(Identify, AModelThatIsTooSlowDoesNotGiveWayToOneThatExplainsNothing) {
  test::Noise noise(15);
  StateSpaceModel truth = test::random_system(noise, 1, 1, 1);
  truth.A << std::exp(-1.0 / 20'000);
  truth.B << 0.02;
  truth.C << 1;
  truth.D << 0;
  IdentifyOptions options;
  options.longest_time_constant_s = 20;
  const Identified found =
      expect_model(test::excited(truth, noise, 2000, 0.05), {0, 2000}, options);
  EXPECT_GT(slowest_time_constant_s(found.model), 2000);
}

TEST(Identify, WithNoiseTheErrorFallsWithTheRows) {
  test::Noise noise(12);
  const StateSpaceModel truth = test::random_system(noise, 3, 2, 1, 0.9);
  IdentifyOptions options;
  options.order = 3;
  const Record few = test::excited(truth, noise, 500, 0.2);
  const Record many = test::excited(truth, noise, 20000, 0.2);
  const double coarse = test::markov_distance(expect_model(few, few.all(), options).model, truth);
  const double fine = test::markov_distance(expect_model(many, many.all(), options).model, truth);
  EXPECT_LT(coarse, 0.25);
  EXPECT_LT(fine, 0.03);
  EXPECT_LT(fine, coarse);
}

/// The first output's part of a model.
StateSpaceModel of_first_output(StateSpaceModel model) {
  model.C = model.C.topRows(1).eval();
  model.D = model.D.topRows(1).eval();
  model.y0 = model.y0.head(1).eval();
  return model;
}

TEST(Identify, ANoisyOutputDoesNotSpoilAQuietOneBesideIt) {
  constexpr int records = 10;
  double lost = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    const StateSpaceModel truth = test::random_system(noise, 2, 2, 2);
    const Record exact = test::excited(truth, noise, 600, 0);
    const Matrix chance = noise.normal(600, 2);
    const auto error_beside = [&](double noise_share) {
      Record record = exact;
      for (Index q = 0; q < 2; ++q) {
        const double deviation =
            std::sqrt((exact.y.col(q).array() - exact.y.col(q).mean()).square().mean());
        record.y.col(q) += (q == 0 ? 0.005 : noise_share) * deviation * chance.col(q);
      }
      return test::markov_distance(of_first_output(expect_model(record, record.all()).model),
                                   of_first_output(truth));
    };
    lost += std::log(error_beside(0.5) / error_beside(0.005));
  }
  EXPECT_LT(std::exp(lost / records), 1.4);
  RecordProperty("lost", std::to_string(std::exp(lost / records)));
}

TEST(Identify, ReadsNothingOutsideTheRowsAsked) {
  test::Noise noise(13);
  const StateSpaceModel truth = test::random_system(noise, 2, 1, 1);
  Record record = test::excited(truth, noise, 900, 0.05);
  const Identified before = expect_model(record, {200, 700});
  const double nan = std::nan("");
  record.u.topRows(200).setConstant(nan);
  record.y.topRows(200).setConstant(nan);
  record.u.bottomRows(200).setConstant(nan);
  record.y.bottomRows(200).setConstant(nan);
  const Identified after = expect_model(record, {200, 700});
  EXPECT_EQ(before.model.A, after.model.A);
  EXPECT_EQ(before.model.B, after.model.B);
  EXPECT_EQ(before.x0, after.x0);
}

TEST(Identify, FitsNothingToTheRowsThatItChoosesBy) {
  test::Noise noise(31);
  const StateSpaceModel truth = test::random_system(noise, 3, 2, 1, 0.9);
  Record record = test::excited(truth, noise, 1600, 0.1);
  IdentifyOptions options;
  options.tune_rows = 600;
  options.response_fit = ResponseFit::subspace;  // without refinement, which cannot be asked for
  const Identified chosen = expect_model(record, record.all(), options);
  // These choices, given, on the rows before the last 600 alone.
  IdentifyOptions given;
  given.order = chosen.recipe.order;
  given.horizon = chosen.recipe.horizon;
  given.weighting = chosen.recipe.weighting;
  given.direct_feedthrough = chosen.recipe.direct;
  given.response_fit = chosen.recipe.fit;
  const Identified fitted = expect_model(record, {0, 1000}, given);
  EXPECT_EQ(chosen.model.A, fitted.model.A);
  EXPECT_EQ(chosen.model.B, fitted.model.B);
  EXPECT_EQ(chosen.model.D, fitted.model.D);
  EXPECT_EQ(chosen.input_max, fitted.input_max);

  // Other telemetry in the last rows changes the choice at most.
  record.y.bottomRows(600).setZero();
  options.order = given.order;
  options.horizon = given.horizon;
  options.weighting = given.weighting;
  options.direct_feedthrough = given.direct_feedthrough;
  EXPECT_EQ(expect_model(record, record.all(), options).model.A, fitted.model.A);
}

TEST(Identify, GivesTheSameBitsEveryTime) {
  test::Noise noise(14);
  const StateSpaceModel truth = test::random_system(noise, 3, 2, 2);
  const Record record = test::excited(truth, noise, 800, 0.1);
  const Identified first = expect_model(record, record.all());
  const Identified second = expect_model(record, record.all());
  EXPECT_EQ(first.model.A, second.model.A);
  EXPECT_EQ(first.model.B, second.model.B);
  EXPECT_EQ(first.model.K, second.model.K);
}

TEST(Identify, AnOperatingPointAMillionTimesTheSignalChangesNothing) {
  test::Noise noise(15);
  const StateSpaceModel truth = test::random_system(noise, 2, 2, 1);
  const Record centred = test::excited(truth, noise, 1000, 0.02);
  Record offset = centred;
  offset.u.array() += 1e6;
  offset.y.array() -= 3e6;
  IdentifyOptions options;
  options.order = 2;
  const Identified a = expect_model(centred, centred.all(), options);
  const Identified b = expect_model(offset, offset.all(), options);
  EXPECT_LT(test::markov_distance(b.model, a.model), 1e-6);
  EXPECT_NEAR(run_error(a, centred).fit(), run_error(b, offset).fit(), 1e-4);
}

TEST(Identify, UnitsChangeNothing) {
  test::Noise noise(16);
  const StateSpaceModel truth = test::random_system(noise, 2, 2, 2);
  const Record si = test::excited(truth, noise, 800, 0.05);
  Record milli = si;
  milli.u.col(0) *= 1e3;
  milli.y.col(1) *= 1e-9;
  const Identified a = expect_model(si, si.all());
  Identified b = expect_model(milli, milli.all());
  ASSERT_EQ(a.model.order(), b.model.order());
  b.model.B.col(0) *= 1e3;
  b.model.D.col(0) *= 1e3;
  b.model.C.row(1) *= 1e9;
  b.model.D.row(1) *= 1e9;
  EXPECT_LT(test::markov_distance(b.model, a.model), 1e-7);
}

TEST(Identify, GapsCostRowsAndNotAccuracy) {
  test::Noise noise(17);
  const StateSpaceModel truth = test::random_system(noise, 3, 1, 1, 0.9);
  const Record whole = test::excited(truth, noise, 3000, 0);
  Record record = test::with_gap(test::with_gap(whole, 1000, 1100), 0, 0);
  record.segments = {{0, 1000, 0}, {1000, 2900, 1100}};
  const Identified found = expect_model(record, record.all());
  EXPECT_LT(test::markov_distance(found.model, truth), 1e-5);
}

/// The record without so many percent of its rows, at random.
Record with_holes(const Record& record, unsigned percent, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<TickRange> holes;
  for (Index row = 0; row < record.rows(); ++row)
    if (random() % 100 < percent) holes.push_back({row, row + 1});
  return without(record, united(std::move(holes)));
}

TEST(Identify, HolesAllOverTheRowsLeaveOrdersToChooseFrom) {
  test::Noise noise(23);
  const StateSpaceModel truth = test::random_system(noise, 2, 1, 1, 0.9);
  const Record record = with_holes(test::excited(truth, noise, 6000, 0.01), 25, 4);
  const Identified found = expect_model(record, record.all());
  EXPECT_EQ(found.model.order(), 2);
  EXPECT_LT(test::markov_distance(found.model, truth), 0.02);
}

TEST(Identify, HolesInFewRowsLeaveOrdersToChooseFrom) {
  StateSpaceModel truth;
  truth.A = Eigen::Vector2d(0.958, 0.546).asDiagonal();
  truth.B = Matrix::Identity(2, 2);
  truth.C = Matrix::Ones(1, 2);
  truth.D = Matrix::Zero(1, 2);
  truth.u0 = Vector::Zero(2);
  truth.y0 = Vector::Zero(1);
  truth.period_s = 1;
  int right = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    test::Noise noise(seed);
    const Record record = with_holes(test::excited(truth, noise, 300, 0.01), 15, seed);
    const Identified found = expect_model(record, record.all());
    right += found.model.order() == 2 ? 1 : 0;
  }
  EXPECT_GE(right, 9);
}

TEST(Identify, TheOrderOfSegmentsDoesNotMatterForAGivenChoice) {
  test::Noise noise(18);
  const StateSpaceModel truth = test::random_system(noise, 2, 1, 1, 0.9);
  const Record a = test::excited(truth, noise, 600, 0.1);
  const Record b = test::excited(truth, noise, 600, 0.1);
  const auto join = [](const Record& first, const Record& second) {
    Record joined{1, Matrix(1200, 1), Matrix(1200, 1), {{0, 600, 0}, {600, 1200, 5000}}};
    joined.u << first.u, second.u;
    joined.y << first.y, second.y;
    return joined;
  };
  IdentifyOptions options;
  options.order = 2;
  options.horizon = 10;
  options.weighting = Weighting::cva;
  const Record ab = join(a, b), ba = join(b, a);
  EXPECT_LT(test::markov_distance(expect_model(ab, ab.all(), options).model,
                                  expect_model(ba, ba.all(), options).model),
            1e-9);
}

TEST(Identify, HonoursWhatIsFixed) {
  test::Noise noise(19);
  const StateSpaceModel truth = test::random_system(noise, 3, 1, 1);
  const Record record = test::excited(truth, noise, 800, 0.1);
  IdentifyOptions options;
  options.order = 5;
  options.horizon = 9;
  options.weighting = Weighting::moesp;
  const Identified found = expect_model(record, record.all(), options);
  EXPECT_EQ(found.model.order(), 5);
  EXPECT_EQ(found.recipe.horizon, 9);
  EXPECT_EQ(found.recipe.weighting, Weighting::moesp);
}

TEST(Identify, TellsTheRangeAndThePhases) {
  test::Noise noise(20);
  const StateSpaceModel truth = test::random_system(noise, 2, 2, 1);
  Record record = test::excited(truth, noise, 600, 0.1);
  record.u(300, 1) = 17;
  IdentifyOptions options;
  std::vector<std::string> phases;
  options.on_phase = [&phases](std::string_view phase) { phases.emplace_back(phase); };
  const Identified found = expect_model(record, record.all(), options);
  EXPECT_EQ(found.input_max(1), 17);
  EXPECT_EQ(found.input_min(0), record.u.col(0).minCoeff());
  EXPECT_THAT(phases, ElementsAre("prepare", "choose", "identify"));
}

TEST(Identify, ADeadInputIsLeftOutWithAWarning) {
  test::Noise noise(21);
  const StateSpaceModel truth = test::random_system(noise, 2, 2, 1);
  Record record = test::excited(truth, noise, 800, 0);
  record.u.col(0).setConstant(0.1);
  record.y = test::simulated(truth, record.u, Vector::Zero(2));
  const Identified found = expect_model(record, record.all());
  EXPECT_THAT(found.warnings, ::testing::Contains(HasSubstr("input 1 is constant")));
  EXPECT_TRUE(found.model.B.col(0).isZero());
  EXPECT_TRUE(found.model.D.col(0).isZero());
  EXPECT_LT(run_error(found, record).mrse(), 1e-3);
}

TEST(Identify, AnInputThatOthersExplainIsNamedAndLeftOut) {
  test::Noise noise(22);
  const StateSpaceModel truth = test::random_system(noise, 2, 3, 1);
  Record record = test::excited(truth, noise, 900, 0);
  record.u.col(2) = record.u.col(0) + record.u.col(1);  // I_BUS = I_SG2 + I_BDROUT
  record.y = test::simulated(truth, record.u, Vector::Zero(2));
  const Identified found = expect_model(record, record.all());
  EXPECT_THAT(
      found.warnings,
      ::testing::Contains(HasSubstr("input 3 is a linear combination of input 1, input 2")));
  EXPECT_TRUE(found.model.B.col(2).isZero());
  EXPECT_LT(run_error(found, record).mrse(), 1e-3) << "the free run loses nothing";
}

TEST(Identify, AnOutputThatDriftsIsMetWhereItIsNow) {
  test::Noise noise(23);
  const StateSpaceModel truth = test::random_system(noise, 2, 1, 1, 0.8);
  Record record = test::excited(truth, noise, 1500, 0.02);
  for (Index k = 0; k < 1500; ++k) record.y(k, 0) += 2e-3 * double(k);
  const Identified found = expect_model(record, {0, 1000});
  const Score later = score_free_run(found.model, record, {0, 1500}, {1000, 1100}, found.x0);
  const Matrix y_hat = free_run(found.model, record, {0, 1100}, found.x0);
  const double bias = (record.y.middleRows(1000, 100) - y_hat.bottomRows(100)).mean();
  EXPECT_LT(std::abs(bias), 0.8) << "the mean of all rows is 1.1 below";
  EXPECT_GT(later.fit(), 0);
}

TEST(Identify, SurvivesHardRecords) {
  test::Noise noise(24);
  const StateSpaceModel truth = test::random_system(noise, 4, 2, 1, 0.999);
  const Record base = test::excited(truth, noise, 1500, 0.02);
  const auto expect_a_stable_model_or_a_verdict = [](const Record& record, const char* what) {
    const IdentifyResult result = identify(record, record.all(), {});
    if (const auto* found = std::get_if<Identified>(&result)) {
      EXPECT_TRUE(is_well_formed(found->model)) << what;
      EXPECT_LT(found->spectral_radius, 1) << what;
    } else {
      EXPECT_FALSE(std::get<Verdict>(result).reason.empty()) << what;
    }
  };
  Record record = base;
  record.y = (base.y.array() * 4).round();
  record.u = (base.u.array() * 4).round();
  expect_a_stable_model_or_a_verdict(record, "quantised to a few levels");
  record = base;
  for (Index k = 1; k < 1500; ++k)
    record.u.row(k) = 0.99 * record.u.row(k - 1) + 0.01 * base.u.row(k);
  record.y = test::simulated(truth, record.u, Vector::Zero(4));
  expect_a_stable_model_or_a_verdict(record, "a strongly coloured input");
  for (Index k = 1; k < 1500; ++k) record.y.row(k) += record.y.row(k - 1);
  expect_a_stable_model_or_a_verdict(record, "an integrator");
  record = base;
  for (Index k = 1; k < 1500; ++k) record.u(k, 0) = -0.5 * record.y(k - 1, 0);
  expect_a_stable_model_or_a_verdict(record, "closed loop");
  record = base;
  record.u.setZero();
  record.u.bottomRows(700).setOnes();
  expect_a_stable_model_or_a_verdict(record, "one step of equal inputs");
  record = base;
  record.u.resize(1500, 0);
  expect_a_stable_model_or_a_verdict(record, "no inputs");
  record = base;
  record.u *= 1e-200;
  record.y *= 1e200;
  expect_a_stable_model_or_a_verdict(record, "extreme units");
  record = base;
  record.segments.clear();
  for (Index k = 0; k < 1500; k += 15) record.segments.push_back({k, k + 15, 2 * k});
  expect_a_stable_model_or_a_verdict(record, "a hundred short segments");
}

/// Made by Octave 7.3 with its control package:
///   s = 1; for k = 1:600, s = mod(16807*s, 2147483647); u(k,1) = s/2147483647 - 0.5;
///                         s = mod(16807*s, 2147483647); v(k,1) = s/2147483647 - 0.5; end
///   y = filter([0 1 0.5], [1 -1.5 0.7], u) + 0.2*v; u = u - mean(u); y = y - mean(y);
///   [sys, x0, info] = n4sid(iddata(y, u, 1), 'n', 2, 's', 10, 'alg', 'q');
///   eig(sys.a), [sys.d, sys.c*sys.b, sys.c*sys.a*sys.b, ...]
TEST(Identify, AgreesWithOctave) {
  Matrix u(600, 1), y(600, 1);
  double s = 1, u1 = 0, u2 = 0, w1 = 0, w2 = 0;
  const auto next = [&s] { return (s = std::fmod(16807 * s, 2147483647)) / 2147483647 - 0.5; };
  for (Index k = 0; k < 600; ++k) {
    u(k, 0) = next();
    const double w = 1.5 * w1 - 0.7 * w2 + u1 + 0.5 * u2;
    y(k, 0) = w + 0.2 * next();
    w2 = w1, w1 = w, u2 = u1, u1 = u(k, 0);
  }
  const Record record = contiguous_record(1, u, y);
  IdentifyOptions options;
  options.order = 2;
  options.horizon = 10;
  options.weighting = Weighting::moesp;  // what Octave's n4sid takes A and C by, without refinement
  options.direct_feedthrough = true;
  options.response_fit = ResponseFit::simulation;
  const Identified found = expect_model(record, record.all(), options);
  const std::complex<double> pole = found.model.A.eigenvalues()(0);
  EXPECT_NEAR(pole.real(), 0.7490465407, 1e-4);
  EXPECT_NEAR(std::abs(pole.imag()), 0.3709234501, 1e-4);
  Matrix octave(1, 6);
  octave << -0.0001487125378, 0.9921811789, 2.00434772, 2.309507184, 2.059509326, 1.471788102;
  EXPECT_LT((test::markov_parameters(found.model, 6) - octave).norm(), 0.02 * octave.norm())
      << "B and D are fitted to the free run here, to the state equation there";
}

}  // namespace
}  // namespace reident::identification::identify_test
