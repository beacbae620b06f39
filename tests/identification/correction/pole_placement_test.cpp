#include "identification/correction/pole_placement.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <gmock/gmock.h>

#include "identification/correction/least_norm_block.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::pole_placement_test {
namespace {

/// Largest distance between wanted poles and those of A, each matched to one of the other.
double mismatch(const Matrix& A, Poles wanted) {
  double largest = 0;
  for (const auto& pole : poles_of(A)) {
    const auto nearest = std::min_element(
        wanted.begin(), wanted.end(),
        [&pole](const auto& a, const auto& b) { return std::abs(a - pole) < std::abs(b - pole); });
    largest = std::max(largest, std::abs(*nearest - pole));
    wanted.erase(nearest);
  }
  return largest;
}

PolePlacement placed(const Matrix& A, const Matrix& B, const Poles& wanted) {
  const auto result = place_poles(A, B, wanted);
  if (const auto* placement = std::get_if<PolePlacement>(&result)) return *placement;
  ADD_FAILURE() << std::get<Verdict>(result).reason;
  return {Matrix::Zero(B.cols(), A.rows()), {}};
}

/// Poles inside the unit circle, some of them pairs, no two nearer than 0.05.
Poles random_poles(test::Noise& noise, std::size_t count) {
  Poles poles;
  while (poles.size() < count) {
    std::complex<double> pole(1.8 * noise.uniform() - 0.9, 0);
    if (poles.size() + 2 <= count && noise.uniform() < 0.5) pole.imag(0.05 + 0.4 * noise.uniform());
    const bool apart = std::none_of(poles.begin(), poles.end(), [&pole](const auto& other) {
      return std::abs(other - pole) < 0.05;
    });
    if (!apart) continue;
    poles.push_back(pole);
    if (pole.imag() != 0) poles.push_back(std::conj(pole));
  }
  return poles;
}

TEST(PolePlacement, PutsThePolesOfRandomSystemsWhereTheyAreWanted) {
  test::Noise noise(1);
  for (Index m = 1; m <= 4; ++m)
    for (Index n = 1; n <= 12; ++n)
      for (int trial = 0; trial < 20; ++trial) {
        const Matrix A = noise.normal(n, n) / std::sqrt(double(n)), B = noise.normal(n, m);
        const Poles wanted = random_poles(noise, static_cast<std::size_t>(n));
        const PolePlacement placement = placed(A, B, wanted);
        EXPECT_TRUE(placement.uncontrollable.empty());
        const Matrix closed = A - B * placement.gain;
        // With one input the gain is what it is, large where many poles move far, and rounding in
        // A moves them back as far as their condition says.
        EXPECT_LT(mismatch(closed, wanted), m > 1 ? 1e-8 : n < 11 ? 1e-7 : 1e-3) << m << ' ' << n;
      }
}

TEST(PolePlacement, PutsRepeatedPolesAsOftenAsWanted) {
  test::Noise noise(2);
  for (Index m = 1; m <= 4; ++m)
    for (Index n = 2; n <= 6; ++n) {
      const Matrix A = noise.normal(n, n), B = noise.normal(n, m);
      const Poles wanted(static_cast<std::size_t>(n), 0.5);
      const Matrix closed = A - B * placed(A, B, wanted).gain;
      // The n-th root of the rounding is what a chain of n equal poles can be known to; the
      // characteristic polynomial is known better.
      Matrix power = Matrix::Identity(n, n);
      for (Index i = 0; i < n; ++i)
        power = (power * (closed - 0.5 * Matrix::Identity(n, n))).eval();
      EXPECT_LT(power.norm(), 1e-8 * std::pow(1 + closed.norm(), double(n))) << m << ' ' << n;
    }
}

TEST(PolePlacement, MovesEqualPolesApart) {
  // A multiple of I has one mode for each input, however many states there are.
  const Matrix A = 0.5 * Matrix::Identity(4, 4);
  test::Noise noise(3);
  const Matrix B = noise.normal(4, 3);
  const PolePlacement placement = placed(A, B, {{0.1, 0.2}, {0.1, -0.2}, 0.3, 0.4});
  ASSERT_EQ(placement.uncontrollable.size(), 1U);
  EXPECT_NEAR(placement.uncontrollable[0].real(), 0.5, 1e-15);
  const Poles poles = poles_of(A - B * placement.gain);
  EXPECT_EQ(std::count_if(poles.begin(), poles.end(), [](auto z) { return z.imag() != 0; }), 2);
}

TEST(PolePlacement, MovesAChainOfEqualPoles) {
  Matrix A = 0.5 * Matrix::Identity(4, 4), B = Matrix::Zero(4, 1);
  A.diagonal(1).setOnes();
  B(3) = 1;
  const Poles wanted{0.1, {0.2, 0.3}, {0.2, -0.3}, -0.4};
  EXPECT_LT(mismatch(A - B * placed(A, B, wanted).gain, wanted), 1e-12);
}

TEST(PolePlacement, LeavesPolesThatAreInPlace) {
  test::Noise noise(4);
  const Matrix A = noise.normal(7, 7) / 3, B = noise.normal(7, 2);
  EXPECT_LT(placed(A, B, poles_of(A)).gain.norm(), 1e-13);
}

TEST(PolePlacement, IsTheSameInAnyUnitsOfTheInputs) {
  test::Noise noise(5);
  const Matrix A = noise.normal(6, 6) / 3, B = noise.normal(6, 3);
  const Vector units = (Vector(3) << 1e9, 1, 1e-7).finished();
  const Poles wanted = random_poles(noise, 6);
  const Matrix plain = placed(A, B, wanted).gain;
  const Matrix scaled = placed(A, B * units.asDiagonal(), wanted).gain;
  EXPECT_LT((units.asDiagonal() * scaled - plain).norm(), 1e-9 * plain.norm());
}

TEST(PolePlacement, WithstandsStatesOfVeryDifferentSize) {
  test::Noise noise(6);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector units = (Vector(5) << 1e-3, 1e-1, 1, 1e2, 1e3).finished();
    const Matrix A =
        units.asDiagonal() * (noise.normal(5, 5) / 3) * units.cwiseInverse().asDiagonal();
    const Matrix B = units.asDiagonal() * noise.normal(5, 2);
    const Poles wanted = random_poles(noise, 5);
    EXPECT_LT(mismatch(A - B * placed(A, B, wanted).gain, wanted), 1e-10) << trial;
  }
}

