// The order that is there, on simulated records: no mode is invented, and none that shows is lost.
#include "identification/search/parsimony.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ostream>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "identification/numerics/decompositions.hpp"
#include "identification/search/folds.hpp"
#include "identification/search/identify.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::parsimony_test {
namespace {

Identified identified(const Record& record, const IdentifyOptions& options = {}) {
  return std::get<Identified>(identify(record, record.all(), options));
}

StateSpaceModel static_gain(test::Noise& noise, Index m, Index p) {
  return {Matrix(0, 0), Matrix(0, m),    Matrix(p, 0),    noise.normal(p, m),
          {},           Vector::Zero(m), Vector::Zero(p), 1};
}

/// Whether the model has a mode that lasts longer than 20 rows where the system has none near it.
bool has_invented_mode(const StateSpaceModel& model, const StateSpaceModel& system) {
  const ComplexVector there = eigenvalues(system.A);
  for (const auto& pole : eigenvalues(model.A))
    if (std::abs(pole) > 0.95 && !((there.array() - pole).abs() < 0.05).any()) return true;
  return false;
}

struct Kind {
  std::string name;
  Index order, inputs, outputs, rows;
  double noise_share;
};

void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

/// REIDENT_RECORDS, or 20.
std::uint64_t records_asked() {
  const char* asked = std::getenv("REIDENT_RECORDS");
  return asked ? std::strtoull(asked, nullptr, 10) : 20;
}

class Parsimony : public testing::TestWithParam<Kind> {};

TEST_P(Parsimony, TheOrderThatIsThereIsChosenInNineOfTenRecords) {
  const std::uint64_t records = records_asked();
  const Kind& kind = GetParam();
  std::uint64_t right = 0, invented = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    const StateSpaceModel system =
        kind.order == 0 ? static_gain(noise, kind.inputs, kind.outputs)
                        : test::random_system(noise, kind.order, kind.inputs, kind.outputs);
    const Record record = test::excited(system, noise, kind.rows, kind.noise_share);
    const Identified found = identified(record);
    right += found.recipe.order == static_cast<int>(kind.order);
    invented += has_invented_mode(found.model, system);
  }
  EXPECT_GE(right, records * 9 / 10);
  EXPECT_LE(invented, records / 100);
  RecordProperty("right", std::to_string(right));
}

INSTANTIATE_TEST_SUITE_P(Simulated, Parsimony,
                         testing::Values(Kind{"OneStateLongRecord", 1, 1, 1, 1500, 0.003},
                                         Kind{"OneStateShortRecord", 1, 2, 1, 300, 0.02},
                                         Kind{"StaticGain", 0, 2, 1, 500, 0.05},
                                         Kind{"StaticGainsOfTwoOutputs", 0, 2, 2, 1000, 0.01},
                                         Kind{"StaticGainWithoutNoise", 0, 1, 2, 120, 0},
                                         Kind{"ThreeStates", 3, 2, 2, 1500, 0.005}),
                         [](const auto& kind) { return kind.param.name; });

// Each segment has a state of its own, which takes from the errors of its rows.
TEST(Parsimony, ManyShortSegmentsGetNoMoreStatesThanOneRecord) {
  const std::uint64_t records = records_asked();
  for (const Index rows : {8, 12, 20}) {
    std::uint64_t right = 0;
    for (std::uint64_t seed = 1; seed <= records; ++seed) {
      test::Noise noise(seed);
      const Index order = 1 + Index(seed % 2);
      const StateSpaceModel system = test::random_system(noise, order, 1, 1);
      Record record = test::excited(system, noise, 800 / rows * rows, 0.02);
      record.segments.clear();
      for (Index k = 0; k < record.rows(); k += rows)
        record.segments.push_back({k, k + rows, 1000 * k});
      right += identified(record).recipe.order == static_cast<int>(order);
    }
    EXPECT_GE(right, records * 9 / 10) << rows;
    RecordProperty("right_of_" + std::to_string(rows), std::to_string(right));
  }
}

/// A coarse sensor's steps follow the output: a step of the input has the same stairs each time,
/// which states imitate.
TEST(Parsimony, StepsOfASensorGetNoStates) {
  const std::uint64_t records = records_asked();
  for (const double step : {0.25, 0.05}) {
    std::uint64_t right = 0;
    for (std::uint64_t seed = 1; seed <= records; ++seed) {
      test::Noise noise(seed);
      Record record{1, Matrix(1500, 1), Matrix(1500, 1), {{0, 1500, 0}}};
      double u = 0, state = 0;
      for (Index t = 0; t < 1500; ++t) {
        if (noise.uniform() < 1.0 / 30) u = 1 - u;
        record.u(t, 0) = u;
        record.y(t, 0) = step * std::round((5 + state) / step);
        state = 0.95 * state + 0.1 * u;
      }
      right += identified(record).recipe.order == 1;
    }
    EXPECT_GE(right, records * 9 / 10) << step;
    RecordProperty("right_of_" + std::to_string(step), std::to_string(right));
  }
}

