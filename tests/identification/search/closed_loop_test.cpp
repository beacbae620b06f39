// Records of closed loops: what the inputs do by themselves is found, and no model is given that
// is the controller's.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <variant>

#include <gmock/gmock.h>

#include "identification/numerics/decompositions.hpp"
#include "identification/search/identify.hpp"
#include "identification/statistics/feedback.hpp"
#include "identification/subspace/ssarx.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::closed_loop_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// x[t+1] = a x[t] + b u[t] + w[t], y = x + v, u[t] = gain (r[t] - y[t-1]) with a reference r that
/// steps now and then.
struct Loop {
  double a, b, gain;
  double reference_size = 1, disturbance = 0.05, sensor_noise = 0.01;
};

Record recorded(const Loop& loop, test::Noise& noise, Index rows, double input_noise = 0) {
  Matrix u(rows, 1), y(rows, 1);
  double x = 0, r = 0;
  for (Index t = 0; t < rows; ++t) {
    if (t % 40 == 0) r = loop.reference_size * noise.normal();
    y(t) = x + loop.sensor_noise * noise.normal();
    u(t) = loop.gain * (r - (t > 0 ? y(t - 1) : 0)) + input_noise * noise.normal();
    x = loop.a * x + loop.b * u(t) + loop.disturbance * noise.normal();
  }
  return contiguous_record(1, u, y);
}

TEST(ClosedLoop, AnUnstablePlantThatAControllerHoldsGivesNoModel) {
  int given = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::Noise noise(seed);
    const Record record = recorded({1.08, 0.5, 0.6}, noise, 800);
    const IdentifyResult result = identify(record, record.all(), {});
    const auto* verdict = std::get_if<Verdict>(&result);
    given += !verdict;
    if (verdict && verdict->code == VerdictCode::closed_loop) {
      EXPECT_THAT(verdict->reason, HasSubstr("input 1 follows output 1"));
    }
  }
  EXPECT_EQ(given, 0);
}

TEST(ClosedLoop, ARegulatorThatOnlyFightsDisturbancesGivesNoModelOfItsOwnGain) {
  // A shunt regulator: hardly any reference, so that inputs and outputs show its gain.
  int of_the_controller = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::Noise noise(seed);
    const Record record = recorded({0.9, -0.3, -1.5, 0.02, 0.3}, noise, 1500);
    const IdentifyResult result = identify(record, record.all(), {});
    if (const auto* found = std::get_if<Identified>(&result)) {
      const StateSpaceModel& model = found->model;
      const Index n = model.order();
      const double gain =
          n == 0 ? model.D(0, 0)
                 : (model.C * solve_full_lu(Matrix(Matrix::Identity(n, n) - model.A), model.B) +
                    model.D)(0, 0);
      of_the_controller += gain > 0;
    }
  }
  EXPECT_EQ(of_the_controller, 0);
}

/// A heater that is on where the temperature fell below 19 until it has risen above 21, with an
/// environment that changes slowly. At rest the heater adds 20.
Record thermostat(test::Noise& noise, Index rows) {
  Matrix u(rows, 1), y(rows, 1);
  double temperature = 20, environment = 0;
  bool is_on = false;
  for (Index t = 0; t < rows; ++t) {
    y(t) = temperature + 0.02 * noise.normal();
    is_on = y(t) < 19 || (is_on && y(t) < 21);
    u(t) = is_on;
    environment = 0.995 * environment + 0.1 * noise.normal();
    temperature += (10 + environment + 20 * is_on - temperature) / 150 + 0.01 * noise.normal();
  }
  return contiguous_record(1, u, y);
}

TEST(ClosedLoop, AThermostatIsToldWithBothResponses) {
  int told = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    test::Noise noise(seed);
    const Record record = thermostat(noise, 1500);
    const IdentifyResult result = identify(record, record.all(), {});
    const auto* found = std::get_if<Identified>(&result);
    told += found ? std::ranges::any_of(found->warnings,
                                        [](const std::string& warning) {
                                          return warning.find("a method for closed loops") !=
                                                 std::string::npos;
                                        })
                  : std::get<Verdict>(result).code == VerdictCode::closed_loop;
  }
  EXPECT_GE(told, 7);
}

