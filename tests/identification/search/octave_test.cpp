// Recorded results of another implementation: Octave 7.3's n4sid (control package 3.4.0, SLICOT's
// IB01AD and IB01BD), on data that an integer generator makes again to the last bit.
#include <cmath>
#include <complex>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "identification/search/identify.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::octave_test {
namespace {

/// filter(b, a, u) with a(1) = 1 and as many coefficients in both.
Vector filter(const std::vector<double>& b, const std::vector<double>& a, const Vector& u) {
  Vector y = Vector::Zero(u.size());
  for (Index k = 0; k < u.size(); ++k)
    for (std::size_t i = 0; i < b.size() && Index(i) <= k; ++i)
      y(k) += b[i] * u(k - Index(i)) - (i > 0 ? a[i] * y(k - Index(i)) : 0);
  return y;
}

/// Octave takes A and C by MOESP, and does not refine them.
IdentifyOptions as_octave(int order, int horizon) {
  IdentifyOptions options;
  options.order = order;
  options.horizon = horizon;
  options.weighting = Weighting::moesp;
  options.direct_feedthrough = true;
  options.response_fit = ResponseFit::simulation;
  return options;
}

void expect_pole(const StateSpaceModel& model, std::complex<double> octave) {
  EXPECT_LT((model.A.eigenvalues().array() - octave).abs().minCoeff(), 3e-4) << octave;
}

/// `octave` is [d, c*b, c*a*b, c*a^2*b]. B and D are fitted to the free run here, to the state
/// equation there.
void expect_markov_parameters(const StateSpaceModel& model, const Matrix& octave) {
  EXPECT_LT((test::markov_parameters(model, 4) - octave).norm(), 0.02 * octave.norm());
}

/// pkg load control; z of generated() with 800 rows, 4 columns; u = z(:,1:2);
/// x = filter([0 1], [1 -0.8], u(:,2));
/// y = [filter([0 1 0.5], [1 -1.5 0.7], u(:,1)) + 0.3*x, 0.4*x + 0.5*u(:,1)] ...
///     + z(:,3:4)*diag([0.2 0.05]);
/// su = std(u,1); sy = std(y,1); u = (u - mean(u))./su; y = (y - mean(y))./sy;
/// sys = n4sid(iddata(y, u, 1), 'n', 3, 's', 8, 'alg', 'q');
/// b = sys.b./su; c = sys.c.*sy'; d = sys.d.*sy'./su;
/// eig(sys.a), [d, c*b, c*sys.a*b, c*sys.a^2*b]
TEST(Octave, AgreesOnTwoInputsAndTwoOutputs) {
  const Matrix z = test::generated(800, 4);
  const Vector x = filter({0, 1}, {1, -0.8}, z.col(1));
  Matrix y(800, 2);
  y.col(0) = filter({0, 1, 0.5}, {1, -1.5, 0.7}, z.col(0)) + 0.3 * x + 0.2 * z.col(2);
  y.col(1) = 0.4 * x + 0.5 * z.col(0) + 0.05 * z.col(3);
  const Record record = contiguous_record(1, z.leftCols(2), y);
  const IdentifyResult result = identify(record, record.all(), as_octave(3, 8));
  ASSERT_TRUE(std::holds_alternative<Identified>(result));
  const StateSpaceModel& model = std::get<Identified>(result).model;
  expect_pole(model, {0.7494855577720316, 0.3712623670759166});
  expect_pole(model, {0.8014517099639547, 0});
  Matrix octave(2, 8);
  octave << -0.002639551649587809, 0.007762445789371599, 0.9884082666409194, 0.3113616113224567,
      1.993685840407601, 0.2480531179088288, 2.297203687306245, 0.1943542733413831,
      0.4977218411949286, -0.002300100411156642, 0.002427829840316498, 0.3977561992964901,
      0.002373718338278304, 0.3187811280993147, 0.002111002027999262, 0.2554854786190148;
  expect_markov_parameters(model, octave);
}

/// pkg load control; z of generated() with 700 rows, 2 columns; u = z(:,1);
/// y = filter([0.2 1 0.5], [1 -1.5 0.7], u) + 0.2*z(:,2); p = 1:300; q = 351:700;
/// m = mean(u([p q])); my = mean(y([p q])); u = u - m; y = y - my;
/// sys = n4sid(iddata({y(p); y(q)}, {u(p); u(q)}, 1), 'n', 2, 's', 10, 'alg', 'q');
/// eig(sys.a), [sys.d, sys.c*sys.b, sys.c*sys.a*sys.b, sys.c*sys.a^2*sys.b]
TEST(Octave, AgreesOnTwoSegments) {
  const Matrix z = test::generated(700, 2);
  const Matrix y = filter({0.2, 1, 0.5}, {1, -1.5, 0.7}, z.col(0)) + 0.2 * z.col(1);
  const Record record = test::with_gap(contiguous_record(1, z.leftCols(1), y), 300, 350);
  const IdentifyResult result = identify(record, record.all(), as_octave(2, 10));
  ASSERT_TRUE(std::holds_alternative<Identified>(result));
  const StateSpaceModel& model = std::get<Identified>(result).model;
  expect_pole(model, {0.7491387421281671, 0.3707471900541477});
  Matrix octave(1, 4);
  octave << 0.1930038136320958, 1.284891798252479, 2.308191024097131, 2.560605138203567;
  expect_markov_parameters(model, octave);
}

}  // namespace
}  // namespace reident::identification::octave_test
