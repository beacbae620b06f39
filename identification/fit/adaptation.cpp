#include "identification/fit/adaptation.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "identification/fit/output_error_fit.hpp"
#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/gram.hpp"
#include "identification/simulation/free_run.hpp"

namespace reident::identification {
namespace {

/// At most this share of its largest value is left by rounding of a column that does not move, when
/// its mean is taken.
constexpr double rounding = 1e-12;

/// Standard deviations of the columns; 0 of one that does not move.
Vector deviations(const Eigen::Ref<const Matrix>& samples) {
  const Matrix centred = samples.rowwise() - samples.colwise().mean();
  const Vector found = (centred.colwise().squaredNorm() / double(samples.rows())).cwiseSqrt();
  const Vector largest = samples.cwiseAbs().colwise().maxCoeff();
  return (found.array() > rounding * largest.array()).select(found, 0.0);
}

/// One over the deviations of the outputs; of one that does not move, over the size of what the
/// model leaves of it.
Vector inverse_sizes(const Eigen::Ref<const Matrix>& y, const Matrix& left) {
  const Vector of_y = deviations(y);
  const Vector of_left = (left.colwise().squaredNorm() / double(left.rows())).cwiseSqrt();
  const Vector size = (of_y.array() > 0).select(of_y, of_left);
  return (size.array() > 0).select(size.cwiseInverse(), 1.0);
}

std::vector<Index> places_above_zero(const Vector& values) {
  std::vector<Index> places;
  for (Index i = 0; i < values.size(); ++i)
    if (values(i) > 0) places.push_back(i);
  return places;
}

/// With 0 for the inputs that have no effect in the model: those of operating regimes that were not
/// worth it.
Vector without_unused(const Vector& deviations, const StateSpaceModel& model) {
  const Vector effects =
      (model.B.colwise().squaredNorm() + model.D.colwise().squaredNorm()).transpose();
  return (effects.array() > 0).select(deviations, 0.0);
}

/// Rows after which inputs of such weights have samples of their own: those between are held.
Index rows_held(const Matrix& u, const Vector& weights) {
  constexpr double takes_part = 0.1;
  Index most = 1;
  for (Index i = 0; i < u.cols(); ++i) {
    if (std::abs(weights(i)) < takes_part) continue;
    const auto change = u.col(i).tail(u.rows() - 1).array() != u.col(i).head(u.rows() - 1).array();
    most = std::max(most, (u.rows() - 1) / std::max<Index>(1, change.count()));
  }
  return most;
}

/// Share of the variance of centred samples that carries on for so many rows.
double carried_on(const Vector& z, const std::vector<Segment>& segments, Index lag) {
  double product = 0, energy = 0;
  for (const Segment& segment : segments) {
    const Index pairs = segment.size() - lag;
    if (pairs < 1) continue;
    const auto before = z.segment(segment.begin, pairs);
    product += before.dot(z.segment(segment.begin + lag, pairs));
    energy += before.squaredNorm();
  }
  return energy > 0 ? product / energy : 0;
}

/// Principal components of inputs (N x m) of mean 0 and deviation 1, by columns of unit norm. No
/// gain is fitted to one that is noise: principal component regression (I. T. Jolliffe, "Principal
/// Component Analysis", 2nd edition, Springer, 2002, chapter 8).
struct Components {
  Matrix moving, noise;
};

Components components_of(const Matrix& u, const std::vector<Segment>& segments) {
  constexpr double small = 0.05, half = 0.5;
  constexpr double determined = 1e-6;  // below it is the rounding of inputs that follow from others
  const Index m = u.cols();
  if (m == 0) return {};
  const SymmetricEigen eigen = symmetric_eigen(lower_gram(u.transpose()) / double(u.rows()));
  std::vector<Index> moving, noise;
  for (Index i = 0; i < m; ++i) {
    const double size = std::sqrt(std::max(0.0, eigen.values(i)));
    const Vector weights = eigen.vectors.col(i);
    const bool moves =
        size > small ||
        (size > determined && carried_on(u * weights, segments, rows_held(u, weights)) > half);
    (moves ? moving : noise).push_back(i);
  }
  return {eigen.vectors(Eigen::all, moving), eigen.vectors(Eigen::all, noise)};
}

}  // namespace

StateSpaceModel adapted(const StateSpaceModel& known, const Record& record, RowRange rows,
                        KnownFrom from) {
  const auto u = record.u.middleRows(rows.begin, rows.size());
  const auto y = record.y.middleRows(rows.begin, rows.size());
  const Vector of_u = deviations(u);
  const std::vector<Index> inputs =
      places_above_zero(from == KnownFrom::these_rows ? without_unused(of_u, known) : of_u);
  const Vector mean = u.colwise().mean();
  const Vector deviation = of_u(inputs);
  const Matrix per_u = deviation.cwiseInverse().asDiagonal();
  Record rest;
  rest.period_s = record.period_s;
  rest.segments = segments_from(record, rows);
  rest.u = (u.rowwise() - mean.transpose())(Eigen::all, inputs) * per_u;
  const Components components = components_of(rest.u, rest.segments);
  StateSpaceModel model = known;
  if (from == KnownFrom::these_rows) {
    const Matrix noise =
        deviation.asDiagonal() * components.noise * components.noise.transpose() * per_u;
    model.B(Eigen::all, inputs) -= (known.B(Eigen::all, inputs) * noise).eval();
    model.D(Eigen::all, inputs) -= (known.D(Eigen::all, inputs) * noise).eval();
  }
  rest.y = y - free_run(model, record, rows);
  const Vector per_y = inverse_sizes(y, rest.y);
  rest.y = (rest.y * per_y.asDiagonal()).eval();
  rest.u = (rest.u * components.moving).eval();
  const Matrix to_components = components.moving.transpose() * per_u;
  const Matrix C = per_y.asDiagonal() * known.C;
  const StateSpaceModel moves =
      (from == KnownFrom::these_rows
           ? fit_response(known.A, C, true, rest, rest.all(), Accuracy::fast)
           : fit_change(known.A, C, rest, rest.all()))
          .model;
  const Matrix dB = moves.B * to_components;
  const Matrix dD = per_y.cwiseInverse().asDiagonal() * moves.D * to_components;
  const Matrix I = Matrix::Identity(known.order(), known.order());
  const Matrix static_gain = known.C * solve_lu(I - known.A, dB) + dD;
  model.B(Eigen::all, inputs) += dB;
  model.D(Eigen::all, inputs) += dD;
  model.y0 += moves.y0.cwiseQuotient(per_y) - static_gain * (mean - known.u0)(inputs);
  return model;
}

}  // namespace reident::identification
