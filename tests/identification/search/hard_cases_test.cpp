// Hard records, each with the free run that a good tool reaches on rows that it has not seen.
//
// The measure is the free run of the true system, from its true state, against the same measured
// rows: what noise and quantisation leave of a perfect model. Each case says how many percent of
// fit the identified model may stay behind it.
#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "identification/search/identify.hpp"
#include "identification/simulation/scores.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::hard_cases_test {
namespace {

/// Rows of the record and the true system's own free run over them. The first two thirds identify.
struct Scenario {
  Record record;
  Matrix truth;

  RowRange seen() const { return {0, record.rows() * 2 / 3}; }
  RowRange unseen() const { return {record.rows() * 2 / 3, record.rows()}; }
};

struct HardCase {
  std::string name;
  double allowance;  // [% of fit] that the model may stay behind the truth
  std::function<Scenario(test::Noise&)> make;
};

void PrintTo(const HardCase& hard_case, std::ostream* out) {
  *out << hard_case.name;
}

double deviation(const Matrix& channel) {
  return (channel.array() - channel.mean()).matrix().norm() / std::sqrt(double(channel.size()));
}

Scenario measured(const StateSpaceModel& system, const Matrix& u, double noise_share,
                  test::Noise& noise) {
  const Matrix truth = test::simulated(system, u, Vector::Zero(system.order()));
  Matrix y = truth;
  for (Index q = 0; q < y.cols(); ++q)
    y.col(q) += noise_share * deviation(truth.col(q)) * noise.normal(y.rows(), 1);
  return {contiguous_record(system.period_s, u, y), truth};
}

/// y[k] = a y[k-1] + (1 - a) x[k] of each column.
Matrix low_pass(Matrix x, double a) {
  for (Index k = 1; k < x.rows(); ++k) x.row(k) = a * x.row(k - 1) + (1 - a) * x.row(k);
  return x;
}

/// White levels, each held for `rows` rows, as a telecommand holds them.
Matrix held_levels(test::Noise& noise, Index rows, Index inputs, Index held) {
  const Matrix levels = noise.normal((rows + held - 1) / held, inputs);
  Matrix u(rows, inputs);
  for (Index k = 0; k < rows; ++k) u.row(k) = levels.row(k / held);
  return u;
}

/// One block of A for each pole (real, or a pair by modulus and angle), driven and seen alike.
struct Pole {
  double modulus, angle = 0;
};
StateSpaceModel system_of(test::Noise& noise, const std::vector<Pole>& poles, Index inputs,
                          Index outputs = 1) {
  Index n = 0;
  for (const Pole& pole : poles) n += pole.angle == 0 ? 1 : 2;
  StateSpaceModel system{Matrix::Zero(n, n),
                         noise.normal(n, inputs),
                         noise.normal(outputs, n),
                         0.3 * noise.normal(outputs, inputs),
                         {},
                         Vector::Zero(inputs),
                         Vector::Zero(outputs),
                         1};
  Index i = 0;
  for (const Pole& pole : poles) {
    const double re = pole.modulus * std::cos(pole.angle), im = pole.modulus * std::sin(pole.angle);
    const Index size = pole.angle == 0 ? 1 : 2;
    if (size == 1)
      system.A(i, i) = re;
    else
      system.A.block<2, 2>(i, i) << re, im, -im, re;
    // Each mode moves the output by about as much as the others do.
    system.B.middleRows(i, size) *=
        std::sqrt(1 - pole.modulus * pole.modulus) / system.B.middleRows(i, size).norm();
    for (Index q = 0; q < outputs; ++q)
      system.C.block(q, i, 1, size) /= system.C.block(q, i, 1, size).norm();
    i += size;
  }
  return system;
}

/// 256 levels over the range of each column.
Matrix with_8_bits(Matrix channels) {
  for (Index c = 0; c < channels.cols(); ++c) {
    const double low = channels.col(c).minCoeff();
    const double step = (channels.col(c).maxCoeff() - low) / 255;
    channels.col(c) = ((channels.col(c).array() - low) / step).round() * step + low;
  }
  return channels;
}

Scenario strongly_coloured(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.9}, {0.8, 0.6}}, 2);
  return measured(system, low_pass(noise.normal(6000, 2), 0.99), 0.02, noise);
}

Scenario twice_low_passed(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.95}, {0.7}}, 2);
  return measured(system, low_pass(low_pass(noise.normal(9000, 2), 0.95), 0.95), 0.02, noise);
}

Scenario lightly_damped(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.999, 0.3}, {0.999, 1.2}}, 1);
  return measured(system, noise.normal(9000, 1), 0.02, noise);
}

Scenario near_integrator(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.9995}, {0.6}}, 2);
  return measured(system, noise.normal(9000, 2), 0.02, noise);
}

Matrix with_sum(const Matrix& u) {
  Matrix all(u.rows(), 3);
  all << u, u.rowwise().sum();
  return all;
}

