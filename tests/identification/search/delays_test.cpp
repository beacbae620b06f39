#include "identification/search/delays.hpp"

#include <complex>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>

#include "identification/search/identify.hpp"
#include "identification/simulation/scores.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::delays_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

StateSpaceModel delayed_system(test::Noise& noise, const std::vector<int>& delays) {
  return with_delay_states(test::random_system(noise, 2, 2, 1, 0.8), delays);
}

TEST(Delays, TheModelOfTheInputsAsTheyAreGivesTheSameOutputs) {
  test::Noise noise(1);
  const StateSpaceModel model = test::random_system(noise, 3, 3, 2);
  const std::vector<int> delays{0, 4, 1};
  const Matrix u = noise.normal(60, 3);
  Matrix shifted = Matrix::Zero(60, 3);
  for (Index i = 0; i < 3; ++i) {
    const Index d = delays[static_cast<std::size_t>(i)];
    shifted.col(i).tail(60 - d) = u.col(i).head(60 - d);
  }
  const StateSpaceModel with_states = with_delay_states(model, delays);
  EXPECT_EQ(with_states.order(), 8);
  const Matrix expected = test::simulated(model, shifted, Vector::Zero(3));
  EXPECT_LT((test::simulated(with_states, u, Vector::Zero(8)) - expected).norm(), 1e-12);
}

TEST(Delays, TheModelWithoutThemIsGivenBack) {
  test::Noise noise(4);
  const std::vector<int> delays{0, 4, 1};
  for (const Index order : {0, 1, 3}) {
    const StateSpaceModel model =
        order == 0
            ? StateSpaceModel{Matrix(0, 0), Matrix(0, 3),    Matrix(2, 0),    noise.normal(2, 3),
                              {},           Vector::Zero(3), Vector::Zero(2), 1}
            : test::random_system(noise, order, 3, 2);
    const StateSpaceModel back = without_delay_states(with_delay_states(model, delays), delays);
    EXPECT_EQ(back.A, model.A);
    EXPECT_EQ(back.B, model.B);
    EXPECT_EQ(back.C, model.C);
    EXPECT_EQ(back.D, model.D);
  }
}

/// Inputs that step now and then drive a system of this order after delays, each of one input.
Record stepped(test::Noise& noise, Index order, const std::vector<int>& delays, Index rows) {
  const Index m = std::ssize(delays);
  StateSpaceModel plant = test::random_system(noise, order, m, 1);
  if (order == 1) plant.A(0, 0) = 0.98;
  plant.D.setZero();
  Matrix u(rows, m);
  for (Index i = 0; i < m; ++i)
    for (Index t = 0; t < rows; ++t)
      u(t, i) = t == 0 || noise.uniform() < 1.0 / 40 ? noise.normal() : u(t - 1, i);
  const StateSpaceModel all = with_delay_states(plant, delays);
  const Matrix clean = test::simulated(all, u, Vector::Zero(all.order()));
  const double deviation = std::sqrt((clean.array() - clean.mean()).square().mean());
  return contiguous_record(1, u, clean + 0.02 * deviation * noise.normal(rows, 1));
}

Identified identified(const Record& record) {
  IdentifyOptions options;
  options.max_input_delay = std::nullopt;
  return std::get<Identified>(identify(record, record.all(), options));
}

TEST(Delays, ADelayIsNotTakenForPoles) {
  int right = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    test::Noise noise(seed);
    const Identified found = identified(stepped(noise, 1, {25}, 900));
    right += found.recipe.order == 1 && !found.input_delays.empty() &&
             std::abs(found.input_delays[0] - 25) <= 1;
  }
  EXPECT_GE(right, 9);
}

/// What a system of one output makes of an input after a delay, with white noise of this share.
Record after_delay(StateSpaceModel plant, const Vector& u, int delay, double noise_share,
                   test::Noise& noise) {
  plant.D.setZero();
  const StateSpaceModel all = with_delay_states(plant, {delay});
  const Vector clean = test::simulated(all, u, Vector::Zero(all.order()));
  const double deviation = std::sqrt((clean.array() - clean.mean()).square().mean());
  return contiguous_record(1, u, clean + noise_share * deviation * noise.normal(u.size(), 1));
}

