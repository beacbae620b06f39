#include "tests/support/version_pairs.hpp"

#include <cmath>

#include <Eigen/Dense>

#include "tests/support/systems.hpp"

namespace reident::test {
namespace {

constexpr double operating_point = 3;
constexpr double amplitude = 2;  // of the inputs around it

EquipmentModel named(StateSpaceModel dynamics) {
  EquipmentModel model;
  model.spacecraft = "CBERS4";
  model.equipment = "BDR";
  for (Index i = 0; i < dynamics.inputs(); ++i)
    model.inputs.push_back(
        {"U" + std::to_string(i), "A", operating_point - amplitude, operating_point + amplitude});
  for (Index q = 0; q < dynamics.outputs(); ++q)
    model.outputs.push_back({"Y" + std::to_string(q), "V", 0, 50});
  dynamics.u0.setConstant(operating_point);
  dynamics.y0.setConstant(28);
  model.dynamics = std::move(dynamics);
  model.sample_hold_ns = 1'000'000'000;
  return model;
}

Matrix steady_gain(const StateSpaceModel& model) {
  const Matrix identity = Matrix::Identity(model.order(), model.order());
  return model.C * (identity - model.A).partialPivLu().solve(model.B) + model.D;
}

void perturb(Noise& noise, Matrix& matrix, double share) {
  matrix.array() *= 1 + share * noise.normal(matrix.rows(), matrix.cols()).array();
}

}  // namespace

VersionPair version_pair(std::uint64_t seed) {
  Noise noise(seed);
  const auto up_to = [&noise](Index most) {
    return 1 + static_cast<Index>(noise.uniform() * static_cast<double>(most));
  };
  const Index m = up_to(4), p = up_to(2);
  StateSpaceModel before = random_system(noise, up_to(8), m, p, 0.99);
  StateSpaceModel after = before;
  if (seed % 2 == 0) {
    perturb(noise, after.B, 0.05);
    perturb(noise, after.C, 0.05);
    after.A *= 1 - 0.005 * noise.uniform();
  } else {
    after = random_system(noise, up_to(8), m, p, 0.99);
    Matrix gain = steady_gain(before);
    perturb(noise, gain, 0.3);
    after.D += gain - steady_gain(after);
  }
  VersionPair pair{named(before), named(after)};
  pair.after.dynamics.y0.array() += 0.05 * noise.normal();
  return pair;
}

Vector smooth_input(const VersionPair& pair, std::uint64_t seed, std::int64_t k) {
  const double t = static_cast<double>(k);
  Vector u(pair.before.dynamics.inputs());
  for (Index i = 0; i < u.size(); ++i) {
    const double period =
        150 + 90 * static_cast<double>((seed + 7 * static_cast<std::uint64_t>(i)) % 8);
    const double ramp = std::abs(std::fmod(t / (2.7 * period), 2) - 1) - 0.5;
    u(i) = operating_point + amplitude * (0.6 * std::sin(2 * M_PI * t / period) + 0.6 * ramp);
  }
  return u;
}

}  // namespace reident::test