TEST(PolePlacement, ReportsModesThatNoInputReachesAndLeavesThem) {
  test::Noise noise(7);
  for (Index unreached = 1; unreached <= 3; ++unreached)
    for (Index m = 1; m <= 3; ++m) {
      const Index n = 6;
      Matrix A = noise.normal(n, n) / 3, B = noise.normal(n, m);
      A.bottomLeftCorner(unreached, n - unreached).setZero();
      B.bottomRows(unreached).setZero();
      const Poles stay = poles_of(A.bottomRightCorner(unreached, unreached));
      const Matrix basis = noise.normal(n, n).householderQr().householderQ();
      const Matrix turned = basis * A * basis.transpose(), driven = basis * B;
      Poles wanted;
      for (Index i = 0; i < n; ++i) wanted.push_back(-0.6 + 0.25 * double(i));
      const PolePlacement placement = placed(turned, driven, wanted);
      ASSERT_EQ(placement.uncontrollable.size(), stay.size());
      const Poles result = poles_of(turned - driven * placement.gain);
      const auto distance = [](const Poles& poles, std::complex<double> pole) {
        double nearest = 1e300;
        for (const auto& other : poles) nearest = std::min(nearest, std::abs(other - pole));
        return nearest;
      };
      for (const auto& pole : placement.uncontrollable) EXPECT_LT(distance(stay, pole), 1e-10);
      for (const auto& pole : stay) EXPECT_LT(distance(result, pole), 1e-8);
      Index moved = 0;
      for (const auto& pole : result) moved += distance(wanted, pole) < 1e-8 ? 1 : 0;
      EXPECT_EQ(moved, n - unreached);
    }
}

TEST(PolePlacement, WithoutInputsReportsEveryMode) {
  const Matrix A = Matrix::Identity(3, 3) * 0.5;
  EXPECT_EQ(placed(A, Matrix(3, 0), {0.1, 0.2, 0.3}).uncontrollable.size(), 3U);
  EXPECT_EQ(placed(A, Matrix::Zero(3, 2), {0.1, 0.2, 0.3}).uncontrollable.size(), 3U);
  EXPECT_EQ(placed(Matrix(0, 0), Matrix(0, 2), {}).gain.rows(), 2);
}