StateSpaceModel of_poles(const Vector& poles, const Vector& gains) {
  const Index n = poles.size();
  const Vector rates = 1 - poles.array();
  return {poles.asDiagonal(), rates,           gains.transpose(), Matrix::Zero(1, 1),
          Matrix(n, 1),       Vector::Zero(1), Vector::Zero(1),   1};
}

TEST(Delays, OneThatNoPolesImitateIsFound) {
  int right = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    test::Noise noise(seed);
    Vector u = noise.normal(1500, 1);
    for (Index t = 1; t < u.size(); ++t) u(t) += 0.5 * u(t - 1);
    const StateSpaceModel plant = of_poles(Eigen::Vector2d(0.97, 0.8), Eigen::Vector2d(2, -0.5));
    const Identified found = identified(after_delay(plant, u, 50, 0.05, noise));
    right += found.recipe.order == 2 && found.input_delays == std::vector<int>{50};
  }
  EXPECT_EQ(right, 12);
}

/// Steps to random values, so many rows apart on average.
Vector random_steps(test::Noise& noise, Index rows, double apart) {
  Vector u(rows);
  for (Index t = 0; t < rows; ++t)
    u(t) = t == 0 || noise.uniform() < 1 / apart ? noise.uniform() : u(t - 1);
  return u;
}

/// 0 or 1, which may change every so many rows.
Vector binary_on_grid(test::Noise& noise, Index rows, Index grid) {
  Vector u(rows);
  for (Index t = 0; t < rows; ++t) u(t) = t % grid == 0 ? noise.uniform() < 0.5 : u(t - 1);
  return u;
}

StateSpaceModel of_one_pole(double pole) {
  return of_poles(Vector::Constant(1, pole), Vector::Constant(1, 1));
}

/// The record without this share of its rows, chosen at random.
Record with_holes(const Record& record, double share, test::Noise& noise) {
  std::vector<TickRange> ticks;
  for (Index row = 0; row < record.rows(); ++row)
    if (noise.uniform() < share) ticks.push_back({row, row + 1});
  return without(record, united(std::move(ticks)));
}

TEST(Delays, InputsAreKnownBehindShortHoles) {
  const Vector u = Vector::LinSpaced(300, 0, 299);
  test::Noise noise(1);
  const Record whole = contiguous_record(1, u.replicate(1, 2), u);
  const Record holed = with_holes(whole, 0.05, noise);
  const Record shifted = delayed(holed, holed.all(), {25, 0}, 30);
  EXPECT_EQ(shifted.rows(), holed.rows() - first_row_at(holed, 30));
  EXPECT_LT((shifted.u.col(0).array() - (shifted.y.array() - 25)).abs().maxCoeff(), 1e-9);
  EXPECT_EQ(shifted.u.col(1), shifted.y);
  EXPECT_EQ(shifted.segments.front().first_tick, 30);
  const Record known = delayed_to_identify(holed, holed.all(), {25, 0});
  for (Index row = 0; row < known.rows(); ++row) {
    const std::int64_t tick = tick_of_row(known, row);
    EXPECT_EQ(known.u(row, 0), double(tick - 25));
    const auto has = [&](std::int64_t one) {
      return tick_of_row(holed, first_row_at(holed, one)) == one;
    };
    EXPECT_TRUE(has(tick) && has(tick - 25));
  }
  EXPECT_LT(known.rows(), shifted.rows());
  // Many rows whose inputs are unknown stay.
  const Record torn = with_holes(whole, 0.3, noise);
  EXPECT_EQ(delayed_to_identify(torn, torn.all(), {25, 0}).rows(),
            delayed(torn, torn.all(), {25, 0}, 25).rows());
  // Behind a long one they are not: rows are left out anew.
  const Record parted = without(whole, {{100, 200}});
  const Record rest = delayed(parted, parted.all(), {25, 0}, 30);
  EXPECT_EQ(rest.rows(), 70 + 70);
  EXPECT_EQ(rest.segments.back().first_tick, 230);
}