TEST(Parsimony, AnOrderThatIsAskedForIsKept) {
  test::Noise noise(1);
  const Record record = test::excited(static_gain(noise, 1, 1), noise, 500, 0.05);
  for (const int order : {0, 1, 3}) {
    IdentifyOptions options;
    options.order = order;
    EXPECT_EQ(identified(record, options).recipe.order, order);
  }
}

TEST(Parsimony, AModelWithoutStatesIsTheStaticGain) {
  test::Noise noise(2);
  const StateSpaceModel system = static_gain(noise, 2, 2);
  IdentifyOptions options;
  options.order = 0;
  const Identified found = identified(test::excited(system, noise, 400, 0), options);
  EXPECT_EQ(found.model.order(), 0);
  EXPECT_EQ(found.x0.size(), 0);
  EXPECT_LT((found.model.D - system.D).norm(), 1e-9);
  EXPECT_EQ(found.spectral_radius, 0);
}

/// An output of a static gain, with errors that last: each is 0.9 of the one before and noise.
Record with_lasting_errors(const StateSpaceModel& system, test::Noise& noise, Index rows,
                           double share) {
  Record record = test::excited(system, noise, rows, 0);
  Vector error = noise.normal(rows, 1);
  for (Index t = 1; t < rows; ++t) error(t) = 0.9 * error(t - 1) + 0.4359 * error(t);
  record.y.col(0) += share * error;
  return record;
}

TEST(Parsimony, AFitOfTheTrueOrderIsRefutedAsOftenAsChanceSays) {
  constexpr int records = 200;
  for (const bool lasting : {false, true}) {
    int refuted = 0;
    for (std::uint64_t seed = 1; seed <= records; ++seed) {
      test::Noise noise(seed);
      const StateSpaceModel system = static_gain(noise, 1, 1);
      const Record record = lasting ? with_lasting_errors(system, noise, 300, 0.1)
                                    : test::excited(system, noise, 300, 0.1);
      const auto static_fit =
          fit_response(Matrix(0, 0), Matrix(1, 0), true, record, record.all(), Accuracy::fast);
      const auto one_state = refine_response(Matrix::Constant(1, 1, 0.5), Matrix::Ones(1, 1), true,
                                             record, record.all(), 25);
      refuted += RicherFit(one_state, true, record, record.all()).refutes(static_fit, true, 3);
    }
    // At 99 %, over all places that the pole of a mode which is not there may have.
    EXPECT_LE(refuted, records / 100) << lasting;
  }
}

/// The record with another sensor of its output: a scale, an offset and noise of its own.
Record with_second_sensor(Record record, test::Noise& noise, double noise_share) {
  record.y.conservativeResize(record.rows(), 2);
  record.y.col(1) = 2.5 * (record.y.col(0) + noise_share * noise.normal(record.rows(), 1));
  return record;
}

TEST(Parsimony, ASecondSensorOfTheSameIsNoFurtherEvidence) {
  const auto most_extra = [](const Record& record) {
    const Index p = record.y.cols();
    const auto simple =
        fit_response(Matrix(0, 0), Matrix(p, 0), true, record, record.all(), Accuracy::fast);
    const auto rich = refine_response(Matrix::Constant(1, 1, 0.5), Matrix::Ones(p, 1), true, record,
                                      record.all(), 25);
    const RicherFit richer(rich, true, record, record.all());
    Index extra = 0;
    while (richer.refutes(simple, true, extra + 1)) ++extra;
    return extra;
  };
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    test::Noise noise(seed);
    const Record one = test::excited(test::random_system(noise, 1, 1, 1), noise, 60, 0.5);
    const Index alone = most_extra(one);
    EXPECT_GT(alone, 3) << seed;
    EXPECT_EQ(most_extra(with_second_sensor(one, noise, 0)), alone) << seed;
    EXPECT_NEAR(double(most_extra(with_second_sensor(one, noise, 1e-4))), double(alone),
                double(alone) / 3)
        << seed;
  }
}

TEST(Parsimony, OutputsThatAreNearlyLinearInOneAnotherGetNoMoreStates) {
  for (const double noise_share : {0.0, 1e-4}) {
    test::Noise noise(1006);
    const StateSpaceModel system = test::random_system(noise, 3, 1, 1);
    const Record one = test::excited(system, noise, 500, 0.003);
    EXPECT_EQ(identified(with_second_sensor(one, noise, noise_share)).recipe.order, 3)
        << noise_share;
  }
}