Scenario kirchhoff_exact(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.9}, {0.8, 0.6}}, 3);
  return measured(system, with_sum(noise.normal(3000, 2)), 0.05, noise);
}

Scenario kirchhoff_but_for_noise(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.9}, {0.8, 0.6}}, 3);
  Matrix u = with_sum(noise.normal(3000, 2));
  u.col(2) += 1e-3 * noise.normal(3000, 1);
  return measured(system, u, 0.05, noise);
}

Scenario eight_bits(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.95}, {0.8, 0.6}}, 2);
  Scenario s = measured(system, noise.normal(3000, 2), 0, noise);
  s.record.u = with_8_bits(s.record.u);
  s.record.y = with_8_bits(s.record.y);
  return s;
}

Scenario a_few_levels(test::Noise& noise) {
  // A bus voltage that its converter shows in some ten levels.
  const StateSpaceModel system = system_of(noise, {{0.95}, {0.7}}, 1);
  Scenario s = measured(system, held_levels(noise, 6000, 1, 20), 0, noise);
  const double step = deviation(s.record.y) / 2;
  s.record.y = (s.record.y.array() / step).round() * step;
  return s;
}

Scenario large_offsets(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.95}, {0.8, 0.6}}, 2);
  Scenario s = measured(system, noise.normal(3000, 2), 0.02, noise);
  s.record.u.array() += 1e6;
  s.record.y.array() -= 1e6;
  s.truth.array() -= 1e6;
  return s;
}

Scenario closed_loop(test::Noise& noise) {
  // u = r - 3 y of the sample before: through it the noise reaches the input, and methods that take
  // future inputs as given are biased. The free run of the truth takes the same inputs.
  StateSpaceModel system = system_of(noise, {{0.95}, {0.5}}, 1);
  system.B << 0.05, 0.2;
  system.C << 0.6, 1;
  system.D.setZero();
  const Index rows = 6000;
  const Matrix r = noise.normal(rows, 1), e = 0.05 * noise.normal(rows, 1);
  Scenario s{contiguous_record(1, Matrix(rows, 1), Matrix(rows, 1)), Matrix(rows, 1)};
  Vector x = Vector::Zero(2);
  double fed_back = 0;
  for (Index k = 0; k < rows; ++k) {
    s.record.u(k, 0) = r(k, 0) - 3 * fed_back;
    s.truth(k, 0) = (system.C * x)(0);
    fed_back = s.record.y(k, 0) = s.truth(k, 0) + e(k, 0);
    x = system.A * x + system.B * s.record.u(k, 0);
  }
  return s;
}

Scenario noise_free(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.98}, {0.9, 0.4}, {0.8, 1.5}}, 2, 2);
  return measured(system, noise.normal(1500, 2), 0, noise);
}

Scenario many_short_segments(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.9}, {0.8, 0.6}}, 2);
  Scenario s = measured(system, noise.normal(6000, 2), 0.05, noise);
  // Passes of 40 rows, 10 rows apart.
  std::vector<Index> rows;
  s.record.segments.clear();
  for (Index pass = 0; pass < 120; ++pass) {
    s.record.segments.push_back({40 * pass, 40 * (pass + 1), 50 * pass});
    for (Index k = 0; k < 40; ++k) rows.push_back(50 * pass + k);
  }
  s.record.u = Matrix(s.record.u(rows, Eigen::all));
  s.record.y = Matrix(s.record.y(rows, Eigen::all));
  s.truth = Matrix(s.truth(rows, Eigen::all));
  return s;
}

Scenario different_scales(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.95}, {0.8, 0.6}}, 3, 2);
  Scenario s = measured(system, noise.normal(3000, 3), 0.02, noise);
  s.record.u.col(0) *= 1e-9;
  s.record.u.col(1) *= 1e9;
  s.record.y.col(0) *= 1e9;
  s.record.y.col(1) *= 1e-9;
  s.truth.col(0) *= 1e9;
  s.truth.col(1) *= 1e-9;
  return s;
}

Scenario slow_at_a_fast_rate(test::Noise& noise) {
  // Time constants of 300 and 1000 samples, commands held for 200.
  const StateSpaceModel system =
      system_of(noise, {{std::exp(-1 / 300.0)}, {std::exp(-1 / 1000.0)}}, 2);
  return measured(system, held_levels(noise, 24000, 2, 200), 0.02, noise);
}

Scenario two_time_scales(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{std::exp(-1.0)}, {std::exp(-1 / 1000.0)}}, 2);
  return measured(system, held_levels(noise, 24000, 2, 5), 0.02, noise);
}

Scenario on_and_off(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.97}, {0.8}}, 2);
  Matrix u = held_levels(noise, 6000, 2, 25);
  u = (u.array() > 0).cast<double>();
  return measured(system, u, 0.05, noise);
}

