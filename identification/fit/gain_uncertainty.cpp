#include "identification/fit/gain_uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "identification/numerics/decompositions.hpp"
#include "identification/simulation/initial_state.hpp"
#include "identification/statistics/correlation.hpp"

namespace reident::identification {
namespace {

constexpr Index highest_order = 20;
constexpr double affordable = 4e8;  // multiply-adds of the products of the sensitivities
constexpr Index least_rows = 500;
/// Share of a column's square. A change of the basis of the states changes no output: its
/// sensitivity is rounding. Other combinations of which as little shows are as good as unknown.
constexpr double ridge = 1e-13;
constexpr double deviations_told = 2;  // 95 %

/// The parameters of a model, one after the other: A, B and C by rows, D likewise, y0.
struct Parameters {
  Index n, m, p;
  bool direct;

  Index A(Index row, Index column) const { return row * n + column; }
  Index B(Index row, Index input) const { return n * n + row * m + input; }
  Index C(Index output, Index column) const { return n * (n + m) + output * n + column; }
  Index D(Index output, Index input) const { return n * (n + m + p) + output * m + input; }
  Index y0(Index output) const { return n * (n + m + p) + (direct ? p * m : 0) + output; }
  Index count() const { return y0(p); }
  /// Less those that another basis of the states would choose.
  Index free() const { return count() - n * n; }
};

/// What the static gains (by outputs, then inputs) change with each parameter.
std::optional<Matrix> gradients(const StateSpaceModel& model, const Parameters& at) {
  constexpr double well_conditioned = 1e-14;
  const Matrix rest = Matrix::Identity(at.n, at.n) - model.A;
  Matrix left(at.p, at.n), right(at.n, at.m);
  if (at.n > 0) {
    const auto transposed = solve_full_lu(rest.transpose(), model.C.transpose(), well_conditioned);
    const auto states = solve_full_lu(rest, model.B, well_conditioned);
    if (!transposed || !states) return std::nullopt;
    left = transposed->transpose();
    right = *states;
  }
  Matrix result = Matrix::Zero(at.count(), at.p * at.m);
  for (Index q = 0; q < at.p; ++q)
    for (Index j = 0; j < at.m; ++j) {
      auto gain = result.col(q * at.m + j);
      for (Index a = 0; a < at.n; ++a) {
        for (Index b = 0; b < at.n; ++b) gain(at.A(a, b)) = left(q, a) * right(b, j);
        gain(at.B(a, j)) = left(q, a);
        gain(at.C(q, a)) = right(a, j);
      }
      if (at.direct) gain(at.D(q, j)) = 1;
    }
  return result;
}

/// What each output of a segment, row by row, changes with each parameter, with what an initial
/// state explains taken out, and the errors of the model likewise.
class Segments {
 public:
  Segments(const StateSpaceModel& model, const Parameters& at, const Record& record, RowRange rows)
      : sensitivities(rows.size() * at.p, at.count()), errors(rows.size() * at.p) {
    for (const Segment& segment : segments_within(record, rows)) {
      Matrix of_states(segment.size() * at.p, at.n);
      const Index first = (segment.begin - rows.begin) * at.p;
      run(model, at, record, segment, first, of_states);
      auto own = sensitivities.middleRows(first, of_states.rows());
      auto left = errors.segment(first, of_states.rows());
      if (at.n == 0) continue;
      own -= (of_states * solve_least_norm(of_states, Matrix(own))).eval();
      left -= (of_states * solve_least_norm(of_states, Vector(left))).eval();
    }
  }

  Matrix sensitivities;  // rows x outputs, by parameters
  Vector errors;

