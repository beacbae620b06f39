#include "identification/fit/output_error_fit.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "identification/fit/regression.hpp"
#include "identification/fit/whitening.hpp"
#include "identification/numerics/decompositions.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/statistics/correlation.hpp"

namespace reident::identification {
namespace {

/// A response with what the refinement needs besides.
struct Fitted {
  StateSpaceModel model;
  std::vector<Vector> x0;
  double sum_of_squares = 0;
};

Fitted from(const RegressionSolution& solution, const Columns& columns, StateSpaceModel model) {
  const Index n = columns.n, m = columns.m, p = columns.p;
  const double* theta = solution.theta.data();
  model.B = Eigen::Map<const Matrix>(theta + columns.input_gain(), n, m);
  for (Index q = 0; q < p; ++q) {
    if (columns.direct) model.D.row(q) = solution.theta.segment(columns.output(q), m).transpose();
    model.y0(q) = solution.theta(columns.offset(q));
  }
  return {std::move(model), solution.x0, solution.sum_of_squares};
}

/// Rows of a record that a fit is made of, and what is known of its errors: nothing, or the colour
/// of each output's.
struct Target {
  const Record& record;
  const std::vector<Segment>& segments;
  const std::vector<ErrorColour>& colours;
};

const std::vector<ErrorColour> unknown;
/// Errors below this are rounding, in deviations of an output.
constexpr double least_error = 1e-6;

template <typename Accumulator>
Accumulator accumulate(const Columns& columns, const StateSpaceModel& model, const Target& target,
                       const std::vector<Vector>& x0) {
  Accumulator accumulator(columns);
  std::vector<Whitener> whiteners(target.colours.begin(), target.colours.end());
  const auto add = [&](const RegressionRows& rows) {
    if (whiteners.empty()) return accumulator.add(rows);
    const Matrix white = whiteners[static_cast<std::size_t>(rows.output)].white(rows.values);
    accumulator.add({rows.output, white});
  };
  for (std::size_t i = 0; i < target.segments.size(); ++i) {
    for (Whitener& whitener : whiteners) whitener.begin_segment();
    walk_regression(columns, model, target.record, target.segments[i],
                    x0.empty() ? Vector() : x0[i], add);
    accumulator.end_segment();
  }
  return accumulator;
}

/// An error of 1e-16 in the sums moves the solution by that over the pivot's square.
double least_pivot(Accuracy accuracy) {
  return accuracy == Accuracy::fast ? 1e-5 : 1e-3;
}

Columns columns_of(const StateSpaceModel& dynamics, bool direct) {
  return {dynamics.order(), dynamics.inputs(), dynamics.outputs(), direct, false};
}

/// The outputs over the segments, which follow each other.
Matrix outputs_of(const Fitted& fitted, const Record& record,
                  const std::vector<Segment>& segments) {
  const Index first = segments.front().begin;
  Matrix outputs(segments.back().end - first, record.y.cols());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const auto [begin, end, tick] = segments[i];
    outputs.middleRows(begin - first, end - begin) =
        free_run(fitted.model, record, {begin, end}, fitted.x0[i]);
  }
  return outputs;
}

/// Rows that count as one in the errors of the output whose errors last longest.
double correlated_rows_of_errors(const Fitted& fitted, const Record& record, RowRange rows,
                                 const std::vector<Segment>& segments) {
  return most_correlated_rows(
      record.y.middleRows(rows.begin, rows.size()) - outputs_of(fitted, record, segments),
      ranges_from(record, rows));
}

/// Variance of an error, times the rows of errors that count as one: what an estimate's variance is
/// made of. Absent where there are no more rows than unknowns.
std::optional<double> variance_of_errors(const Fitted& fitted, const Columns& columns,
                                         const Target& target) {
  const RowRange rows{target.segments.front().begin, target.segments.back().end};
  const double known = double(rows.size() * columns.p - (columns.target() - columns.n)) -
                       double(columns.n) * double(target.segments.size());
  if (known < 1) return std::nullopt;
  const double rows_as_one =
      target.colours.empty()
          ? correlated_rows_of_errors(fitted, target.record, rows, target.segments)
          : 1;
  return fitted.sum_of_squares / known * rows_as_one;
}

Fitted fit(const NormalEquations& sums, const StateSpaceModel& dynamics, bool direct,
           const Target& target, Accuracy accuracy) {
  const Columns columns = columns_of(dynamics, direct);
  // Small pivots show a bad condition, but not every bad condition has one.
  const double pivot = least_pivot(accuracy),
               rcond = accuracy == Accuracy::fast ? 0 : pivot * pivot;
  if (const auto solution = sums.solve(0, pivot, rcond)) return from(*solution, columns, dynamics);
  if (accuracy == Accuracy::fast)
    if (const auto solution = sums.solve_without_small(pivot))
      return from(*solution, columns, dynamics);
  const auto factor = accumulate<OrthogonalFactor>(columns, dynamics, target, {});
  Fitted full = from(factor.solve(), columns, dynamics);
  if (accuracy == Accuracy::fast) return full;
  const auto variance = variance_of_errors(full, columns, target);
  return variance ? from(factor.solve_with_prior(*variance), columns, dynamics) : full;
}

Fitted fit(const StateSpaceModel& dynamics, bool direct, const Target& target, Accuracy accuracy) {
  const auto sums = accumulate<NormalEquations>(columns_of(dynamics, direct), dynamics, target, {});
  return fit(sums, dynamics, direct, target, accuracy);
}

Response response_of(const Fitted& fitted, Index rows) {
  return {fitted.model, fitted.x0.empty() ? Vector::Zero(fitted.model.order()) : fitted.x0.front(),
          std::sqrt(fitted.sum_of_squares / double(rows))};
}

StateSpaceModel with_dynamics(const Matrix& A, const Matrix& C, const Record& record) {
  const Index n = A.rows(), m = record.u.cols(), p = C.rows();
  return {A,
          Matrix::Zero(n, m),
          C,
          Matrix::Zero(p, m),
          {},
          Vector::Zero(m),
          Vector::Zero(p),
          record.period_s};
}

bool is_within(const Matrix& A, double least_rate) {
  const ComplexVector modes = eigenvalues(A);
  return std::all_of(modes.begin(), modes.end(), [least_rate](const std::complex<double>& mode) {
    return std::abs(mode) < 1 && !(std::abs(std::log(mode)) < least_rate);
  });
}

/// At most `steps` Levenberg-Marquardt steps on A and C from those of `dynamics`.
Fitted refined(const StateSpaceModel& dynamics, bool direct, const Target& target, int steps,
               double least_rate) {
  const Columns columns{dynamics.order(), dynamics.inputs(), dynamics.outputs(), direct, true};
  Fitted best = fit(dynamics, direct, target, Accuracy::fast);
  double damping = 1e-3;
  for (int step = 0; step < steps; ++step) {
    const auto sums = accumulate<NormalEquations>(columns, best.model, target, best.x0);
    bool lowered = false;
    double before = best.sum_of_squares;
    for (int attempt = 0; attempt < 5 && !lowered; ++attempt, damping *= 10) {
      const auto solution = sums.solve(damping, least_pivot(Accuracy::fast));
      if (!solution) continue;
      const Matrix L = Eigen::Map<const Matrix>(solution->theta.data() + columns.dynamics(),
                                                columns.n, columns.p);
      Matrix moved_C = best.model.C;
      for (Index q = 0; columns.p > 1 && q < columns.p; ++q)
        moved_C.row(q) += solution->theta.segment(columns.output_map(q), columns.n).transpose();
      const Matrix moved_A = best.model.A + L * best.model.C;
      const StateSpaceModel moved = with_dynamics(moved_A, moved_C, target.record);
      if (!is_well_formed(moved) || !is_within(moved.A, least_rate)) continue;
      Fitted trial = fit(moved, columns.direct, target, Accuracy::fast);
      if (!(trial.sum_of_squares < best.sum_of_squares)) continue;
      best = std::move(trial);
      lowered = true;
      damping /= 100;
    }
    damping = std::max(damping, 1e-9);
    if (!lowered || best.sum_of_squares > before * (1 - 1e-4)) break;
  }
  return best;
}

}  // namespace

