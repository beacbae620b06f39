#include "identification/simulation/initial_state.hpp"

#include <algorithm>
#include <cstdint>

#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/gram.hpp"
#include "identification/simulation/hole_bridging.hpp"
#include "identification/simulation/segment_run.hpp"
#include "identification/simulation/square_changes.hpp"

namespace reident::identification {
namespace {

/// The least-squares solution of least norm.
Vector least_squares(const Matrix& left, const Vector& right) {
  // An error of 1e-16 in the sums moves the solution by that over the pivot's square.
  constexpr double least_pivot = 1e-3;
  const Vector scale = left.colwise().norm().transpose().unaryExpr(
      [](double norm) { return norm > 0 ? 1 / norm : 0.0; });
  const Matrix scaled = scale.asDiagonal() * left.transpose();
  if (const auto cholesky = Cholesky::of(lower_gram(scaled), least_pivot))
    return scale.asDiagonal() * cholesky->solve(Vector(scaled * right));
  return solve_least_norm(left, right);
}

/// The first `rows` rows of the segments, up to a hole that is not bridged, and within twice as
/// many ticks.
std::vector<Segment> first_rows(const Record& record, const std::vector<Segment>& segments,
                                Index rows) {
  const std::int64_t most_ticks = 2 * rows;
  std::vector<Segment> parts;
  for (const Segment& segment : segments) {
    if (rows == 0 || segment.first_tick - segments.front().first_tick >= most_ticks) break;
    if (!parts.empty() && !is_bridged(record, parts.back(), segment)) break;
    const Index more = std::min(rows, segment.size());
    parts.push_back({segment.begin, segment.begin + more, segment.first_tick});
    rows -= more;
  }
  return parts;
}

/// What is known of a state: the smaller |R x - r| is, the likelier is x.
struct Information {
  Matrix R;
  Vector r;
};

/// What rows [R, r] show of the state where the unknowns that are given up take their best values.
/// The columns are these unknowns, then the state, then r.
Information without_unknowns(const Matrix& rows, Index given_up) {
  const Index n = rows.cols() - 1 - given_up;
  const Index left = std::min(rows.rows(), given_up + n) - given_up;
  const Matrix triangle = triangular_factor(rows).block(given_up, given_up, left, n + 1);
  return {triangle.leftCols(n), triangle.col(n)};
}

Matrix power_of(Matrix A, std::int64_t exponent) {
  Matrix power = Matrix::Identity(A.rows(), A.cols());
  for (; exponent > 0; exponent /= 2) {
    if (exponent % 2 == 1) power = (power * A).eval();
    A = (A * A).eval();
  }
  return power;
}

/// The mean square of each output (p) in values of all outputs, row by row below each other.
Vector mean_squares(const Vector& values, Index p) {
  return Eigen::Map<const Matrix>(values.data(), p, values.size() / p).rowwise().squaredNorm() *
         (double(p) / double(values.size()));
}

/// Weighs each output by one over its error: first by one over what the state has to explain, then
/// by one over what that estimate leaves, where a state cannot take most of the rows.
Vector state_of_part(const StateSpaceModel& model, const Record& record, const Segment& part) {
  const Index p = model.outputs();
  Vector x = Vector::Zero(model.order());
  Vector behind = x;
  const Matrix observability = observability_of(model, part.size());
  const Vector remainder = remainder_of(model, record, part, part.size(), behind);
  if (!observability.allFinite() || !remainder.allFinite()) return x;
  if (p == 1) return least_squares(observability, remainder);
  Vector left = remainder;
  for (const Index least_rows : {Index{1}, initial_rows(model)}) {
    if (part.size() < least_rows) break;
    const Vector weights =
        weights_of(mean_squares(left, p), record, part).replicate(part.size(), 1);
    x = least_squares(weights.asDiagonal() * observability, weights.cwiseProduct(remainder));
    left = remainder - observability * x;
  }
  return x;
}

/// Mean square errors of the model over parts, each from the state that suits it best. Where this
/// state takes nearly all rows of the parts, the outputs' changes from row to row stand for them.
Vector square_errors_of(const StateSpaceModel& model, const Record& record,
                        const std::vector<Segment>& parts) {
  const auto taken = double(model.order()) / double(model.outputs());  // rows, by a state
  Vector squares = Vector::Zero(model.outputs());
  double left = 0;
  for (const Segment& part : parts) {
    if (double(part.size()) <= taken) continue;
    Matrix y_hat(part.size(), model.outputs());
    run_segment(model, record, part, state_of_part(model, record, part), y_hat, 0);
    squares +=
        (record.y.middleRows(part.begin, part.size()) - y_hat).colwise().squaredNorm().transpose();
    left += double(part.size()) - taken;
  }
  if (left >= std::max(1.0, taken)) return squares / left;
  return square_changes(record.y, {{parts.front().begin, parts.back().end}}).usual / 2;
}

/// State at the first row of several parts, from the last one back to it by a square-root
/// information filter. Through a hole the state is what through_hole() makes of it. The model's
/// errors over the parts are the noise.
Vector state_before_holes(const StateSpaceModel& model, const Record& record,
                          const std::vector<Segment>& parts) {
  const Index n = model.order(), p = model.outputs();
  const Segment& longest =
      *std::max_element(parts.begin(), parts.end(),
                        [](const Segment& a, const Segment& b) { return a.size() < b.size(); });
  const Vector weight = weights_of(square_errors_of(model, record, parts), record, longest);
  const Matrix observability = observability_of(model, longest.size());
  const SquareChanges changes = square_changes(record);
  Information known{Matrix(0, n), Vector(0)};
  for (std::size_t i = parts.size(); i-- > 0;) {
    const Segment& part = parts[i];
    const Index values = part.size() * p, behind = known.R.rows();
    const Vector weights = weight.replicate(part.size(), 1);
    Vector end = Vector::Zero(n);
    const Vector remainder = remainder_of(model, record, part, part.size(), end);
    Matrix rows(values + behind, n + 1);
    rows.topLeftCorner(values, n) = weights.asDiagonal() * observability.topRows(values);
    rows.col(n).head(values) = weights.cwiseProduct(remainder);
    rows.bottomLeftCorner(behind, n) = known.R * power_of(model.A, part.size());
    rows.col(n).tail(behind) = known.r - known.R * end;
    if (!rows.allFinite()) return state_of_part(model, record, parts.front());
    known = without_unknowns(rows, 0);
    if (i == 0) break;
    const auto [x, L] = through_hole(model, record, parts[i - 1], part, Vector::Zero(n), changes);
    Matrix hole = Matrix::Zero(known.R.rows() + n, 2 * n + 1);
    hole.topLeftCorner(known.R.rows(), n) = known.R * L;
    hole.block(0, n, known.R.rows(), n) =
        known.R * power_of(model.A, ticks_between(parts[i - 1], part));
    hole.col(2 * n).head(known.R.rows()) = known.r - known.R * x;
    hole.bottomLeftCorner(n, n).setIdentity();
    if (!hole.allFinite()) return state_of_part(model, record, parts.front());
    known = without_unknowns(hole, n);
  }
  return solve_least_norm(known.R, known.r);
}

}  // namespace

Index initial_rows(const StateSpaceModel& model) {
  return std::max<Index>(1, 3 * model.order());
}

Vector estimate_initial_state(const StateSpaceModel& model, const Record& record,
                              const std::vector<Segment>& segments, Index rows) {
  const std::vector<Segment> parts = first_rows(record, segments, rows);
  const Index n = model.order();
  if (n == 0 || parts.empty()) return Vector::Zero(n);
  if (parts.size() > 1) return state_before_holes(model, record, parts);
  return state_of_part(model, record, parts.front());
}

}  // namespace reident::identification