TEST(Delays, OneIsFoundWhereRowsAreMissing) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    test::Noise noise(seed);
    Vector u = random_steps(noise, 2000, 20);
    u += 0.1 * noise.normal(u.size(), 1);
    const Record record = after_delay(of_one_pole(0.983), u, 25, 0.01, noise);
    const Identified found = identified(with_holes(record, 0.04, noise));
    EXPECT_THAT(found.input_delays, ElementsAre(25)) << seed;
    EXPECT_EQ(found.recipe.order, 1) << seed;
  }
}

TEST(Delays, OneIsFoundWhereTheLastRowsAreShortStretches) {
  test::Noise noise(3);
  const Vector u = random_steps(noise, 4000, 15);
  const Record whole = after_delay(of_one_pole(0.9), u, 7, 0.02, noise);
  std::vector<TickRange> holes;
  for (Index row = 1500; row < whole.rows(); row += 200) holes.push_back({row, row + 180});
  const Identified found = identified(without(whole, united(std::move(holes))));
  EXPECT_THAT(found.input_delays, ElementsAre(7));
  EXPECT_EQ(found.recipe.order, 1);
}

TEST(Delays, OneBeyondTheUsualRangeIsFound) {
  // The range of 400 rows is 50, that of 1,300 rows is 60.
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    test::Noise noise(seed);
    const Index rows = seed % 2 == 0 ? 400 : 1300;
    const int delay = seed % 2 == 0 ? 58 : 75;
    const Vector u = random_steps(noise, rows, 15);
    const Identified found = identified(after_delay(of_one_pole(0.9), u, delay, 0.02, noise));
    EXPECT_THAT(found.input_delays, ElementsAre(delay)) << seed;
    EXPECT_EQ(found.recipe.order, 1) << seed;
  }
}

TEST(Delays, OneBeyondTheRangeThatIsAskedForIsTold) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    test::Noise noise(seed);
    const Vector u = random_steps(noise, 600, 15);
    const Record record = after_delay(of_one_pole(0.9), u, 25, 0.02, noise);
    IdentifyOptions options;
    options.max_input_delay = 10;
    const auto found = std::get<Identified>(identify(record, record.all(), options));
    EXPECT_THAT(found.warnings, Contains(HasSubstr("input 1 seems to act after 25 samples")));
    options.max_input_delay = 30;
    const auto in_range = std::get<Identified>(identify(record, record.all(), options));
    EXPECT_THAT(in_range.warnings, Not(Contains(HasSubstr("seems to act"))));
    EXPECT_THAT(in_range.input_delays, ElementsAre(25));
  }
}

TEST(Delays, OneOfOneRowIsNoPole) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    test::Noise noise(seed);
    const Vector u = binary_on_grid(noise, 400, 6);
    const Identified found =
        identified(after_delay(of_one_pole(0.8 + 0.015 * double(seed)), u, 1, 0.03, noise));
    EXPECT_THAT(found.input_delays, ElementsAre(1)) << seed;
    EXPECT_EQ(found.recipe.order, 1) << seed;
  }
}

TEST(Delays, OneBesideAnOscillationIsWhole) {
  // Not a row less, with a pole near 0 in its place.
  int right = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    test::Noise noise(seed);
    StateSpaceModel plant{Matrix::Zero(3, 3),
                          Vector(3),
                          Eigen::RowVector3d(1, 1, 0),
                          Matrix::Zero(1, 1),
                          Matrix(3, 1),
                          Vector::Zero(1),
                          Vector::Zero(1),
                          1};
    const std::complex<double> pair = std::polar(0.85, 0.7);
    plant.A(0, 0) = 0.95;
    plant.A.bottomRightCorner(2, 2) << pair.real(), pair.imag(), -pair.imag(), pair.real();
    plant.B << 0.05, 0.2 * noise.normal(), 0.2;
    const int delay = 5 + static_cast<int>(seed);
    const Vector u = binary_on_grid(noise, 1200, 8);
    const Identified found = identified(after_delay(plant, u, delay, 0.02, noise));
    right += found.input_delays == std::vector<int>{delay} && found.recipe.order == 3;
  }
  EXPECT_GE(right, 11);
}

