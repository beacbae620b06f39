#include "identification/simulation/continuous.hpp"

#include <cmath>

#include <Eigen/Dense>
#include <gmock/gmock.h>

#include "tests/support/systems.hpp"

namespace reident::identification::continuous_test {
namespace {

using ::testing::HasSubstr;

/// A model of one input and one output, with C of ones and D of zero.
StateSpaceModel single(Matrix A, Matrix B, double period_s) {
  const Index n = A.rows(), m = B.cols();
  return {std::move(A), std::move(B),    Matrix::Ones(1, n), Matrix::Zero(1, m),
          {},           Vector::Zero(m), Vector::Zero(1),    period_s};
}

ContinuousModel converted(const StateSpaceModel& model) {
  auto result = to_continuous(model);
  if (auto* continuous = std::get_if<ContinuousModel>(&result)) return *continuous;
  ADD_FAILURE() << std::get<Verdict>(result).reason;
  return {};
}

std::string refusal(const StateSpaceModel& model) {
  const auto result = to_continuous(model);
  const auto* verdict = std::get_if<Verdict>(&result);
  if (!verdict) return "converted";
  EXPECT_EQ(verdict->code, VerdictCode::no_continuous_time);
  EXPECT_EQ(name(verdict->code), "no_continuous_time");
  return verdict->reason;
}

double distance(const Matrix& a, const Matrix& b) {
  return (a - b).norm() / b.norm();
}

TEST(ContinuousTime, AFirstOrderLagHasItsTimeConstant) {
  // dx/dt = -x/tau + b u, held for T: x[k+1] = a x[k] + (1 - a) tau b u[k], a = exp(-T/tau)
  const double tau = 40, b = 3, T = 8, a = std::exp(-T / tau);
  const ContinuousModel model =
      converted(single(Matrix::Constant(1, 1, a), Matrix::Constant(1, 1, (1 - a) * tau * b), T));
  EXPECT_NEAR(model.A(0, 0), -1 / tau, 1e-15);
  EXPECT_NEAR(model.B(0, 0), b, 1e-12);
}

TEST(ContinuousTime, AnOscillatorIsSampledByItsClosedForm) {
  // x'' + 2 d x' + (d^2 + w^2) x = (d^2 + w^2) u: the step from rest is 1 - e(cos + d/w sin).
  const double d = 0.2, w = 1.5, T = 0.7, stiffness = d * d + w * w;
  ContinuousModel model{Matrix(2, 2),       Matrix(2, 1),    Matrix(1, 2),
                        Matrix::Zero(1, 1), Vector::Zero(1), Vector::Zero(1)};
  model.A << 0, 1, -stiffness, -2 * d;
  model.B << 0, stiffness;
  model.C << 1, 0;
  const StateSpaceModel discrete = to_discrete(model, T);
  const double e = std::exp(-d * T), c = std::cos(w * T), s = std::sin(w * T);
  Matrix A(2, 2), B(2, 1);
  A << e * (c + d / w * s), e * s / w, -stiffness * e * s / w, e * (c - d / w * s);
  B << 1 - e * (c + d / w * s), stiffness * e * s / w;
  EXPECT_LT(distance(discrete.A, A), 1e-14);
  EXPECT_LT(distance(discrete.B, B), 1e-14);
  const ContinuousModel back = converted(discrete);
  EXPECT_LT(distance(back.A, model.A), 1e-13);
  EXPECT_LT(distance(back.B, model.B), 1e-13);
}

TEST(ContinuousTime, SamplesFollowTheDifferentialEquation) {
  test::Noise noise(5);
  const Matrix root = noise.normal(3, 3);
  ContinuousModel model{-root * root.transpose(), noise.normal(3, 2), noise.normal(2, 3),
                        noise.normal(2, 2),       Vector::Zero(2),    Vector::Zero(2)};
  const double T = 0.5;
  const StateSpaceModel discrete = to_discrete(model, T);
  const Vector x0 = noise.normal(3, 1), u = noise.normal(2, 1);
  const int steps = 2000;  // of Runge and Kutta
  const auto slope = [&](const Vector& x) -> Vector { return model.A * x + model.B * u; };
  Vector x = x0;
  for (int i = 0; i < steps; ++i) {
    const double h = T / steps;
    const Vector k1 = slope(x), k2 = slope(x + h / 2 * k1), k3 = slope(x + h / 2 * k2),
                 k4 = slope(x + h * k3);
    x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  EXPECT_LT(distance(discrete.A * x0 + discrete.B * u, x), 1e-10);
}

/// The square of a system's A has the same moduli and no negative real pole.
StateSpaceModel convertible(test::Noise& noise, Index n, Index m, Index p) {
  StateSpaceModel model = test::random_system(noise, n, m, p, 0.999);
  const Matrix basis = noise.normal(n, n).householderQr().householderQ();
  model.A = (basis * model.A * model.A * basis.transpose()).eval();
  model.period_s = 8;
  return model;
}

TEST(ContinuousTime, StableSystemsConvertThereAndBack) {
  test::Noise noise(1);
  for (Index n = 1; n <= 12; ++n)
    for (int trial = 0; trial < 10; ++trial) {
      const StateSpaceModel model = convertible(noise, n, 1 + n % 4, 1 + n % 2);
      const StateSpaceModel back = to_discrete(converted(model), model.period_s);
      EXPECT_LT(distance(back.A, model.A), 1e-10) << n;
      EXPECT_LT(distance(back.B, model.B), 1e-10) << n;
    }
}

TEST(ContinuousTime, UnitsOfTheInputsCostNoDigits) {
  test::Noise noise(2);
  const StateSpaceModel model = convertible(noise, 4, 3, 1);
  StateSpaceModel scaled = model;
  const Vector units = (Vector(3) << 1e9, 1, 1e-9).finished();
  scaled.B *= units.asDiagonal();
  const ContinuousModel plain = converted(model), wide = converted(scaled);
  EXPECT_LT(distance(wide.A, plain.A), 1e-12);
  EXPECT_LT(distance(wide.B * units.cwiseInverse().asDiagonal(), plain.B), 1e-12);
  EXPECT_LT(distance(to_discrete(wide, 8).B, scaled.B), 1e-10);
}

TEST(ContinuousTime, OutputsAndOperatingPointStayAndTheGainIsLeftOut) {
  test::Noise noise(3);
  StateSpaceModel model = convertible(noise, 3, 2, 2);
  model.K = noise.normal(3, 2);
  model.u0 << 4, -7;
  model.y0 << 28, 3;
  const ContinuousModel continuous = converted(model);
  EXPECT_EQ(continuous.C, model.C);
  EXPECT_EQ(continuous.D, model.D);
  EXPECT_EQ(continuous.u0, model.u0);
  EXPECT_EQ(continuous.y0, model.y0);
  const StateSpaceModel back = to_discrete(continuous, 2);
  EXPECT_EQ(back.K.size(), 0);
  EXPECT_EQ(back.period_s, 2);
  EXPECT_EQ(back.y0, model.y0);
}

TEST(ContinuousTime, AnIntegratorIntegrates) {
  // x[k+1] = x[k] + T b u[k]
  const ContinuousModel model =
      converted(single(Matrix::Ones(1, 1), Matrix::Constant(1, 1, 0.5 * 0.3), 0.5));
  EXPECT_NEAR(model.A(0, 0), 0, 1e-15);
  EXPECT_NEAR(model.B(0, 0), 0.3, 1e-15);
}

TEST(ContinuousTime, ADoubleIntegratorKeepsItsChain) {
  Matrix A(2, 2), B(2, 1);
  A << 1, 2, 0, 1;  // T = 2
  B << 2, 2;        // T^2 / 2, T
  const ContinuousModel model = converted(single(A, B, 2));
  Matrix chain(2, 2), drive(2, 1);
  chain << 0, 1, 0, 0;
  drive << 0, 1;
  EXPECT_LT((model.A - chain).norm(), 1e-12);
  EXPECT_LT((model.B - drive).norm(), 1e-12);
}

TEST(ContinuousTime, ADoublePoleConverts) {
  Matrix A(2, 2), B(2, 1);
  A << 0.8, 1, 0, 0.8;
  B << 0, 1;
  const StateSpaceModel model = single(A, B, 1);
  const ContinuousModel continuous = converted(model);
  Matrix logarithm(2, 2);
  logarithm << std::log(0.8), 1 / 0.8, 0, std::log(0.8);
  EXPECT_LT(distance(continuous.A, logarithm), 1e-12);
  EXPECT_LT(distance(to_discrete(continuous, 1).B, B), 1e-12);
}

TEST(ContinuousTime, AnUnstableSystemConvertsToo) {
  const ContinuousModel model =
      converted(single(Matrix::Constant(1, 1, 1.5), Matrix::Ones(1, 1), 1));
  EXPECT_NEAR(model.A(0, 0), std::log(1.5), 1e-15);
}

TEST(ContinuousTime, OrderZeroIsTheSameInBoth) {
  StateSpaceModel model = single(Matrix(0, 0), Matrix(0, 2), 3);
  model.D << 5, 6;
  const StateSpaceModel back = to_discrete(converted(model), 3);
  EXPECT_EQ(back.order(), 0);
  EXPECT_EQ(back.D, model.D);
}

TEST(ContinuousTime, AModelWithoutInputsConverts) {
  const ContinuousModel model = converted(single(Matrix::Constant(1, 1, 0.5), Matrix(1, 0), 2));
  EXPECT_NEAR(model.A(0, 0), std::log(0.5) / 2, 1e-15);
  EXPECT_EQ(model.B.cols(), 0);
}

TEST(NoContinuousTime, ForANegativeRealPole) {
  Matrix A = Matrix::Identity(3, 3) * 0.9;
  A(1, 1) = -0.3412;
  const std::string reason = refusal(single(A, Matrix::Ones(3, 1), 1));
  EXPECT_THAT(reason, HasSubstr("the pole at -0.3412 turns its sign"));
  EXPECT_THAT(reason, HasSubstr("discrete-time model"));
}

TEST(NoContinuousTime, ForAPairOfEqualNegativePoles) {
  EXPECT_THAT(refusal(single(Matrix::Identity(2, 2) * -0.5, Matrix::Ones(2, 1), 1)),
              HasSubstr("-0.5"));
}

TEST(NoContinuousTime, ForAPoleAtZeroOrNextToIt) {
  for (const double pole : {0.0, 3e-12, -3e-12}) {
    Matrix A = Matrix::Identity(2, 2) * 0.9;
    A(0, 0) = pole;
    EXPECT_THAT(refusal(single(A, Matrix::Ones(2, 1), 1)), HasSubstr("gone within one sample"));
  }
}

TEST(NoContinuousTime, ForADelayOfWholeSamples) {
  Matrix A = Matrix::Zero(3, 3);
  A(0, 1) = A(1, 2) = 1;
  EXPECT_THAT(refusal(single(A, Matrix::Ones(3, 1), 1)), HasSubstr("gone within one sample"));
}

TEST(NoContinuousTime, WhereTheLogarithmIsNotAccurate) {
  // Near a Jordan block on the negative axis the logarithm grows without bound.
  Matrix A(2, 2);
  A << -0.5, 1, -1e-12, -0.5;
  EXPECT_THAT(refusal(single(A, Matrix::Ones(2, 1), 1)), HasSubstr("sampled again, miss"));
}

}  // namespace
}  // namespace reident::identification::continuous_test
