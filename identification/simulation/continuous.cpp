#include "identification/simulation/continuous.hpp"

#include <cassert>
#include <cmath>
#include <complex>
#include <optional>
#include <string>

#include "identification/numerics/decompositions.hpp"

namespace reident::identification {
namespace {

constexpr double smallest_pole = 1e-8;
constexpr double accepted_error = 1e-9;

/// The state and input matrices of one kind of time.
struct Dynamics {
  Matrix A, B;
};

/// [A B; 0 diagonal I].
Matrix block_matrix(const Dynamics& dynamics, double diagonal) {
  const Index n = dynamics.A.rows(), m = dynamics.B.cols();
  Matrix M = Matrix::Zero(n + m, n + m);
  M.topLeftCorner(n, n) = dynamics.A;
  M.topRightCorner(n, m) = dynamics.B;
  M.bottomRightCorner(m, m).diagonal().setConstant(diagonal);
  return M;
}

Dynamics upper_blocks(const Matrix& M, Index n) {
  return {M.topLeftCorner(n, n), M.topRightCorner(n, M.cols() - n)};
}

/// Sizes of the columns of B, 1 for one of zeros. The functions below are linear in a column of B,
/// which is given to them with the size 1: a large one would cost A its digits.
Vector column_sizes(const Matrix& B) {
  Vector sizes = B.colwise().norm().transpose();
  return (sizes.array() > 0).select(sizes, 1.0);
}

Dynamics exponential(const Dynamics& dynamics, double period_s) {
  const Vector sizes = column_sizes(dynamics.B);
  const Matrix generator = block_matrix(
      {dynamics.A * period_s, dynamics.B * sizes.cwiseInverse().asDiagonal() * period_s}, 0);
  Dynamics result = upper_blocks(matrix_exponential(generator), dynamics.A.rows());
  result.B *= sizes.asDiagonal();
  return result;
}

Dynamics logarithm(const Dynamics& dynamics, double period_s) {
  const Vector sizes = column_sizes(dynamics.B);
  const Matrix M = matrix_logarithm(
      block_matrix({dynamics.A, dynamics.B * sizes.cwiseInverse().asDiagonal()}, 1));
  Dynamics result = upper_blocks(M / period_s, dynamics.A.rows());
  result.B *= sizes.asDiagonal();
  return result;
}

/// Sum of the errors of A and of the columns of B, each relative to its size.
double relative_error(const Dynamics& found, const Dynamics& wanted) {
  double error = (found.A - wanted.A).norm() / wanted.A.norm();
  const Vector sizes = column_sizes(wanted.B);
  for (Index j = 0; j < wanted.B.cols(); ++j)
    error += (found.B.col(j) - wanted.B.col(j)).norm() / sizes(j);
  return error;
}

std::optional<Verdict> pole_without_logarithm(const Matrix& A) {
  const ComplexVector poles = eigenvalues(A);
  for (const std::complex<double>& pole : poles)
    if (std::abs(pole) < smallest_pole)
      return Verdict{VerdictCode::no_continuous_time,
                     "the pole at " + four_digits(std::abs(pole)) +
                         " is gone within one sample, as nothing is in continuous time; use the "
                         "discrete-time model, or identify with a lower order or an input delay"};
  for (const std::complex<double>& pole : poles)
    if (pole.imag() == 0 && pole.real() < 0)
      return Verdict{VerdictCode::no_continuous_time,
                     "the pole at " + four_digits(pole.real()) +
                         " turns its sign with every sample, as nothing of the same order does in "
                         "continuous time; use the discrete-time model, or identify with another "
                         "order or a shorter sample period"};
  return std::nullopt;
}

}  // namespace

std::variant<ContinuousModel, Verdict> to_continuous(const StateSpaceModel& model) {
  assert(is_well_formed(model));
  if (model.order() == 0)
    return ContinuousModel{model.A, model.B, model.C, model.D, model.u0, model.y0};
  if (auto verdict = pole_without_logarithm(model.A)) return *std::move(verdict);
  const Dynamics discrete{model.A, model.B};
  Dynamics continuous = logarithm(discrete, model.period_s);
  const double error = relative_error(exponential(continuous, model.period_s), discrete);
  if (!(error < accepted_error))
    return Verdict{VerdictCode::no_continuous_time,
                   "the continuous-time matrices, sampled again, miss the model by " +
                       four_digits(error) +
                       " of its size, since poles lie too near zero or the negative axis; use the "
                       "discrete-time model, or identify with another order or a shorter sample "
                       "period"};
  return ContinuousModel{
      std::move(continuous.A), std::move(continuous.B), model.C, model.D, model.u0, model.y0};
}

StateSpaceModel to_discrete(const ContinuousModel& model, double period_s) {
  assert(period_s > 0);
  Dynamics discrete{model.A, model.B};
  if (model.order() > 0) discrete = exponential(discrete, period_s);
  return {std::move(discrete.A),
          std::move(discrete.B),
          model.C,
          model.D,
          {},
          model.u0,
          model.y0,
          period_s};
}

}  // namespace reident::identification