TEST(Delays, ADutyCycleShowsOne) {
  int simple = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    test::Noise noise(seed);
    Vector u(900);
    for (Index t = 0; t < u.size(); ++t) u(t) = t % 100 < 12;
    const StateSpaceModel plant = of_poles(Vector::Constant(1, 0.97), Vector::Constant(1, 30));
    const Identified found = identified(after_delay(plant, u, 9, 0.01, noise));
    EXPECT_THAT(found.input_delays, ElementsAre(9)) << seed;
    simple += found.recipe.order == 1;
  }
  EXPECT_GE(simple, 7);
}

TEST(Delays, EachInputHasItsOwn) {
  int right = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    test::Noise noise(seed);
    const Identified found = identified(stepped(noise, 2, {25, 8}, 900));
    right += !found.input_delays.empty() && std::abs(found.input_delays[0] - 25) <= 1 &&
             std::abs(found.input_delays[1] - 8) <= 1;
  }
  EXPECT_GE(right, 3);
}

TEST(Delays, OneStepInFortyRowsShowsItsDelay) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    test::Noise noise(seed);
    Matrix u(40, 1), y(40, 1);
    double x = 0;
    for (Index t = 0; t < 40; ++t) {
      u(t) = t >= 10;
      y(t) = 5 + 2 * x + 0.02 * noise.normal();
      x += ((t >= 13) - x) / 6;
    }
    const Identified found = identified(contiguous_record(1, u, y));
    EXPECT_THAT(found.input_delays, ElementsAre(3)) << seed;
    EXPECT_NEAR((*static_gain(found.model))(0, 0), 2, 0.1) << seed;
  }
}

TEST(Delays, PolesAreNotTakenForADelay) {
  const char* asked = std::getenv("REIDENT_RECORDS");
  const std::uint64_t records = asked ? std::strtoull(asked, nullptr, 10) : 6;
  std::uint64_t invented = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    const Index order = 2 + static_cast<Index>(seed % 3);
    invented += !identified(stepped(noise, order, {0}, 500)).input_delays.empty();
  }
  EXPECT_LE(invented, records / 100);
  RecordProperty("invented", std::to_string(invented));
}

TEST(Delays, AreFoundAndBecomeStates) {
  test::Noise noise(3);
  const std::vector<int> delays{7, 0};
  const Record record = test::excited(delayed_system(noise, delays), noise, 1500, 0.02);
  IdentifyOptions options;
  options.max_input_delay = 10;
  options.max_order = 4;
  const IdentifyResult result = identify(record, {0, 1000}, options);
  ASSERT_TRUE(std::holds_alternative<Identified>(result));
  const Identified& found = std::get<Identified>(result);
  EXPECT_THAT(found.input_delays, ElementsAre(7, 0));
  EXPECT_THAT(found.warnings, Contains(HasSubstr("input 1 acts after 7 samples")));
  EXPECT_GT(score_free_run(found.model, record, record.all(), {1000, 1500}, found.x0).fit(), 97);
}

TEST(Delays, ThatAreGivenAreTaken) {
  test::Noise noise(4);
  const std::vector<int> delays{0, 5};
  const Record record = test::excited(delayed_system(noise, delays), noise, 800, 0);
  IdentifyOptions options;
  options.input_delays = delays;
  const IdentifyResult result = identify(record, record.all(), options);
  ASSERT_TRUE(std::holds_alternative<Identified>(result));
  const Identified& found = std::get<Identified>(result);
  EXPECT_EQ(found.recipe.order, 2);
  EXPECT_EQ(found.model.order(), 7);
  EXPECT_GT(score_free_run(found.model, record, record.all(), record.all(), found.x0).fit(), 99.9);
}

TEST(Delays, WhereThereIsNoneNoneIsFound) {
  test::Noise noise(5);
  const Record record = test::excited(test::random_system(noise, 3, 2, 1), noise, 1000, 0.05);
  IdentifyOptions options;
  options.max_input_delay = 4;
  const IdentifyResult result = identify(record, record.all(), options);
  ASSERT_TRUE(std::holds_alternative<Identified>(result));
  EXPECT_TRUE(std::get<Identified>(result).input_delays.empty());
}

}  // namespace
}  // namespace reident::identification::delays_test