Response fit_response(const Matrix& A, const Matrix& C, bool direct, const Record& record,
                      RowRange rows, Accuracy accuracy, const std::vector<ErrorColour>& colours) {
  const std::vector<Segment> segments = segments_within(record, rows);
  return response_of(
      fit(with_dynamics(A, C, record), direct, {record, segments, colours}, accuracy), rows.size());
}

Response fit_change(const Matrix& A, const Matrix& C, const Record& record, RowRange rows) {
  constexpr double squared_deviations = 4;  // of a coefficient that is halved
  const std::vector<Segment> segments = segments_within(record, rows);
  const StateSpaceModel dynamics = with_dynamics(A, C, record);
  const Columns columns = columns_of(dynamics, true);
  const Target target{record, segments, unknown};
  const auto sums = accumulate<NormalEquations>(columns, dynamics, target, {});
  const Fitted full = fit(sums, dynamics, true, target, Accuracy::fast);
  const auto variance = variance_of_errors(full, columns, target);
  if (!variance) return response_of({dynamics, {}, 0}, rows.size());
  const auto shrunk =
      sums.solve_shrunk(squared_deviations * *variance, least_pivot(Accuracy::fast));
  return response_of(shrunk ? from(*shrunk, columns, dynamics) : full, rows.size());
}