TEST(ClosedLoop, AModelWithAFractionOfTheHeatersEffectIsRefused) {
  constexpr int records = 20;
  constexpr Index rows = 150;  // of the step
  const double truth = 20 * (1 - std::exp(-1));
  int misleading = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    const Record record = thermostat(noise, 1500);
    const IdentifyResult result = identify(record, record.all(), {});
    const auto* found = std::get_if<Identified>(&result);
    if (!found) continue;
    StateSpaceModel model = found->model;
    model.u0.setZero();
    model.y0.setZero();
    const Matrix step = test::simulated(model, Matrix::Ones(rows, 1), Vector::Zero(model.order()));
    misleading += step(rows - 1) < truth / 4;
  }
  EXPECT_LE(misleading, 2);
  RecordProperty("misleading", misleading);
}

/// The environment swings by a quarter of what the heater adds at rest, unmeasured. The heater is
/// never on for long, so that the rows show what a step of it begins and not where it ends.
Record thermostat_in_swings(test::Noise& noise, Index rows, double swing_rows) {
  Matrix u(rows, 1), y(rows, 1);
  double temperature = 20;
  bool is_on = false;
  for (Index t = 0; t < rows; ++t) {
    is_on = temperature < 19.5 || (is_on && temperature < 20.5);
    y(t) = temperature + 0.02 * noise.normal();
    u(t) = is_on;
    const double environment = 5 + 5 * std::sin(2 * std::numbers::pi * double(t) / swing_rows);
    temperature += (environment + 30 * is_on - temperature) / 60;
  }
  return contiguous_record(1, u, y);
}

TEST(ClosedLoop, AHeaterDoesNotCool) {
  int cooling = 0, verdicts = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::Noise noise(seed);
    const Record record = thermostat_in_swings(noise, 3000, seed % 2 == 0 ? 800 : 2000);
    const IdentifyResult result = identify(record, record.all(), {});
    if (const auto* found = std::get_if<Identified>(&result)) {
      const auto gain = static_gain(found->model);
      cooling += gain && (*gain)(0, 0) < 0;
    } else {
      verdicts += std::get<Verdict>(result).code == VerdictCode::closed_loop;
    }
  }
  EXPECT_EQ(cooling, 0);
  EXPECT_GE(verdicts, 15);
}

TEST(ClosedLoop, PolesOfThePlantAreFoundWhereItIsUnstable) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    test::Noise noise(seed);
    const Record record = recorded({1.08, 0.5, 0.6}, noise, 3000);
    const auto loop = loop_model(record, record.all(), 12, 6);
    ASSERT_TRUE(loop.has_value());
    EXPECT_EQ(loop->model.order(), 1);
    EXPECT_NEAR(spectral_radius(loop->model.A), 1.08, 0.02);
  }
}

/// What the plant makes of the recorded inputs alone.
Matrix of_inputs(const Loop& loop, const Record& record) {
  const StateSpaceModel plant{Matrix::Constant(1, 1, loop.a),
                              Matrix::Constant(1, 1, loop.b),
                              Matrix::Ones(1, 1),
                              Matrix::Zero(1, 1),
                              {},
                              Vector::Zero(1),
                              Vector::Zero(1),
                              1};
  return test::simulated(plant, record.u, Vector::Zero(1));
}

TEST(ClosedLoop, FeedbackIsFound) {
  const Loop loop{0.9, 0.3, 0.5};
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    test::Noise noise(seed);
    const Record closed = recorded(loop, noise, 800);
    found += !feedback_of(closed, closed.all(), 12, of_inputs(loop, closed)).empty();
  }
  EXPECT_GE(found, 48);
}

