#include "identification/fit/regression.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/fit/dual_filters.hpp"
#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/kernels.hpp"

namespace reident::identification {
namespace {

constexpr Index tile_rows = 64;
/// Rows that are folded into a triangular factor at once: fewer cost more for the factor that comes
/// with them, more leave the cache.
constexpr Index rows_at_once = 8 * tile_rows;

/// The state of the model along a tile, and C x.
struct Trajectory {
  Matrix states;   // n x count
  Matrix outputs;  // p x count
};

Trajectory advance(const StateSpaceModel& model, const Record& record, Index begin, Index count,
                   Vector& x) {
  Trajectory result{Matrix(model.order(), count), {}};
  const Matrix driven = model.B * record.u.middleRows(begin, count).transpose();
  Vector next(model.order());
  for (Index k = 0; k < count; ++k) {
    result.states.col(k) = x;
    next.noalias() = model.A * x;
    x = next + driven.col(k);
  }
  result.outputs = model.C * result.states;
  return result;
}

/// Where the local column `i` of an output's rows stands among all columns.
Index global(const Columns& columns, Index output, Index i) {
  const Index common = columns.output(0);
  if (i < common) return i;
  if (i < common + columns.per_output()) return columns.output(output) + (i - common);
  return columns.target();
}

}  // namespace

void walk_regression(const Columns& columns, const StateSpaceModel& model, const Record& record,
                     const Segment& segment, const Vector& x0,
                     const std::function<void(const RegressionRows&)>& visit) {
  const Index n = columns.n, m = columns.m, p = columns.p;
  const Index extra = columns.moves ? p : 0;
  const Index common = columns.output(0), width = common + columns.per_output() + 1;
  std::vector<DualFilters> filters;  // of x0, whose regressors start as c, then of B and L
  for (Index q = 0; q < p; ++q) {
    Matrix states = Matrix::Zero(n, 1 + m + extra);
    states.col(0) = model.C.row(q).transpose();
    filters.emplace_back(model.A, model.C.row(q).transpose(), std::move(states));
  }
  Vector x = x0;
  Matrix values(width, tile_rows), driving = Matrix::Zero(1 + m + extra, tile_rows);
  for (Index begin = segment.begin; begin < segment.end; begin += tile_rows) {
    const Index count = std::min(tile_rows, segment.end - begin);
    driving.block(1, 0, m, count) = record.u.middleRows(begin, count).transpose();
    Trajectory trajectory;
    if (columns.moves) {
      trajectory = advance(model, record, begin, count, x);
      driving.bottomLeftCorner(p, count) = trajectory.outputs;
    }
    for (Index q = 0; q < p; ++q) {
      filters[static_cast<std::size_t>(q)].run(driving.data(), count, values.data(), width);
      const Index direct = columns.direct_inputs();
      values.block(common, 0, direct, count) = driving.block(1, 0, direct, count);
      values.row(common + direct).head(count).setOnes();
      if (columns.per_output() > direct + 1)
        values.block(common + direct + 1, 0, n, count) = trajectory.states;
      values.row(width - 1).head(count) = record.y.col(q).segment(begin, count).transpose();
      visit({q, values.leftCols(count)});
    }
  }
}

NormalEquations::NormalEquations(const Columns& columns)
    : columns_(columns),
      of_output_(static_cast<std::size_t>(columns.p),
                 Matrix::Zero(columns.output(0) + columns.per_output() + 1,
                              columns.output(0) + columns.per_output() + 1)),
      sums_(Matrix::Zero(columns.count() - columns.n, columns.count() - columns.n)) {}

void NormalEquations::add(const RegressionRows& rows) {
  const VectorSequence sequence{rows.values.data(), rows.values.rows(), rows.values.outerStride()};
  add_outer_products(sequence, sequence, rows.values.cols(), Triangle::lower,
                     of_output_[static_cast<std::size_t>(rows.output)].data());
}

void NormalEquations::end_segment() {
  const Index n = columns_.n, rest = columns_.count() - n;
  Matrix sums = Matrix::Zero(columns_.count(), columns_.count());
  for (Index q = 0; q < columns_.p; ++q) {
    Matrix& own = of_output_[static_cast<std::size_t>(q)];
    for (Index j = 0; j < own.cols(); ++j)
      for (Index i = j; i < own.rows(); ++i)
        sums(global(columns_, q, i), global(columns_, q, j)) += own(i, j);
    own.setZero();
  }
  sums.triangularView<Eigen::StrictlyUpper>() = sums.transpose();
  Elimination elimination{pseudo_inverse(sums.topLeftCorner(n, n)), sums.topRightCorner(n, rest)};
  sums_ += sums.bottomRightCorner(rest, rest);
  sums_.noalias() -= elimination.coupling.transpose() * elimination.inverse * elimination.coupling;
  segments_.push_back(std::move(elimination));
}

namespace {

/// 0 of 0.
Vector inverse_roots(const Vector& values) {
  return values.unaryExpr([](double value) { return value > 0 ? 1 / std::sqrt(value) : 0.0; });
}

}  // namespace

std::optional<RegressionSolution> NormalEquations::solve(double damping, double least_pivot,
                                                         double least_rcond) const {
  const Index n = columns_.n, unknowns = columns_.target() - n;
  Vector weight = sums_.diagonal().head(unknowns);
  const auto damp = [&](Index begin, Index count) {
    weight.segment(begin - n, count) *= 1 + damping;
  };
  if (columns_.moves) {
    damp(columns_.dynamics(), n * columns_.p);
    for (Index q = 0; columns_.p > 1 && q < columns_.p; ++q) damp(columns_.output_map(q), n);
  }
  Matrix G = sums_.topLeftCorner(unknowns, unknowns);
  G.diagonal() = weight;
  const Vector scale = inverse_roots(weight);
  G = (scale.asDiagonal() * G * scale.asDiagonal()).eval();
  const auto cholesky = Cholesky::of(G, least_pivot, least_rcond);
  if (!cholesky) return std::nullopt;

  const Vector target = sums_.col(unknowns).head(unknowns);
  return solution_of(scale.asDiagonal() * cholesky->solve(Vector(scale.asDiagonal() * target)));
}

std::optional<NormalEquations::Components> NormalEquations::components() const {
  const Index unknowns = columns_.target() - columns_.n;
  const Vector scale = inverse_roots(sums_.diagonal().head(unknowns));
  const SymmetricEigen eigen = symmetric_eigen(
      scale.asDiagonal() * sums_.topLeftCorner(unknowns, unknowns) * scale.asDiagonal());
  if (!eigen.converged) return std::nullopt;
  return Components{
      scale, eigen.vectors, eigen.values,
      eigen.vectors.transpose() * (scale.asDiagonal() * sums_.col(unknowns).head(unknowns))};
}

std::optional<RegressionSolution> NormalEquations::solve_without_small(double least_size) const {
  constexpr double noise = 1e-3;      // of the target
  constexpr double unseen = 0.01;     // of what is left of it
  constexpr double rounding = 1e-13;  // of the sums
  const auto found = components();
  if (!found) return std::nullopt;
  const auto& [scale, columns, squares, target] = *found;
  const Vector inverse = squares.unaryExpr(
      [least_size](double value) { return value > least_size * least_size ? 1 / value : 0.0; });
  RegressionSolution solution =
      solution_of(scale.asDiagonal() * (columns * inverse.cwiseProduct(target)));
  double left_out = 0;
  for (Index i = 0; i < squares.size(); ++i)
    if (inverse(i) == 0 && squares(i) > rounding) left_out += target(i) * target(i) / squares(i);
  const double total = sums_(squares.size(), squares.size());
  if (!(total > 0 && solution.sum_of_squares > noise * noise * total &&
        left_out < unseen * solution.sum_of_squares))
    return std::nullopt;
  return solution;
}

std::optional<RegressionSolution> NormalEquations::solve_shrunk(double half_at,
                                                                double least_size) const {
  const auto found = components();
  if (!found) return std::nullopt;
  const auto& [scale, columns, squares, target] = *found;
  Vector coefficients = Vector::Zero(squares.size());
  for (Index i = 0; i < squares.size(); ++i) {
    if (!(squares(i) > least_size * least_size)) continue;
    const double explained = target(i) * target(i) / squares(i);
    if (explained > 0)
      coefficients(i) = target(i) / squares(i) * (explained / (explained + half_at));
  }
  return solution_of(scale.asDiagonal() * (columns * coefficients));
}

std::optional<std::vector<RegressionSolution>> NormalEquations::influences(
    const Matrix& combinations) const {
  constexpr double rounding = 1e-14;  // of the sums
  const auto found = components();
  if (!found) return std::nullopt;
  const auto weigh = found->scale.asDiagonal();
  const Vector inverse = found->squares.cwiseMax(rounding).cwiseInverse();
  const Matrix solved =
      weigh * (found->columns *
               (inverse.asDiagonal() * (found->columns.transpose() * (weigh * combinations))));
  std::vector<RegressionSolution> result;
  for (Index i = 0; i < solved.cols(); ++i) {
    RegressionSolution& one = result.emplace_back();
    one.theta = Vector::Zero(columns_.target());
    one.theta.tail(solved.rows()) = solved.col(i);
    for (const Elimination& e : segments_)
      one.x0.push_back(-(e.inverse * (e.coupling.leftCols(solved.rows()) * solved.col(i))));
  }
  return result;
}

/// With the sum of squares of the undamped equations.
RegressionSolution NormalEquations::solution_of(const Vector& found) const {
  const Index unknowns = found.size();
  const Vector target = sums_.col(unknowns).head(unknowns);
  RegressionSolution solution{Vector::Zero(columns_.target()), {}, 0};
  solution.theta.tail(unknowns) = found;
  solution.sum_of_squares =
      std::max(0.0, sums_(unknowns, unknowns) - 2 * target.dot(found) +
                        found.dot(sums_.topLeftCorner(unknowns, unknowns) * found));
  for (const Elimination& e : segments_)
    solution.x0.push_back(e.inverse *
                          (e.coupling.rightCols(1) - e.coupling.leftCols(unknowns) * found));
  return solution;
}

namespace {

Matrix triangular(const Eigen::Ref<const Matrix>& rows) {
  return triangular_factor(rows);
}

/// The triangular factor of `factor` with `rows` below.
Matrix folded(const Matrix& factor, const Eigen::Ref<const Matrix>& rows) {
  Matrix both(factor.rows() + rows.rows(), rows.cols());
  both << factor, rows;
  return triangular(both);
}

}  // namespace

OrthogonalFactor::OrthogonalFactor(const Columns& columns)
    : columns_(columns),
      waiting_(rows_at_once, columns.count()),
      open_(0, columns.count()),
      factor_(0, columns.count() - columns.n) {}

void OrthogonalFactor::add(const RegressionRows& rows) {
  if (waiting_rows_ + rows.values.cols() > rows_at_once) fold();
  auto own = waiting_.middleRows(waiting_rows_, rows.values.cols());
  own.setZero();
  for (Index i = 0; i < rows.values.rows(); ++i)
    own.col(global(columns_, rows.output, i)) = rows.values.row(i).transpose();
  waiting_rows_ += rows.values.cols();
}

void OrthogonalFactor::fold() {
  if (waiting_rows_ == 0) return;
  open_ = folded(open_, waiting_.topRows(waiting_rows_));
  waiting_rows_ = 0;
}

void OrthogonalFactor::end_segment() {
  fold();
  const Index own = std::min(columns_.n, open_.rows()), rest = columns_.count() - columns_.n;
  segments_.push_back(open_.topRows(own));
  factor_ = folded(factor_, open_.bottomRightCorner(open_.rows() - own, rest));
  open_.resize(0, columns_.count());
}

RegressionSolution OrthogonalFactor::solve() const {
  const Index unknowns = columns_.target() - columns_.n;
  return solution_of(solve_least_norm(factor_.leftCols(unknowns), Vector(factor_.col(unknowns))));
}

RegressionSolution OrthogonalFactor::solve_with_prior(double variance) const {
  constexpr double surely = 16;  // squared deviations
  constexpr double rounding = 1e-13;
  const Index unknowns = columns_.target() - columns_.n;
  const Vector target = factor_.col(unknowns);
  const Vector scale =
      inverse_roots(factor_.leftCols(unknowns).colwise().squaredNorm().transpose());
  const Matrix scaled = factor_.leftCols(unknowns) * scale.asDiagonal();
  const auto [components, sizes] = left_singular(scaled.transpose(), SingularVectors::thin);
  const double square = target.squaredNorm(),
               ridge = square > 0 ? double(unknowns) * variance / square : 0;
  Vector coefficients = Vector::Zero(sizes.size());
  for (Index i = 0; i < sizes.size(); ++i) {
    const double size = sizes(i);
    if (!(size > rounding)) continue;
    const double explained = target.dot(scaled * components.col(i)) / size;
    coefficients(i) = explained * explained > surely * variance
                          ? explained / size
                          : explained * size / (size * size + ridge);
  }
  return solution_of(scale.asDiagonal() * (components * coefficients));
}

RegressionSolution OrthogonalFactor::solution_of(const Vector& found) const {
  const Index n = columns_.n, unknowns = found.size();
  RegressionSolution solution{Vector::Zero(columns_.target()), {}, 0};
  solution.theta.tail(unknowns) = found;
  solution.sum_of_squares =
      (factor_.col(unknowns) - factor_.leftCols(unknowns) * found).squaredNorm();
  for (const Matrix& rows : segments_)
    solution.x0.push_back(solve_least_norm(
        rows.leftCols(n), Matrix(rows.rightCols(1) - rows.middleCols(n, unknowns) * found)));
  return solution;
}

}  // namespace reident::identification