std::vector<Matrix> gain_errors_by_row(const Matrix& A, const Matrix& C, bool direct,
                                       const Record& record, RowRange rows) {
  constexpr double well_conditioned = 1e-14;
  const std::vector<Segment> segments = segments_within(record, rows);
  const StateSpaceModel dynamics = with_dynamics(A, C, record);
  const Columns columns = columns_of(dynamics, direct);
  const Index n = columns.n, m = columns.m, p = columns.p, unknowns = columns.target() - n;
  const auto at_rest =  // C (I - A)^-1, by columns
      n == 0 ? Matrix(0, p)
             : solve_full_lu((Matrix::Identity(n, n) - A).transpose(), C.transpose(),
                             well_conditioned);
  const double told = double(rows.size() * p - unknowns) - double(n) * double(segments.size());
  if (!at_rest || told < 1) return {};

  const Target target{record, segments, unknown};
  const auto sums = accumulate<NormalEquations>(columns, dynamics, target, {});
  const Fitted full = fit(sums, dynamics, direct, target, Accuracy::fast);
  const Matrix errors =
      (record.y.middleRows(rows.begin, rows.size()) - outputs_of(full, record, segments)) *
      std::sqrt(double(rows.size() * p) / told);
  Matrix gains = Matrix::Zero(unknowns, m * p);
  for (Index q = 0; q < p; ++q)
    for (Index j = 0; j < m; ++j) {
      auto gain = gains.col(q * m + j);
      gain.segment(columns.input_gain() - n + j * n, n) = at_rest->col(q);
      if (direct) gain(columns.output(q) - n + j) = 1;
    }
  const auto influences = sums.influences(gains);
  if (!influences) return {};
  std::vector<Matrix> result(static_cast<std::size_t>(p), Matrix(rows.size(), m));
  for (Index i = 0; i < m * p; ++i) {
    const Fitted weights = from((*influences)[static_cast<std::size_t>(i)], columns, dynamics);
    result[static_cast<std::size_t>(i / m)].col(i % m) =
        outputs_of(weights, record, segments).cwiseProduct(errors).rowwise().sum();
  }
  return result;
}

Response refine_response(const Matrix& A, const Matrix& C, bool direct, const Record& record,
                         RowRange rows, int steps, double least_rate) {
  const std::vector<Segment> segments = segments_within(record, rows);
  return response_of(
      refined(with_dynamics(A, C, record), direct, {record, segments, unknown}, steps, least_rate),
      rows.size());
}

Matrix errors_of(const Response& fit, const Record& record, RowRange rows) {
  return record.y.middleRows(rows.begin, rows.size()) - free_run(fit.model, record, rows, fit.x0);
}

std::vector<ErrorColour> deviations_of(const Response& fit, const Record& record, RowRange rows) {
  const Matrix errors = errors_of(fit, record, rows);
  std::vector<ErrorColour> colours;
  for (Index q = 0; q < errors.cols(); ++q)
    colours.push_back(
        {{}, std::max(errors.col(q).norm() / std::sqrt(double(rows.size())), least_error)});
  return colours;
}

std::vector<ErrorColour> colours_of(const Response& fit, const Record& record, RowRange rows) {
  const std::vector<RowRange> ranges = ranges_from(record, rows);
  const Matrix errors = errors_of(fit, record, rows);
  std::vector<ErrorColour> colours;
  for (Index q = 0; q < errors.cols(); ++q) {
    Series series(errors.col(q), ranges);
    const double deviation = series.centred().norm() / std::sqrt(double(rows.size()));
    const Autoregression past = autoregression(series);
    colours.push_back({past, std::max(deviation * past.deviation.back(), least_error)});
  }
  return colours;
}

Response refine_whitened(const Response& fit, bool direct, const Record& record, RowRange rows,
                         int steps, const std::vector<ErrorColour>& colours, double least_rate) {
  const std::vector<Segment> segments = segments_within(record, rows);
  return response_of(refined(with_dynamics(fit.model.A, fit.model.C, record), direct,
                             {record, segments, colours}, steps, least_rate),
                     rows.size());
}

}  // namespace reident::identification