 private:
  void run(const StateSpaceModel& model, const Parameters& at, const Record& record,
           const Segment& segment, Index first, Matrix& of_states) {
    Vector state = estimate_initial_state(model, record, {segment}, state_rows);
    Matrix by_A = Matrix::Zero(at.n, at.n * at.n), by_B = Matrix::Zero(at.n, at.n * at.m);
    Matrix by_state = Matrix::Identity(at.n, at.n);
    for (Index row = segment.begin; row < segment.end; ++row) {
      const Vector u = record.u.row(row).transpose() - model.u0;
      const Vector y = model.C * state + model.D * u + model.y0;
      const Index place = first + (row - segment.begin) * at.p;
      auto own = sensitivities.middleRows(place, at.p);
      own.setZero();
      own.leftCols(at.n * at.n) = model.C * by_A;
      own.middleCols(at.n * at.n, at.n * at.m) = model.C * by_B;
      for (Index q = 0; q < at.p; ++q) {
        own.row(q).segment(at.C(q, 0), at.n) = state.transpose();
        if (at.direct) own.row(q).segment(at.D(q, 0), at.m) = u.transpose();
        own(q, at.y0(q)) = 1;
      }
      of_states.middleRows(place - first, at.p) = model.C * by_state;
      errors.segment(place, at.p) = record.y.row(row).transpose() - y;
      by_A = (model.A * by_A).eval();
      by_B = (model.A * by_B).eval();
      by_state = (model.A * by_state).eval();
      for (Index a = 0; a < at.n; ++a) {
        by_A.row(a).segment(a * at.n, at.n) += state.transpose();
        by_B.row(a).segment(a * at.m, at.m) += u.transpose();
      }
      state = (model.A * state + model.B * u).eval();
    }
  }
};

}  // namespace

std::optional<Matrix> gain_uncertainty(const StateSpaceModel& model, bool direct,
                                       const Record& record, RowRange rows) {
  const Parameters at{model.order(), model.inputs(), model.outputs(), direct};
  if (at.n > highest_order || !static_gain(model)) return std::nullopt;
  const double work = double(at.count()) * double(at.count()) * double(at.p);
  const Index most = std::max(least_rows, static_cast<Index>(affordable / work));
  rows.begin = std::max(rows.begin, rows.end - most);
  const std::vector<RowRange> segments = ranges_from(record, rows);
  const double told = double(rows.size() * at.p - at.free()) - double(at.n * std::ssize(segments));
  auto gains = gradients(model, at);
  if (!gains || told < 1) return std::nullopt;

  Segments found(model, at, record, rows);
  // Each output in what the model errs on it.
  const auto by_output = found.errors.reshaped(at.p, rows.size());
  Vector deviations = by_output.rowwise().norm() / std::sqrt(double(rows.size()));
  deviations = (deviations.array() > 0).select(deviations, 1);
  const Vector weights = deviations.cwiseInverse().replicate(rows.size(), 1);
  found.errors.array() *= weights.array() * std::sqrt(double(rows.size() * at.p) / told);
  found.sensitivities.array().colwise() *= weights.array();

  const Vector sizes = found.sensitivities.colwise().norm().transpose();
  const Vector per_size = (sizes.array() > 0).select(sizes.cwiseInverse(), 0.0);
  found.sensitivities *= per_size.asDiagonal();
  Matrix products = found.sensitivities.transpose() * found.sensitivities;
  products.diagonal().setConstant(1 + ridge);
  const auto factor = Cholesky::of(products, 0);
  if (!factor) return std::nullopt;
  const Matrix influences =
      found.sensitivities * factor->solve(Matrix(per_size.asDiagonal() * *gains));
  Matrix result(at.p, at.m);
  for (Index q = 0; q < at.p; ++q)
    for (Index j = 0; j < at.m; ++j) {
      const Vector moves = influences.col(q * at.m + j).cwiseProduct(found.errors);
      Series by_row(moves.reshaped(at.p, rows.size()).colwise().sum().transpose(), segments);
      result(q, j) =
          deviations_told * std::sqrt(by_row.centred().squaredNorm() * correlated_rows(by_row));
    }
  if (!result.allFinite()) return std::nullopt;
  return result;
}

}  // namespace reident::identification
