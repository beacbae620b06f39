#include "identification/simulation/simulate.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/gram.hpp"
#include "identification/numerics/kernels.hpp"

namespace reident::identification {
namespace {

/// Runs one segment from `x`; writes its outputs into y_hat from row `out` on. Gives the state
/// after its last row.
Vector run_segment(const StateSpaceModel& model, const Record& record, const Segment& segment,
                   Vector x, Matrix& y_hat, Index out) {
  constexpr Index stretch = 1024;  // of rows at once, so that the work space stays small
  const Index n = model.order(), m = model.inputs(), p = model.outputs();
  Matrix M(n + p, n + m);
  M << model.A, model.B, model.C, model.D;
  Vector work(n + p);
  Matrix du(m, stretch), y(p, stretch);
  for (Index begin = segment.begin; begin < segment.end; begin += stretch) {
    const Index count = std::min(stretch, segment.end - begin);
    for (Index i = 0; i < m; ++i)
      du.row(i).head(count) =
          record.u.col(i).segment(begin, count).transpose().array() - model.u0(i);
    run_state_space(M.data(), n, m, p, du.data(), count, x.data(), work.data(), y.data());
    for (Index q = 0; q < p; ++q)
      y_hat.col(q).segment(out + (begin - segment.begin), count) =
          y.row(q).head(count).transpose().array() + model.y0(q);
  }
  return x;
}

/// Longer holes say too little of the inputs within them.
std::int64_t most_bridged_ticks(const Record& record) {
  return std::max<std::int64_t>(60, record.rows() / 100);
}

std::int64_t ticks_between(const Segment& before, const Segment& after) {
  return after.first_tick - (before.first_tick + before.size());
}

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

/// A state and a root of its covariance: P = L L'.
struct UncertainState {
  Vector x;
  Matrix L;
};

/// In a hole of so many ticks an input makes no step that does not show at the ends.
constexpr double short_hole = 4;

/// The state behind the hole by inputs that are interpolated over it; simulate.hpp says by how much
/// they may be off.
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
  Matrix P = Matrix::Zero(x.size(), x.size());
  for (Index k = 0; k < hole; ++k) {
    result.x = (model.A * result.x + model.B * inputs.col(k)).eval();
    P = (model.A * P * model.A.transpose() + model.B * variance.asDiagonal() * model.B.transpose())
            .eval();
  }
  if (!P.allFinite()) return result;
  const SymmetricEigen eigen = symmetric_eigen(P);
  result.L = eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
  return result;
}

/// C A^k, k = 0 ... count - 1, below each other.
Matrix observability_of(const StateSpaceModel& model, Index count) {
  const Index p = model.outputs();
  Matrix observability(count * p, model.order());
  observability.topRows(p) = model.C;
  Matrix power = model.A;  // A^known
  for (Index known = 1; known < count; known *= 2) {
    const Index more = std::min(known, count - known);
    observability.middleRows(known * p, more * p) = observability.topRows(more * p) * power;
    power = (power * power).eval();
  }
  return observability;
}

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

/// Of each output's errors, by their mean squares and the output's size in the rows.
Vector weights_of(const Vector& square_errors, const Record& record, const Segment& rows) {
  constexpr double least_error = 1e-10;  // of the output's size: smaller ones are rounding
  const Vector size = record.y.middleRows(rows.begin, rows.size()).cwiseAbs().colwise().maxCoeff();
  return square_errors.cwiseSqrt().cwiseMax(least_error * size).unaryExpr([](double error) {
    return error > 0 ? 1 / error : 0.0;  // an output that is zero and modelled so tells nothing
  });
}

/// y[k] less the response from the state x, below each other. x becomes the state behind them.
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

/// The first `rows` rows of the segments, up to a hole that is not bridged, and within twice as
/// many ticks.
std::vector<Segment> first_rows(const Record& record, const std::vector<Segment>& segments,
                                Index rows) {
  const std::int64_t most_ticks = 2 * rows;
  std::vector<Segment> parts;
  for (const Segment& segment : segments) {
    if (rows == 0 || segment.first_tick - segments.front().first_tick >= most_ticks) break;
    if (!parts.empty() && ticks_between(parts.back(), segment) > most_bridged_ticks(record)) break;
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

/// That of rows [R, r], whose columns are unknowns that are given up, then the state, then r: what
/// is left where the former take their best values.
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

Vector state_of_part(const StateSpaceModel& model, const Record& record, const Segment& part) {
  Vector behind = Vector::Zero(model.order());
  const Matrix observability = observability_of(model, part.size());
  const Vector free_response = remainder_of(model, record, part, part.size(), behind);
  if (!observability.allFinite() || !free_response.allFinite()) return Vector::Zero(model.order());
  return least_squares(observability, free_response);
}

/// Mean square errors of the model over parts, each from the state that suits it best. Where that
/// takes nearly all that the parts tell, what the outputs change from row to row stands for them.
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

/// State at the first row of several parts, from the last one back to it (a square-root information
/// filter): through a hole the state is what interpolated inputs make of it, with the uncertainty
/// that state_after_hole gives it, and the model's errors over the parts are the noise.
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

SquareChanges square_changes(const Matrix& signals, const std::vector<RowRange>& stretches) {
  constexpr double median_of_a_normal = 0.4549;  // of chi-squared with one degree of freedom
  const Index m = signals.cols();
  SquareChanges result{Vector::Zero(m), Vector::Zero(m)};
  std::vector<double> squares;
  for (Index j = 0; j < m; ++j) {
    squares.clear();
    for (const RowRange& stretch : stretches)
      for (Index k = stretch.begin + 1; k < stretch.end; ++k) {
        const double change = signals(k, j) - signals(k - 1, j);
        squares.push_back(change * change);
      }
    if (squares.empty()) continue;
    result.mean(j) =
        std::accumulate(squares.begin(), squares.end(), 0.0) / static_cast<double>(squares.size());
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), middle, squares.end());
    result.usual(j) = *middle / median_of_a_normal;
  }
  return result;
}

SquareChanges square_changes(const Record& record) {
  std::vector<RowRange> stretches;
  for (const Segment& segment : record.segments) stretches.push_back({segment.begin, segment.end});
  return square_changes(record.u, stretches);
}

std::optional<Vector> state_after_hole(const StateSpaceModel& model, const Record& record,
                                       const Segment& before, const Segment& after, const Vector& x,
                                       const RunNoise& noise) {
  if (ticks_between(before, after) > most_bridged_ticks(record)) return std::nullopt;
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

Matrix free_run(const StateSpaceModel& model, const Record& record, RowRange rows,
                const std::optional<Vector>& x0) {
  Matrix y_hat(rows.size(), model.outputs());
  Index out = 0;
  Vector x;
  Vector square_errors = Vector::Zero(model.outputs());
  const std::vector<Segment> segments = segments_within(record, rows);
  const SquareChanges changes = segments.size() > 1 ? square_changes(record) : SquareChanges{};
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& segment = segments[i];
    const auto given = i == 0 ? x0
                              : state_after_hole(model, record, segments[i - 1], segment, x,
                                                 {changes, square_errors / double(out)});
    const auto from_here = segments.begin() + static_cast<std::ptrdiff_t>(i);
    x = run_segment(
        model, record, segment,
        given ? *given
              : estimate_initial_state(model, record, {from_here, segments.end()}, state_rows),
        y_hat, out);
    square_errors +=
        (record.y.middleRows(segment.begin, segment.size()) - y_hat.middleRows(out, segment.size()))
            .cwiseAbs2()
            .colwise()
            .sum()
            .transpose();
    out += segment.size();
  }
  assert(out == rows.size());
  return y_hat;
}

Score score(const Matrix& y, const Matrix& y_hat) {
  assert(y.rows() == y_hat.rows() && y.cols() == y_hat.cols() && y.rows() > 0);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Score result{Vector(y.cols()), Vector(y.cols()), y.rows()};
  for (Index q = 0; q < y.cols(); ++q) {
    const double error = (y.col(q) - y_hat.col(q)).stableNorm();
    const double size = y.col(q).stableNorm();
    const double spread = (y.col(q).array() - y.col(q).mean()).matrix().stableNorm();
    // The mean of a constant may be rounded: its spread is zero all the same.
    const bool constant = y.col(q).maxCoeff() == y.col(q).minCoeff();
    const double mrse = error == 0 ? 0.0 : 100 * error / size;
    double fit = 100 * (1 - error / spread);
    if (constant) fit = error == 0 ? 100.0 : -infinity;
    result.mrse_percent(q) = std::isnan(mrse) ? infinity : mrse;
    result.fit_percent(q) = std::isnan(fit) ? -infinity : fit;
  }
  return result;
}

Score score_free_run(const StateSpaceModel& model, const Record& record, RowRange run,
                     RowRange scored, const std::optional<Vector>& x0) {
  const Matrix y_hat = free_run(model, record, run, x0);
  return score(record.y.middleRows(scored.begin, scored.size()),
               y_hat.middleRows(scored.begin - run.begin, scored.size()));
}

}  // namespace reident::identification
