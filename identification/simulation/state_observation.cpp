#include "identification/simulation/state_observation.hpp"

#include <algorithm>

#include "identification/simulation/nearly_empty.hpp"
#include "identification/simulation/segment_run.hpp"

namespace reident::identification {

Matrix observability_of(const StateSpaceModel& model, Index count) {
  const Index p = model.outputs();
  Matrix observability(count * p, model.order());
  observability.topRows(p) = model.C;
  if (const auto A = nearly_empty(model.A)) {
    for (Index row = p; row < count * p; row += p)
      observability.middleRows(row, p) = observability.middleRows(row - p, p) * *A;
    return observability;
  }
  Matrix power = model.A;  // A^known
  for (Index known = 1; known < count; known *= 2) {
    const Index more = std::min(known, count - known);
    observability.middleRows(known * p, more * p) = observability.topRows(more * p) * power;
    power = (power * power).eval();
  }
  return observability;
}

Vector remainder_of(const StateSpaceModel& model, const Record& record, const Segment& segment,
                    Index count, Vector& x) {
  const Index p = model.outputs();
  Matrix response(count, p);
  x = run_segment(model, record, {segment.begin, segment.begin + count, segment.first_tick}, x,
                  response, 0);
  Vector remainder(count * p);
  for (Index k = 0; k < count; ++k)
    remainder.segment(k * p, p) = (record.y.row(segment.begin + k) - response.row(k)).transpose();
  return remainder;
}

Vector weights_of(const Vector& square_errors, const Record& record, const Segment& rows) {
  constexpr double least_error = 1e-10;  // of the output's size: smaller ones are rounding
  const Vector size = record.y.middleRows(rows.begin, rows.size()).cwiseAbs().colwise().maxCoeff();
  return square_errors.cwiseSqrt().cwiseMax(least_error * size).unaryExpr([](double error) {
    return error > 0 ? 1 / error : 0.0;  // an output that is zero and modelled so shows nothing
  });
}

}  // namespace reident::identification
