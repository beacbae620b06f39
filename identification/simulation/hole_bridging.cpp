#include "identification/simulation/hole_bridging.hpp"

#include <algorithm>

#include "identification/numerics/decompositions.hpp"
#include "identification/simulation/nearly_empty.hpp"
#include "identification/simulation/state_observation.hpp"

namespace reident::identification {
namespace {

/// Longer holes say too little of the inputs within them.
std::int64_t most_bridged_ticks(const Record& record) {
  return std::max<std::int64_t>(60, record.rows() / 100);
}

/// In a hole of so many ticks an input makes no step that does not show at the ends.
constexpr double short_hole = 4;

/// The inputs at the ticks of a hole (m x ticks), less the model's operating point: interpolated.
Matrix inputs_within(const StateSpaceModel& model, const Record& record, const Segment& before,
                     const Segment& after) {
  const std::int64_t hole = ticks_between(before, after);
  const Vector from = record.u.row(before.end - 1).transpose() - model.u0;
  const Vector to = record.u.row(after.begin).transpose() - model.u0;
  Matrix inputs(from.size(), hole);
  for (std::int64_t k = 1; k <= hole; ++k) {
    const double share = double(k) / double(hole + 1);
    inputs.col(k - 1) = (1 - share) * from + share * to;
  }
  return inputs;
}

}  // namespace

std::int64_t ticks_between(const Segment& before, const Segment& after) {
  return after.first_tick - before.end_tick();
}

bool is_bridged(const Record& record, const Segment& before, const Segment& after) {
  return ticks_between(before, after) <= most_bridged_ticks(record);
}

UncertainState through_hole(const StateSpaceModel& model, const Record& record,
                            const Segment& before, const Segment& after, const Vector& x,
                            const SquareChanges& changes) {
  const Matrix inputs = inputs_within(model, record, before, after);
  const Index hole = inputs.cols();
  const auto across = record.u.row(after.begin) - record.u.row(before.end - 1);
  const Vector variance = across.transpose().cwiseAbs2() / 4 +
                          changes.usual * (1 + double(hole) / 4) +
                          changes.mean * (std::max(0.0, double(hole) - short_hole) / 4);
  UncertainState result{x, Matrix::Zero(x.size(), x.size())};
  const auto A = nearly_empty(model.A);
  const Matrix driven = model.B * variance.asDiagonal() * model.B.transpose();
  Matrix P = Matrix::Zero(x.size(), x.size());
  for (Index k = 0; k < hole; ++k) {
    result.x = (model.A * result.x + model.B * inputs.col(k)).eval();
    P = A ? Matrix(*A * P * A->transpose()) : Matrix(model.A * P * model.A.transpose());
    P += driven;
  }
  if (!P.allFinite()) return result;
  const SymmetricEigen eigen = symmetric_eigen(P);
  result.L = eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
  return result;
}

std::optional<Vector> state_after_hole(const StateSpaceModel& model, const Record& record,
                                       const Segment& before, const Segment& after, const Vector& x,
                                       const RunNoise& noise) {
  if (!is_bridged(record, before, after)) return std::nullopt;
  const UncertainState prior = through_hole(model, record, before, after, x, noise.input_changes);
  const Index n = model.order(), count = std::min(state_rows, after.size());
  if (n == 0 || count == 0 || !prior.x.allFinite()) return prior.x;
  const Segment first{after.begin, after.begin + count, after.first_tick};
  const Vector weight = weights_of(noise.square_errors, record, first).replicate(count, 1);
  Matrix left(weight.size() + n, n);
  Vector right = Vector::Zero(weight.size() + n);
  left << weight.asDiagonal() * observability_of(model, count) * prior.L, Matrix::Identity(n, n);
  Vector behind = prior.x;
  right.head(weight.size()) =
      weight.cwiseProduct(remainder_of(model, record, after, count, behind));
  if (!left.allFinite() || !right.allFinite()) return prior.x;
  return prior.x + prior.L * solve_pivoted_qr(left, right);
}

}  // namespace reident::identification