/// 1 for a third of each orbit, 0 else, with noise; rows x 1.
Matrix sunlight(test::Noise& noise, Index rows) {
  const auto orbit = static_cast<Index>(60 + 80 * noise.uniform());
  const auto phase = static_cast<Index>(100 * noise.uniform());
  Matrix u = 0.02 * noise.normal(rows, 1);
  for (Index t = 0; t < rows; ++t) u(t) += (t + phase) % orbit < orbit / 3;
  return u;
}

TEST(ClosedLoop, AnOpenLoopHasNoFeedbackWhateverTheRhythmOfItsInput) {
  // At a level of 1e-3. Without of_inputs one of ten rhythms would be taken for feedback.
  const char* asked = std::getenv("REIDENT_RECORDS");
  const std::uint64_t records = asked ? std::strtoull(asked, nullptr, 10) : 200;
  std::uint64_t invented = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    const StateSpaceModel plant = test::random_system(noise, 2, 1, 1, 0.97);
    const Matrix u = seed % 2 == 0 ? sunlight(noise, 300) : noise.normal(300, 1);
    const Matrix alone = test::simulated(plant, u, noise.normal(2, 1));
    const Record open = contiguous_record(1, u, alone + 0.05 * noise.normal(300, 1));
    invented += !feedback_of(open, open.all(), 12, alone).empty();
  }
  EXPECT_LE(invented, 1 + records / 1000);
  RecordProperty("invented", std::to_string(invented));
}

TEST(ClosedLoop, APeriodicInputIsNoFeedbackOfAModelThatMissesTheDeadTime) {
  // Such as a heater's duty cycle. Without its own values a period ago all of them would be.
  int invented = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    test::Noise noise(seed);
    const auto period = static_cast<Index>(30 + 60 * noise.uniform());
    const auto dead = static_cast<Index>(20 + 30 * noise.uniform());
    Matrix u(900, 1), y(900, 1);
    double x = 0;
    for (Index t = 0; t < 900; ++t) {
      u(t) = t % period < period / 2;
      y(t) = x + 0.01 * noise.normal();
      x = 0.9 * x + 0.1 * (t < dead ? 0 : u(t - dead));
    }
    const Record record = contiguous_record(1, u, y);
    invented += !feedback_of(record, record.all(), 12, Matrix::Zero(900, 1)).empty();
  }
  EXPECT_EQ(invented, 0);
}

TEST(ClosedLoop, AnInputOnAGridIsNoFeedbackOfAModelThatMissesTheDeadTime) {
  // When such an input may change next is known from rows further back than most controllers look.
  int invented = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    test::Noise noise(seed);
    const auto dead = static_cast<Index>(5 + 20 * noise.uniform());
    Matrix u(1500, 1), y(1500, 1);
    double slow = 0, fast = 0;
    for (Index t = 0; t < 1500; ++t) {
      u(t) = t % 8 == 0 ? noise.uniform() < 0.5 : u(t - 1);
      y(t) = slow - fast + 0.01 * noise.normal();
      const double late = t < dead ? 0 : u(t - dead);
      slow = 0.95 * slow + 0.05 * late;
      fast = 0.7 * fast + 0.2 * late;
    }
    const Record record = contiguous_record(1, u, y);
    IdentifyOptions options;
    options.max_input_delay = std::nullopt;
    const IdentifyResult result = identify(record, record.all(), options);
    const auto* found = std::get_if<Identified>(&result);
    invented += !found || std::ranges::any_of(found->warnings, [](const std::string& warning) {
      return warning.find("follows output") != std::string::npos;
    });
  }
  EXPECT_LE(invented, 1);
}

TEST(ClosedLoop, FeedbackIsFoundBesideAPeriodicReference) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::Noise noise(seed);
    Matrix u(900, 1), y(900, 1);
    double x = 0;
    for (Index t = 0; t < 900; ++t) {
      y(t) = x + 0.05 * noise.normal();
      u(t) = 0.5 * ((t % 50 < 25 ? 1 : -1) - (t > 0 ? y(t - 1) : 0));
      x = 0.9 * x + 0.3 * u(t) + 0.05 * noise.normal();
    }
    const Record record = contiguous_record(1, u, y);
    found += !feedback_of(record, record.all(), 12, Matrix::Zero(900, 1)).empty();
  }
  EXPECT_EQ(found, 20);
}