Scenario dead_time(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.9}, {0.6}}, 1);
  const Index rows = 6000, delay = 5;
  const Matrix u = noise.normal(rows + delay, 1);
  Scenario s = measured(system, u.topRows(rows), 0.05, noise);
  s.record.u = u.bottomRows(rows);  // y[k] answers u[k - delay]
  return s;
}

Scenario drifting_zero(test::Noise& noise) {
  // Over all rows the zero moves by as much as the output's own deviation. The truth here takes the
  // zero to be where it stood on average in the later half of the rows to identify from.
  const StateSpaceModel system = system_of(noise, {{0.9}, {0.8, 0.6}}, 2);
  Scenario s = measured(system, noise.normal(4500, 2), 0.02, noise);
  const double drift = deviation(s.truth) / double(s.record.rows());
  for (Index k = 0; k < s.record.rows(); ++k) s.record.y(k, 0) += drift * double(k);
  s.truth.array() += drift * 0.75 * double(s.seen().end);
  return s;
}

Scenario a_clock_as_an_input(test::Noise& noise) {
  const StateSpaceModel system = system_of(noise, {{0.9}, {0.6}}, 1);
  Scenario s = measured(system, held_levels(noise, 2000, 1, 30), 0.01, noise);
  s.record.u.conservativeResize(2000, 2);
  for (Index k = 0; k < 2000; ++k) s.record.u(k, 1) = double(k);
  return s;
}

Scenario smooth_until_it_steps(test::Noise& noise) {
  // The second input is a slow sine to a millionth while the model is identified. What a step of it
  // does is not in these rows but as far as the sine shows both modes.
  const StateSpaceModel system = system_of(noise, {{0.95}, {0.8}}, 2);
  Matrix u = held_levels(noise, 2100, 2, 30);
  for (Index k = 0; k < u.rows(); ++k) {
    u(k, 1) = std::round(1e6 * std::sin(double(k) / 50)) / 1e6;
    if (k >= 1600 && k < 1700) u(k, 1) += 1;
  }
  return measured(system, u, 0.01, noise);
}

const HardCase cases[] = {
    {"strongly_coloured_inputs", 0.1, strongly_coloured},
    {"inputs_low_passed_twice", 0.1, twice_low_passed},
    {"resonances_of_modulus_0_999", 0.1, lightly_damped},
    {"near_integrator", 0.1, near_integrator},
    {"inputs_that_obey_kirchhoff_exactly", 0.1, kirchhoff_exact},
    {"inputs_that_obey_kirchhoff_but_for_noise", 0.1, kirchhoff_but_for_noise},
    {"eight_bits", 0.5, eight_bits},
    {"an_output_of_a_few_levels", 0.5, a_few_levels},
    {"offsets_a_million_times_the_signal", 0.1, large_offsets},
    {"closed_loop", 0.1, closed_loop},
    {"noise_free", 0.001, noise_free},
    {"many_short_segments", 0.5, many_short_segments},
    {"scales_1e18_apart", 0.1, different_scales},
    // Octave's n4sid stays behind by 13.7, 9.9 and 5.4 with the true order and 10, 30 and 60 block
    // rows.
    {"slow_system_at_a_fast_rate", 0.5, slow_at_a_fast_rate},
    {"time_scales_of_1_and_1000_samples", 0.1, two_time_scales},
    {"inputs_switched_on_and_off", 0.1, on_and_off},
    {"dead_time", 0.1, dead_time},
    {"a_zero_that_drifts", 2, drifting_zero},
    {"a_clock_as_an_input", 0.2, a_clock_as_an_input},
    {"an_input_that_is_smooth_until_it_steps", 20, smooth_until_it_steps},
};

class HardCases : public ::testing::TestWithParam<HardCase> {};

TEST_P(HardCases, FreeRunOnUnseenRowsIsNearlyThatOfTheTruth) {
  test::Noise noise(41);
  const Scenario s = GetParam().make(noise);
  const IdentifyResult result = identify(s.record, s.seen(), {});
  if (const auto* verdict = std::get_if<Verdict>(&result))
    FAIL() << name(verdict->code) << ": " << verdict->reason;
  const auto& found = std::get<Identified>(result);
  EXPECT_LT(found.spectral_radius, 1);
  const RowRange unseen = s.unseen();
  const Score own = score_free_run(found.model, s.record, s.record.all(), unseen, found.x0);
  const Score best = score(s.record.y.middleRows(unseen.begin, unseen.size()),
                           s.truth.middleRows(unseen.begin, unseen.size()));
  EXPECT_GE(own.fit(), best.fit() - GetParam().allowance)
      << "order " << found.recipe.order << ", horizon " << found.recipe.horizon << ", "
      << name(found.recipe.weighting) << ", the truth's own fit " << best.fit();
}

INSTANTIATE_TEST_SUITE_P(Synthetic, HardCases, ::testing::ValuesIn(cases),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace reident::identification::hard_cases_test