TEST(Parsimony, ErrorsThatLastGetNoStates) {
  constexpr int records = 8;
  int right = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    const StateSpaceModel system = test::random_system(noise, 2, 1, 1);
    right += identified(with_lasting_errors(system, noise, 300, 0.1)).recipe.order == 2;
  }
  EXPECT_GE(right, records * 3 / 4);
}

TEST(Parsimony, ARandomWalkGetsNoStates) {
  const std::uint64_t records = records_asked();
  std::uint64_t right = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    const Matrix u = noise.normal(150, 1).replicate(1, 6).transpose().reshaped(900, 1);
    StateSpaceModel plant = test::random_system(noise, 1, 1, 1, 0.9);
    Record record = contiguous_record(1, u, test::simulated(plant, u, Vector::Zero(1)));
    const double deviation = std::sqrt((record.y.array() - record.y.mean()).square().mean());
    double walk = 0;
    for (Index t = 0; t < record.rows(); ++t) {
      walk += 0.01 * deviation * noise.normal();
      record.y(t, 0) += walk + 0.02 * deviation * noise.normal();
    }
    right += identified(record).recipe.order == 1;
  }
  EXPECT_GE(right, records * 4 / 5);
  RecordProperty("right", std::to_string(right));
}

TEST(Parsimony, FitsThatKnowHowErrorsLastAreNearerToTheTruth) {
  constexpr int records = 20;
  double gained = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    const StateSpaceModel system = test::random_system(noise, 2, 1, 1);
    const Record record = with_lasting_errors(system, noise, 400, 0.3);
    const auto plain = refine_response(system.A, system.C, true, record, record.all(), 25);
    const auto colours = colours_of(plain, record, record.all());
    EXPECT_NEAR(colours[0].past.coefficients.back()(0), 0.9, 0.25);
    const auto white = refine_whitened(plain, true, record, record.all(), 10, colours);
    gained += std::log(test::markov_distance(plain.model, system) /
                       test::markov_distance(white.model, system));
  }
  EXPECT_GT(std::exp(gained / records), 1.3);
}

/// A record of one state, whose outputs drift by random walks of their own. With `slow_rate` above
/// 0 the input drives another state of that rate [1/row].
Record drifting(test::Noise& noise, Index rows, double slow_rate) {
  Matrix u = noise.normal(rows, 1), y(rows, 2);
  Eigen::RowVector2d walk = Eigen::RowVector2d::Zero();
  double fast = 0, slow = 0;
  for (Index t = 0; t < rows; ++t) {
    walk += 0.03 * noise.normal(1, 2);
    y.row(t) = walk + 0.1 * noise.normal(1, 2);
    y(t, 0) += fast + (slow_rate > 0 ? slow : 0);
    y(t, 1) -= fast;
    fast = 0.6 * fast + u(t, 0);
    slow = std::exp(-slow_rate) * slow + 0.1 * u(t, 0);
  }
  return contiguous_record(1, std::move(u), std::move(y));
}

TEST(Parsimony, ADriftIsTakenForASlowModeAsOftenAsChanceSays) {
  constexpr int records = 100;
  constexpr Index rows = 500;
  int drifts = 0, modes = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    const auto shows = [&](double slow_rate) {
      test::Noise noise(seed);
      const Record record = drifting(noise, rows, slow_rate);
      const Response fit = fit_response(Matrix::Constant(1, 1, 0.6), Matrix{{1}, {-1}}, true,
                                        record, record.all(), Accuracy::fast);
      return drives_slow_modes(fit, record, record.all(), 3.0 / rows);
    };
    drifts += shows(0);
    modes += shows(2.0 / rows);
  }
  EXPECT_LE(drifts, 5);
  EXPECT_GE(modes, 99);
}

/// A sum of an input in steps of random heights, or a random walk beside it.
Record summed_or_walking(test::Noise& noise, bool is_sum) {
  const Matrix u = noise.normal(16, 1).replicate(1, 30).transpose().reshaped(480, 1);
  Matrix y(480, 1);
  double x = 0;
  for (Index t = 0; t < y.rows(); ++t) {
    y(t) = 50 + x;
    x += is_sum ? u(t) : noise.normal();
  }
  const double deviation = std::sqrt((y.array() - y.mean()).square().mean());
  return contiguous_record(1, u, y + 0.02 * deviation * noise.normal(480, 1));
}

