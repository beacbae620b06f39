#include <cmath>
#include <cstdio>

#include <Eigen/Dense>

#include "tests/bench/identification/modes.hpp"
#include "tests/bench/identification/samples.hpp"
#include "tests/support/systems.hpp"

namespace reident::bench {
namespace {

using identification::Index;
using identification::Matrix;
using identification::StateSpaceModel;
using identification::Vector;
using test::Noise;

constexpr Index inputs = 4;

/// Order 4: a resonance of period 21 rows that loses 2 % a row, and two lags of 10 and 3 rows.
StateSpaceModel plant() {
  StateSpaceModel model;
  const double radius = 0.98, angle = 0.3;
  model.A = Matrix::Zero(4, 4);
  model.A.topLeftCorner(2, 2) << radius * std::cos(angle), radius * std::sin(angle),
      -radius * std::sin(angle), radius * std::cos(angle);
  model.A(2, 2) = 0.9;
  model.A(3, 3) = 0.7;
  model.B.resize(4, inputs);
  model.B << 0.10, 0.04, -0.06, 0.02,  //
      0.03, -0.08, 0.05, 0.04,         //
      0.25, 0.10, 0.05, -0.15,         //
      -0.2, 0.40, 0.10, 0.30;
  model.C.resize(1, 4);
  model.C << 1, 0.5, 0.8, 0.6;
  model.D.resize(1, inputs);
  model.D << 0.1, 0, 0.05, 0;
  model.u0 = Vector::Zero(inputs);
  model.y0 = Vector::Zero(1);
  model.period_s = 1;
  return model;
}

/// Levels that hold for 20 to 200 rows, under a little noise: a switched load.
void switched(Eigen::Ref<Vector> u, Noise& noise) {
  double level = 0;
  Index left = 0;
  for (Index t = 0; t < u.size(); ++t) {
    if (left-- == 0) {
      level = noise.normal();
      left = 20 + static_cast<Index>(180 * noise.uniform());
    }
    u(t) = level + 0.2 * noise.normal();
  }
}

/// First-order coloured noise of deviation 1.
void coloured(Eigen::Ref<Vector> u, Noise& noise, double memory) {
  double value = noise.normal();
  for (Index t = 0; t < u.size(); ++t) {
    u(t) = value;
    value = memory * value + std::sqrt(1 - memory * memory) * noise.normal();
  }
}

/// Inputs and the noisy output side by side (rows x 5).
Matrix telemetry(Index rows, double noise_share, Noise& noise) {
  Matrix values(rows, inputs + 1);
  switched(values.col(0), noise);
  switched(values.col(1), noise);
  coloured(values.col(2), noise, 0.9);
  coloured(values.col(3), noise, 0.5);
  const Vector y = test::simulated(plant(), values.leftCols(inputs), Vector::Zero(4)).col(0);
  const double deviation = std::sqrt((y.array() - y.mean()).square().mean());
  for (Index t = 0; t < rows; ++t)
    values(t, inputs) = y(t) + noise_share * deviation * noise.normal();
  return values;
}

void write_rows(const std::filesystem::path& file, const Matrix& values) {
  Samples samples{values.rows(), inputs, 1, {}};
  samples.values.assign(values.data(), values.data() + values.size());
  write_samples(file, samples);
}

}  // namespace

void add_generate(CLI::App& app) {
  struct Arguments {
    std::filesystem::path file, unseen_file;
    Index rows = 0, unseen_rows = 0;
    double noise_share = 0.1;
    std::uint64_t seed = 1;
  };
  const auto given = std::make_shared<Arguments>();
  CLI::App* mode = app.add_subcommand(
      "generate", "Simulated telemetry of an order-4 system with 4 inputs and 1 output");
  mode->add_option("file", given->file, "rows to identify from")->required();
  mode->add_option("unseen_file", given->unseen_file, "the rows that follow them")->required();
  mode->add_option("--rows", given->rows)->required()->check(CLI::PositiveNumber);
  mode->add_option("--unseen-rows", given->unseen_rows)->required()->check(CLI::PositiveNumber);
  mode->add_option("--noise-share", given->noise_share, "noise over the output's own deviation");
  mode->add_option("--seed", given->seed);
  mode->callback([given] {
    Noise noise(given->seed);
    const Matrix values = telemetry(given->rows + given->unseen_rows, given->noise_share, noise);
    write_rows(given->file, values.topRows(given->rows));
    write_rows(given->unseen_file, values.bottomRows(given->unseen_rows));
    std::printf("{\"rows\": %td, \"unseen_rows\": %td}\n", given->rows, given->unseen_rows);
  });
}

}  // namespace reident::bench
