// How often the truth lies within what is said of a static gain, and what no rows show.
#include "identification/fit/gain_uncertainty.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "identification/fit/output_error_fit.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::gain_uncertainty_test {
namespace {

StateSpaceModel fitted(const StateSpaceModel& system, const Record& record) {
  return refine_response(system.A, system.C, true, record, record.all(), 20).model;
}

/// Adds errors that follow their own past by so much.
void add_errors(Record& record, test::Noise& noise, double share, double past) {
  for (Index q = 0; q < record.y.cols(); ++q) {
    const auto y = record.y.col(q);
    const double deviation = share * std::sqrt((y.array() - y.mean()).square().mean());
    double error = 0;
    for (Index row = 0; row < record.rows(); ++row) {
      error = past * error + std::sqrt(1 - past * past) * noise.normal();
      record.y(row, q) += deviation * error;
    }
  }
}

TEST(GainUncertainty, HoldsTheTruthInNineteenOfTwentyRecords) {
  const struct {
    const char* name;
    Index order, inputs, outputs;
    double past;
    double least;  // of the share; errors that last leave few that are independent
  } kinds[] = {{"white", 2, 1, 1, 0, 0.9},
               {"several channels", 3, 2, 2, 0, 0.9},
               {"errors that last", 2, 1, 1, 0.9, 0.8}};
  for (const auto& kind : kinds) {
    int within = 0, gains = 0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      test::Noise noise(seed);
      const StateSpaceModel system =
          test::random_system(noise, kind.order, kind.inputs, kind.outputs);
      Record record = test::excited(system, noise, 600, 0);
      record.segments = {{0, 250, 0}, {250, 600, 5000}};
      add_errors(record, noise, 0.2, kind.past);
      const StateSpaceModel model = fitted(system, record);
      const auto uncertainty = gain_uncertainty(model, true, record, record.all());
      ASSERT_TRUE(uncertainty) << kind.name << " " << seed;
      const Matrix off = *static_gain(model) - *static_gain(system);
      within += static_cast<int>((off.array().abs() <= uncertainty->array()).count());
      gains += static_cast<int>(off.size());
    }
    EXPECT_GE(within, kind.least * gains) << kind.name;
    EXPECT_LE(within, 0.99 * gains) << kind.name;
    RecordProperty(kind.name, std::to_string(within) + " of " + std::to_string(gains));
  }
}

TEST(GainUncertainty, IsInTheUnitsOfTheChannelsAndOfNoBasis) {
  test::Noise noise(3);
  const StateSpaceModel system = test::random_system(noise, 2, 2, 1);
  const Record record = test::excited(system, noise, 800, 0.1);
  const StateSpaceModel model = fitted(system, record);
  const auto before = gain_uncertainty(model, true, record, record.all());

  Record other_units = record;
  other_units.u.col(1) *= 1000;
  other_units.y *= 1e-3;
  StateSpaceModel same = model;
  Matrix basis(2, 2);
  basis << 3, 1, -40, 7;
  same.A = basis * model.A * basis.inverse();
  same.B = basis * model.B;
  same.B.col(1) /= 1000;
  same.C = 1e-3 * model.C * basis.inverse();
  same.D *= 1e-3;
  same.D.col(1) /= 1000;
  same.y0 *= 1e-3;
  const auto after = gain_uncertainty(same, true, other_units, other_units.all());
  ASSERT_TRUE(before && after);
  EXPECT_NEAR((*after)(0, 0), 1e-3 * (*before)(0, 0), 1e-5 * 1e-3 * (*before)(0, 0));
  EXPECT_NEAR((*after)(0, 1), 1e-6 * (*before)(0, 1), 1e-5 * 1e-6 * (*before)(0, 1));
}

TEST(GainUncertainty, OfAnInputThatNeverRestsIsLarge) {
  // Two time constants, 25 and 200 rows, with gains of 0.7 and 0.5.
  test::Noise noise(5);
  StateSpaceModel system = test::random_system(noise, 2, 1, 1);
  system.A << std::exp(-1.0 / 25), 0, 0, std::exp(-1.0 / 200);
  system.B << 1 - system.A(0, 0), 1 - system.A(1, 1);
  system.C << 0.7, 0.5;
  system.D << 0;
  for (const bool rests : {false, true}) {
    Matrix u(2000, 1);
    for (Index row = 0; row < u.rows(); ++row)
      u(row, 0) = (rests ? double(row / 500 % 2) : 0) +
                  std::sin(2 * std::numbers::pi * double(row) / 60) + 0.003 * noise.normal();
    const Record record = contiguous_record(
        1, u, test::simulated(system, u, Vector::Zero(2)) + 0.01 * noise.normal(2000, 1));
    const auto off = gain_uncertainty(fitted(system, record), false, record, record.all());
    ASSERT_TRUE(off);
    if (rests)
      EXPECT_LT((*off)(0, 0), 0.03);
    else
      EXPECT_GT((*off)(0, 0), 0.3);
  }
}

TEST(GainUncertainty, IsAbsentWithoutAGainOrWithoutErrorsToJudge) {
  test::Noise noise(6);
  StateSpaceModel system = test::random_system(noise, 2, 1, 1);
  const Record record = test::excited(system, noise, 100, 0.1);
  EXPECT_FALSE(gain_uncertainty(system, true, record, {0, 4}));
  system.A << 1, 0, 0, 0.5;
  EXPECT_FALSE(static_gain(system));
  EXPECT_FALSE(gain_uncertainty(system, true, record, record.all()));
}

}  // namespace
}  // namespace reident::identification::gain_uncertainty_test
