// Outputs that drift by themselves: what is found of the equipment all the same, and that nothing
// is taken for a drift that is none.
#include "identification/search/drift.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/systems.hpp"

namespace reident::identification::drift_test {
namespace {

constexpr Index rows = 2400;

/// A lag of 25 rows and gain 1, driven by levels in [-1, 1] that last 40 rows in the mean.
struct Lag {
  Matrix u{rows, 1}, y{rows, 1};

  explicit Lag(test::Noise& noise, double pole = std::exp(-1.0 / 25)) {
    double state = 0;
    for (Index t = 0; t < rows; ++t) {
      u(t, 0) = t == 0 || noise.uniform() < 1.0 / 40 ? 2 * noise.uniform() - 1 : u(t - 1, 0);
      y(t, 0) = state;
      state = pole * state + (1 - pole) * u(t, 0);
    }
  }
};

struct Kind {
  const char* name;
  double size;                               // the outputs swing by 2
  double (*at)(double share, double phase);  // of a drift that goes from 0 to about 1
};

const Kind kinds[] = {
    {"ramp", 4, [](double share, double) { return share; }},
    {"season", 1, [](double share, double phase) { return 0.5 * std::sin(4.4 * share + phase); }},
    {"settling", 4, [](double share, double) { return std::exp(-3 * share); }},
};

Matrix drift(const Kind& kind, double size, test::Noise& noise) {
  const double phase = 6 * noise.uniform();
  Matrix result(rows, 1);
  for (Index t = 0; t < rows; ++t) result(t, 0) = size * kind.at(double(t) / rows, phase);
  return result + 0.02 * noise.normal(rows, 1);
}

/// By how much the step response of an output over 150 rows is wrong, of that of the lag.
double response_error(const StateSpaceModel& model, Index output) {
  Vector state = Vector::Zero(model.order());
  double error = 0, size = 0;
  for (int t = 0; t < 150; ++t) {
    const double truth = 1 - std::exp(-t / 25.0);
    const double found = (model.C * state + model.D.col(0))(output);
    error += (found - truth) * (found - truth);
    size += truth * truth;
    state = (model.A * state + model.B.col(0)).eval();
  }
  return std::sqrt(error / size);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

TEST(Drift, DoesNotSpoilTheResponse) {
  for (const Kind& kind : kinds) {
    std::vector<double> errors;
    for (std::uint64_t seed = 1; seed <= 9; ++seed) {
      test::Noise noise(seed);
      const Lag lag(noise);
      const Record record = contiguous_record(1, lag.u, lag.y + drift(kind, kind.size, noise));
      const auto result = identify(record, record.all(), {});
      const auto* found = std::get_if<Identified>(&result);
      errors.push_back(found ? response_error(found->model, 0) : 1);
    }
    EXPECT_LT(median(errors), 0.03) << kind.name;
    RecordProperty(kind.name, std::to_string(median(errors)));
  }
}

TEST(Drift, OfOneOutputSpoilsNoOther) {
  int removed = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    test::Noise noise(seed);
    const Lag lag(noise);
    Record record = contiguous_record(1, lag.u, lag.y.replicate(1, 2));
    record.y.col(0) += 0.02 * noise.normal(rows, 1);
    record.y.col(1) += drift(kinds[0], 10, noise);
    IdentifyOptions options;
    options.output_names = {"calm", "drifting"};
    const auto found = std::get<Identified>(identify(record, record.all(), options));
    EXPECT_LT(response_error(found.model, 0), 0.03) << seed;
    if (found.recipe.drift_half_periods == 0) continue;
    ++removed;
    ASSERT_FALSE(found.warnings.empty());
    EXPECT_EQ(found.warnings.back().rfind("drifting moved slowly", 0), 0U) << found.warnings.back();
  }
  EXPECT_GE(removed, 1);
}

TEST(Drift, IsFoundBesideHolesAndWithRowsForChoicesAlone) {
  int removed = 0;
  std::vector<double> errors;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    test::Noise noise(seed);
    const Lag lag(noise);
    Record record = contiguous_record(1, lag.u, lag.y + drift(kinds[0], 6, noise));
    record.segments = {{0, 700, 0}, {700, 1500, 720}, {1500, rows, 1900}};
    IdentifyOptions options;
    options.tune_rows = 600;
    const auto result = identify(record, record.all(), options);
    const auto* found = std::get_if<Identified>(&result);
    errors.push_back(found ? response_error(found->model, 0) : 1);
    if (!found || found->recipe.drift_half_periods == 0) continue;
    ++removed;
    EXPECT_EQ(found->input_min(0), record.u.topRows(rows - 600).minCoeff());
  }
  EXPECT_GE(removed, 3);
  EXPECT_LT(median(errors), 0.1);
}

TEST(Drift, IsNeitherNoiseNorSlowEquipment) {
  const struct {
    const char* name;
    double pole, noise;
  } cases[] = {{"white noise", std::exp(-1.0 / 25), 0.3},
               {"slow", std::exp(-1.0 / 600), 0.02},
               {"an integrator", 1 - 1e-9, 0.02}};
  for (const auto& c : cases)
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      test::Noise noise(seed);
      const Lag lag(noise, c.pole);
      const double deviation = std::sqrt((lag.y.array() - lag.y.mean()).square().mean());
      const Record record =
          contiguous_record(1, lag.u, lag.y + c.noise * deviation * noise.normal(rows, 1));
      const auto result = identify(record, record.all(), {});
      ASSERT_TRUE(std::holds_alternative<Identified>(result)) << c.name << " " << seed;
      EXPECT_EQ(std::get<Identified>(result).recipe.drift_half_periods, 0) << c.name << " " << seed;
    }
}

}  // namespace
}  // namespace reident::identification::drift_test