TEST(PolePlacement, RefusesAPairForASingleMode) {
  const Matrix A = Eigen::Vector2d(0.5, 0.7).asDiagonal();
  const auto result = place_poles(A, Eigen::Vector2d(1, 0), {{0.1, 0.2}, {0.1, -0.2}});
  ASSERT_TRUE(std::holds_alternative<Verdict>(result));
  EXPECT_EQ(name(std::get<Verdict>(result).code), "no_gain");
  EXPECT_THAT(std::get<Verdict>(result).reason, ::testing::HasSubstr("a pair of poles is wanted"));
}

/// Octave 7.3, control 3.4.0; z of generated() with 5 rows, 6 columns:
/// pkg load control; place(z(:,1:5), z(:,6), [0.5 -0.3 0.1 0.2+0.4i 0.2-0.4i])
TEST(PolePlacement, OfOneInputIsOctaves) {
  const Matrix z = test::generated(5, 6);
  Matrix octave(1, 5);
  octave << -1.049226195902698e+01, -3.765244517191847e-01, 8.033089587268925e+00,
      -3.280349379192905e-01, -1.045943869775614e+00;
  const Matrix gain =
      placed(z.leftCols(5), z.col(5), {0.5, -0.3, 0.1, {0.2, 0.4}, {0.2, -0.4}}).gain;
  EXPECT_LT((gain - octave).norm(), 1e-11 * octave.norm());
}

/// The gain is not unique with several inputs; its size is to be comparable. The same with n rows,
/// n + m columns: A = z(:,1:n); B = z(:,n+1:n+m); p = linspace(-0.8, 0.8, n);
/// f = place(A, B, p); norm(diag(sqrt(sum(B.^2)))*f, 'fro')
/// Ours over Octave's: 0.79, 0.99 and 1.00.
TEST(PolePlacement, OfSeveralInputsIsOfTheSizeOfOctaves) {
  struct Case {
    Index n, m;
    double octave;
  };
  for (const auto& [n, m, octave] : {Case{6, 2, 1.357486185157420}, Case{8, 3, 1.067926987391483},
                                     Case{12, 4, 2.611553998073886}}) {
    const Matrix z = test::generated(n, n + m), A = z.leftCols(n), B = z.rightCols(m);
    Poles wanted;
    for (Index i = 0; i < n; ++i) wanted.push_back(-0.8 + 1.6 * double(i) / double(n - 1));
    const Matrix gain = placed(A, B, wanted).gain;
    EXPECT_LT(mismatch(A - B * gain, wanted), 1e-11);
    const Vector sizes = B.colwise().norm();
    EXPECT_LT((sizes.asDiagonal() * gain).norm(), 1.05 * octave) << n;
  }
}

/// The least over a fine grid of what nearest_with_poles() minimises.
TEST(LeastNormBlock, IsTheLeastOfAll) {
  test::Noise noise(8);
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::Matrix2d A = noise.normal(2, 2);
    if (trial % 5 == 0) A(1, 0) = A(0, 1) = 0;
    if (trial % 10 == 0) A(1, 1) = A(0, 0);
    const double ratio = trial % 3 == 0 ? 1 : noise.uniform(), trace = noise.normal(),
                 determinant = noise.normal();
    const auto cost = [&](const Eigen::Matrix2d& M) {
      return (A - M).row(0).squaredNorm() * ratio + (A - M).row(1).squaredNorm() / ratio;
    };
    const Eigen::Matrix2d M = nearest_with_poles(A, ratio, trace, determinant);
    EXPECT_NEAR(M.trace(), trace, 1e-9);
    EXPECT_NEAR(M.determinant(), determinant, 1e-9 * (1 + M.squaredNorm()));
    for (int i = 0; i < 2000; ++i) {
      Eigen::Matrix2d other =
          M + std::pow(10, -3 * noise.uniform()) * Eigen::Matrix2d(noise.normal(2, 2));
      other(1, 1) = trace - other(0, 0);
      if (std::abs(other(0, 1)) < 1e-6) continue;
      other(1, 0) = (other(0, 0) * other(1, 1) - determinant) / other(0, 1);
      EXPECT_GE(cost(other), cost(M) * (1 - 1e-9)) << trial;
    }
  }
}

}  // namespace
}  // namespace reident::identification::pole_placement_test
