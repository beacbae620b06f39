#include "identification/adaptation.hpp"

#include <vector>

#include "identification/response.hpp"
#include "identification/simulate.hpp"

namespace reident::identification {
namespace {

/// Of a column that does not move, at most this share of its largest value is left by rounding when
/// its mean is taken.
constexpr double rounding = 1e-12;

/// Standard deviations of the columns; 0 of one that does not move.
Vector deviations(const Eigen::Ref<const Matrix>& samples) {
  const Matrix centred = samples.rowwise() - samples.colwise().mean();
  const Vector found = (centred.colwise().squaredNorm() / double(samples.rows())).cwiseSqrt();
  const Vector largest = samples.cwiseAbs().colwise().maxCoeff();
  return (found.array() > rounding * largest.array()).select(found, 0.0);
}

std::vector<Index> places_above_zero(const Vector& values) {
  std::vector<Index> places;
  for (Index i = 0; i < values.size(); ++i)
    if (values(i) > 0) places.push_back(i);
  return places;
}

}  // namespace

StateSpaceModel adapted(const StateSpaceModel& known, const Record& record, RowRange rows) {
  const auto u = record.u.middleRows(rows.begin, rows.size());
  const auto y = record.y.middleRows(rows.begin, rows.size());
  const Vector of_u = deviations(u), of_y = deviations(y);
  const Vector per_y = (of_y.array() > 0).select(of_y.cwiseInverse(), 1.0);
  const std::vector<Index> moving = places_above_zero(of_u);
  const Vector mean = u.colwise().mean();
  const Matrix per_u = Vector(of_u(moving)).cwiseInverse().asDiagonal();
  Record rest;
  rest.period_s = record.period_s;
  rest.segments = segments_from(record, rows);
  rest.u = (u.rowwise() - mean.transpose())(Eigen::all, moving) * per_u;
  rest.y = (y - free_run(known, record, rows)) * per_y.asDiagonal();
  const StateSpaceModel moves =
      fit_response(known.A, per_y.asDiagonal() * known.C, true, rest, rest.all(), Accuracy::fast)
          .model;
  const Matrix dB = moves.B * per_u;
  const Matrix dD = per_y.cwiseInverse().asDiagonal() * moves.D * per_u;
  const Matrix I = Matrix::Identity(known.order(), known.order());
  const Matrix static_gain = known.C * (I - known.A).partialPivLu().solve(dB) + dD;
  StateSpaceModel model = known;
  model.B(Eigen::all, moving) += dB;
  model.D(Eigen::all, moving) += dD;
  model.y0 += moves.y0.cwiseQuotient(per_y) - static_gain * (mean - known.u0)(moving);
  return model;
}

}  // namespace reident::identification