TEST(ClosedLoop, AnOutputThatIsReadLaterInTheRowThanItsCommandIsNoController) {
  // The command steps at any time; where it does between the two, the output shows it a row before.
  constexpr Index parts = 20, rows = 3000;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    test::Noise noise(seed);
    const Index later = seed % 2 == 0 ? 10 : 15;
    const double tau = seed % 3 == 0 ? 2 : 0.5, a = std::exp(-1 / (tau * parts));
    Matrix u(rows, 1), y(rows, 1);
    double x = 0, command = 0;
    for (Index part = 0; part < rows * parts; ++part) {
      if (noise.uniform() < 0.1 / parts) command = noise.normal();
      if (part % parts == 0) u(part / parts) = command;
      if (part % parts == later) y(part / parts) = x + 0.04 * noise.normal();
      x = a * x + 2 * (1 - a) * command;
    }
    const Record record = contiguous_record(1, u, y);
    const IdentifyResult result = identify(record, record.all(), {});
    const auto* found = std::get_if<Identified>(&result);
    ASSERT_NE(found, nullptr) << seed << ": " << std::get<Verdict>(result).reason;
    EXPECT_NEAR((*static_gain(found->model))(0, 0), 2, 0.1) << seed;
    EXPECT_THAT(found->warnings, Contains(HasSubstr("not sampled at one time"))) << seed;
    EXPECT_THAT(found->warnings, Not(Contains(HasSubstr("closed loop")))) << seed;
  }
}

TEST(ClosedLoop, AStablePlantWithTheRightGainKeepsItsModelWithAWarning) {
  test::Noise noise(1);
  const Record record = recorded({0.8, 0.4, 0.3}, noise, 3000, 0.03);
  const IdentifyResult result = identify(record, record.all(), {});
  const auto* found = std::get_if<Identified>(&result);
  ASSERT_NE(found, nullptr) << std::get<Verdict>(result).reason;
  EXPECT_THAT(found->warnings,
              Contains(AllOf(HasSubstr("input 1 follows output 1"), HasSubstr("a closed loop"))));
  EXPECT_NEAR(found->spectral_radius, 0.8, 0.03);
}

TEST(ClosedLoop, AWorseSensorOfAnInputIsNotFlatlyCalledOne) {
  const StateSpaceModel plant{Matrix::Constant(1, 1, 0.9),
                              Matrix::Constant(1, 1, 0.1),
                              Matrix::Ones(1, 1),
                              Matrix::Zero(1, 1),
                              {},
                              Vector::Zero(1),
                              Vector::Zero(1),
                              1};
  int suspected = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    test::Noise noise(seed);
    Matrix u = noise.normal(1000, 1);
    for (Index t = 1; t < u.rows(); ++t) u(t) = 0.95 * u(t - 1) + 0.3 * u(t);
    const Matrix y = test::simulated(plant, u, Vector::Zero(1)) + 0.01 * noise.normal(1000, 1);
    const Record record = contiguous_record(1, u + 0.25 * noise.normal(1000, 1), y);
    const IdentifyResult result = identify(record, record.all(), {});
    const auto* found = std::get_if<Identified>(&result);
    ASSERT_NE(found, nullptr) << std::get<Verdict>(result).reason;
    EXPECT_THAT(found->warnings, Not(Contains(HasSubstr("closed loop: ")))) << seed;
    suspected += std::ranges::any_of(found->warnings, [](const std::string& warning) {
      return warning.find("the sensor of input 1") != std::string::npos;
    });
  }
  EXPECT_GE(suspected, 1);
}

}  // namespace
}  // namespace reident::identification::closed_loop_test
