#include "tests/support/systems.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

namespace reident::test {

double Noise::uniform() {
  return (static_cast<double>(generator_() >> 11) + 0.5) * 0x1p-53;
}

double Noise::normal() {
  const double radius = std::sqrt(-2 * std::log(uniform()));
  return radius * std::cos(2 * std::numbers::pi * uniform());
}

Matrix Noise::normal(Index rows, Index columns) {
  Matrix result(rows, columns);
  for (Index c = 0; c < columns; ++c)
    for (Index r = 0; r < rows; ++r) result(r, c) = normal();
  return result;
}

Matrix generated(Index rows, Index columns) {
  Matrix z(rows, columns);
  double s = 1;
  for (Index k = 0; k < rows; ++k)
    for (Index j = 0; j < columns; ++j)
      z(k, j) = (s = std::fmod(16807 * s, 2147483647)) / 2147483647 - 0.5;
  return z;
}

StateSpaceModel random_system(Noise& noise, Index order, Index inputs, Index outputs,
                              double max_modulus) {
  Matrix A = Matrix::Zero(order, order);
  for (Index i = 0; i < order;) {
    const double modulus = 0.3 + (max_modulus - 0.3) * noise.uniform();
    if (i + 1 < order && noise.uniform() < 0.6) {
      const double angle = std::numbers::pi * (0.05 + 0.9 * noise.uniform());
      A.block<2, 2>(i, i) << modulus * std::cos(angle), modulus * std::sin(angle),
          -modulus * std::sin(angle), modulus * std::cos(angle);
      i += 2;
    } else {
      A(i, i) = noise.uniform() < 0.75 ? modulus : -modulus;
      i += 1;
    }
  }
  Matrix B = noise.normal(order, inputs), C = noise.normal(outputs, order);
  for (Index i = 0; i < order; ++i) {  // no mode that can hardly be driven or seen
    B.row(i) /= std::max(B.row(i).norm(), 1e-3);
    C.col(i) /= std::max(C.col(i).norm(), 1e-3);
  }
  return {
      A, B, C, noise.normal(outputs, inputs) * 0.3, {}, Vector::Zero(inputs), Vector::Zero(outputs),
      1};
}

Matrix simulated(const StateSpaceModel& model, const Matrix& u, const Vector& x0) {
  Matrix y(u.rows(), model.outputs());
  Vector x = x0;
  for (Index k = 0; k < u.rows(); ++k) {
    const Vector du = u.row(k).transpose() - model.u0;
    y.row(k) = (model.C * x + model.D * du + model.y0).transpose();
    x = model.A * x + model.B * du;
  }
  return y;
}

Record excited(const StateSpaceModel& model, Noise& noise, Index rows, double noise_share) {
  const Matrix u = noise.normal(rows, model.inputs());
  Matrix y = simulated(model, u, noise.normal(model.order(), 1));
  for (Index q = 0; q < y.cols(); ++q) {
    const double deviation =
        (y.col(q).array() - y.col(q).mean()).matrix().norm() / std::sqrt(double(rows));
    y.col(q) += noise_share * deviation * noise.normal(rows, 1);
  }
  return identification::contiguous_record(model.period_s, u, y);
}

Record with_gap(const Record& record, Index begin, Index end) {
  const Index after = record.rows() - end;
  Record result{record.period_s,
                Matrix(begin + after, record.u.cols()),
                Matrix(begin + after, record.y.cols()),
                {{0, begin, 0}, {begin, begin + after, end}}};
  result.u << record.u.topRows(begin), record.u.bottomRows(after);
  result.y << record.y.topRows(begin), record.y.bottomRows(after);
  return result;
}

Matrix markov_parameters(const StateSpaceModel& model, Index count) {
  const Index m = model.inputs();
  Matrix result(model.outputs(), m * count);
  result.leftCols(m) = model.D;
  Matrix state = model.B;
  for (Index k = 1; k < count; ++k) {
    result.middleCols(k * m, m) = model.C * state;
    state = (model.A * state).eval();
  }
  return result;
}

double markov_distance(const StateSpaceModel& a, const StateSpaceModel& b) {
  const Matrix of_b = markov_parameters(b, 40);
  return (markov_parameters(a, 40) - of_b).norm() / of_b.norm();
}

double pole_distance(const StateSpaceModel& a, const StateSpaceModel& b) {
  const Eigen::VectorXcd poles_a = a.A.eigenvalues(), poles_b = b.A.eigenvalues();
  double farthest = 0;
  for (const auto& pole : poles_b) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& other : poles_a) nearest = std::min(nearest, std::abs(pole - other));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

}  // namespace reident::test