TEST(Parsimony, NoDriftIsForetoldBySumsOfTheInputs) {
  constexpr int records = 100;
  int drifts = 0, sums = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    const auto is_foretold = [&](bool is_sum) {
      test::Noise noise(seed);
      const Record record = summed_or_walking(noise, is_sum);
      const std::vector<Fold> folds = folds_of(record.rows(), 0.3);
      return held_out_error_of_sums(record, folds, {0, 6.28 / 480}) <
             0.5 * held_out_error_of_sums(record, folds, {});
    };
    drifts += is_foretold(false);
    sums += is_foretold(true);
  }
  EXPECT_LE(drifts, 5);
  EXPECT_GE(sums, 99);
  RecordProperty("drifts", std::to_string(drifts));
  RecordProperty("sums", std::to_string(sums));
}

/// The charge that an array of 5 A in sunlight, in seven orbits of 95 rows, a bus load in steps and
/// a constant one that nobody measures leave in a battery.
Record charged(test::Noise& noise) {
  constexpr Index rows = 665, in_sun = 59, orbit = 95;
  const auto phase = static_cast<Index>(orbit * std::abs(noise.normal()));
  Matrix u(rows, 2), y(rows, 1);
  const double unmeasured = 2 * noise.normal();
  double charge = 50, load = 0;
  for (Index t = 0; t < rows; ++t) {
    if (t == 0 || noise.normal() > 1.645) load = 3.1 + 0.17 * noise.normal();
    u.row(t) << load, (t + phase) % orbit < in_sun ? 5.0 : 0.0;
    y(t) = charge;
    charge += u(t, 1) - u(t, 0) - unmeasured;
  }
  const double deviation = std::sqrt((y.array() - y.mean()).square().mean());
  return contiguous_record(1, u, y + 0.01 * deviation * noise.normal(rows, 1));
}

TEST(Parsimony, AnIntegratorIsNoStaticGain) {
  const std::uint64_t records = records_asked();
  std::uint64_t right = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    const Record record = charged(noise);
    const auto found = identify(record, {0, 443}, {});
    const auto* model = std::get_if<Identified>(&found);
    right += model && model->recipe.order == 1 && model->spectral_radius > 0.999;
  }
  EXPECT_GE(right, records * 19 / 20);
  RecordProperty("right", std::to_string(right));
}

/// One state, with a disturbance that oscillates by itself: a generator of two states.
TEST(Parsimony, AnOscillationByItselfGetsTwoStates) {
  const std::uint64_t records = records_asked();
  constexpr Index rows = 1500;
  std::uint64_t right = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    Matrix u(rows, 1), y(rows, 1);
    const double pole = std::exp(-1 / (8 + 32 * noise.uniform()));
    double x = 0;
    for (Index t = 0; t < rows; ++t) {
      u(t, 0) = t % 7 == 0 ? noise.normal() : u(t - 1, 0);
      y(t, 0) = x;
      x = pole * x + (1 - pole) * u(t, 0);
    }
    const double deviation = std::sqrt((y.array() - y.mean()).square().mean());
    const double phase = 6 * noise.uniform();
    for (Index t = 0; t < rows; ++t)
      y(t, 0) += deviation * (0.3 * std::sin(0.1 * double(t) + phase) + 0.1 * noise.normal());
    right += identified(contiguous_record(1, u, y)).recipe.order == 3;
  }
  EXPECT_GE(right, records * 19 / 20);
  RecordProperty("right", std::to_string(right));
}

TEST(Parsimony, AModeThatStandsForADriftIsSaid) {
  int said = 0, without_drift = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto warns = [&](double drift) {
      test::Noise noise(seed);
      const Matrix u = noise.normal(500, 1);
      Matrix y = Vector::LinSpaced(500, 0, drift) + 0.05 * noise.normal(500, 1);
      double x = 0;
      for (Index t = 0; t < 500; ++t) {
        y(t) += x;
        x = 0.9 * x + 0.4 * u(t);
      }
      const auto found = identified(contiguous_record(1, u, y));
      return std::ranges::any_of(found.warnings, [](const std::string& warning) {
        return warning.find("as slow as these rows can show") != std::string::npos;
      });
    };
    said += warns(5);
    without_drift += warns(0);
  }
  EXPECT_GE(said, 1);
  EXPECT_EQ(without_drift, 0);
}

TEST(Parsimony, ADriftGetsNoStatesAndASlowModeKeepsItsOwn) {
  constexpr int records = 4;
  int right = 0, kept = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    right += !(identified(drifting(noise, 500, 0)).spectral_radius > std::exp(-6.2 / 500));
    kept += identified(drifting(noise, 500, 2.0 / 500)).spectral_radius > 0.98;
  }
  EXPECT_GE(right, records - 1);
  EXPECT_EQ(kept, records);
}

}  // namespace
}  // namespace reident::identification::parsimony_test
