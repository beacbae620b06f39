#include "identification/search/folds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identification/numerics/decompositions.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/hole_bridging.hpp"
#include "identification/simulation/initial_state.hpp"

namespace reident::identification {
namespace {

/// Mean over outputs of the root mean square over rows.
double rms(const Matrix& errors) {
  return errors.colwise().norm().mean() / std::sqrt(double(errors.rows()));
}

HeldOutError error_of(const Matrix& errors) {
  constexpr double least_error = 1e-6;  // of an output's deviation: below it errors are rounding
  HeldOutError result{rms(errors), {}};
  if (!std::isfinite(result.rms)) return {std::numeric_limits<double>::infinity(), {}};
  result.log_rms = (errors.colwise().norm().array() / std::sqrt(double(errors.rows())))
                       .max(least_error)
                       .log()
                       .mean();
  for (std::size_t i = 0; i < error_blocks; ++i) {
    const auto row = [&](std::size_t k) {
      return static_cast<Index>(k) * errors.rows() / static_cast<Index>(error_blocks);
    };
    result.squares[i] = errors.middleRows(row(i), row(i + 1) - row(i)).squaredNorm();
  }
  return result;
}

/// By what the errors of rows are too small which told the state of a run over them: the estimate
/// of n numbers from K rows of p outputs leaves K p - n degrees of freedom. 1 elsewhere.
/// `carried_on` says that the first state comes from other rows.
Vector losses_to_states(const StateSpaceModel& model, const Record& record, RowRange rows,
                        bool carried_on) {
  Vector losses = Vector::Ones(rows.size());
  const std::vector<Segment> segments = segments_within(record, rows);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& segment = segments[i];
    if (i == 0 ? carried_on : is_bridged(record, segments[i - 1], segment)) continue;
    const Index told = std::min(segment.size(), state_rows), numbers = told * model.outputs();
    losses.segment(segment.begin - rows.begin, told)
        .setConstant(
            std::sqrt(double(numbers) / double(std::max<Index>(1, numbers - model.order()))));
  }
  return losses;
}

HeldOutErrors errors_with(const Matrix& errors, const Vector& shift, const Vector& losses) {
  return {error_of(losses.asDiagonal() * errors),
          error_of(losses.asDiagonal() * (errors.rowwise() - shift.transpose()))};
}

}  // namespace

Fold Fold::with_fit_of(Index rows) const {
  const Index count = std::min(rows, fit.size());
  return {
      is_forwards() ? RowRange{fit.end - count, fit.end} : RowRange{fit.begin, fit.begin + count},
      tune};
}

Fold Fold::with_tune_of(Index rows) const {
  const Index count = std::min(rows, tune.size());
  return {fit, is_forwards() ? RowRange{tune.begin, tune.begin + count}
                             : RowRange{tune.end - count, tune.end}};
}

std::vector<Fold> folds_of(Index rows, double tune_share) {
  const Index tune = std::clamp<Index>(std::lround(double(rows) * tune_share), 2, rows - 1);
  const Index half = tune / 2;
  return {{{0, rows - half}, {rows - half, rows}},
          {{half, rows}, {0, half}},
          {{0, rows - tune}, {rows - tune, rows - half}},
          {{tune, rows}, {half, tune}}};
}

HeldOutErrors held_out_errors(const Response& response, const Record& record, const Fold& fold) {
  // Forwards the state is carried on; backwards the run starts again from its first outputs.
  const bool forwards = fold.is_forwards();
  const RowRange run{fold.fit.begin, forwards ? fold.tune.end : fold.fit.end};
  const Matrix y_hat = free_run(response.model, record, run, response.x0);
  const Matrix residuals =
      record.y.middleRows(fold.fit.begin, fold.fit.size()) - y_hat.topRows(fold.fit.size());
  const Matrix errors = record.y.middleRows(fold.tune.begin, fold.tune.size()) -
                        (forwards ? Matrix(y_hat.bottomRows(fold.tune.size()))
                                  : free_run(response.model, record, fold.tune));
  return errors_with(errors, recent_operating_point(residuals, forwards),
                     losses_to_states(response.model, record, fold.tune, forwards));
}

HeldOutErrors quick_held_out_errors(const StateSpaceModel& model, const Record& record,
                                    const Fold& fold) {
  constexpr Index most_beside = 512;
  const bool forwards = fold.is_forwards();
  const Index beside = std::min(most_beside, fold.fit.size() / 2);
  const RowRange run{fold.tune.begin - (forwards ? beside : 0),
                     fold.tune.end + (forwards ? 0 : beside)};
  const Matrix residuals =
      record.y.middleRows(run.begin, run.size()) - free_run(model, record, run);
  const Index first = fold.tune.begin - run.begin, rows = fold.tune.size();
  const auto fitted = residuals.middleRows(forwards ? 0 : rows, beside);
  return errors_with(residuals.middleRows(first, rows), fitted.colwise().mean().transpose(),
                     losses_to_states(model, record, run, false).segment(first, rows));
}

double held_out_error_of_constant(const Record& record, const std::vector<Fold>& folds) {
  double sum = 0;
  for (const Fold& fold : folds) {
    const Eigen::RowVectorXd mean =
        record.y.middleRows(fold.fit.begin, fold.fit.size()).colwise().mean();
    sum += rms(record.y.middleRows(fold.tune.begin, fold.tune.size()).rowwise() - mean);
  }
  return sum / double(folds.size());
}

double held_out_error_of_sums(const Record& record, const std::vector<Fold>& folds,
                              const std::vector<double>& rates) {
  constexpr Index most_rows = 1000;  // sums are slow: more rows say little more
  const Index m = record.u.cols(), stride = (record.rows() + most_rows - 1) / most_rows;
  const auto thinned = [stride](RowRange rows) {
    return RowRange{(rows.begin + stride - 1) / stride, (rows.end + stride - 1) / stride};
  };
  const Index rows = thinned(record.all()).end;
  const auto count = static_cast<Index>(rates.size());
  Matrix columns(rows, 2 + m + count * (m + 1)), outputs(rows, record.y.cols());
  Matrix sums = Matrix::Zero(count, m + 1);  // the last column for what decays without inputs
  sums.col(m).setOnes();
  const Vector mean = record.u.colwise().mean().transpose();
  const auto decays = [&rates](double ticks) {
    std::vector<std::pair<double, double>> result;  // of a sum, and of an input that is held
    for (const double rate : rates)
      result.emplace_back(std::exp(-rate * ticks),
                          rate > 0 ? -std::expm1(-rate * ticks) / rate : ticks);
    return result;
  };
  const auto of_one_tick = decays(1);
  auto of_hole = of_one_tick;
  const auto advance = [&](Index row, std::int64_t ticks) {
    const auto& own = ticks == 1 ? of_one_tick : (of_hole = decays(double(ticks)));
    for (Index i = 0; i < count; ++i) {
      const auto [decay, held] = own[static_cast<std::size_t>(i)];
      sums.row(i) *= decay;
      sums.row(i).head(m) += held * (record.u.row(row) - mean.transpose());
    }
  };
  const double length =
      double(record.segments.back().end_tick() - record.segments.front().first_tick);
  std::int64_t before = record.segments.front().first_tick;
  for (const Segment& segment : record.segments)
    for (Index row = segment.begin; row < segment.end; ++row) {
      const std::int64_t tick = segment.tick_of(row);
      if (row > 0) advance(row - 1, tick - before);
      before = tick;
      if (row % stride != 0) continue;
      const Index k = row / stride;
      columns.row(k) << 1, double(tick - record.segments.front().first_tick) / length,
          record.u.row(row), sums.reshaped().transpose();
      outputs.row(k) = record.y.row(row);
    }
  double sum = 0;
  for (const Fold& fold : folds) {
    const RowRange fit = thinned(fold.fit), tune = thinned(fold.tune);
    if (fit.size() == 0 || tune.size() == 0) return std::numeric_limits<double>::infinity();
    const Matrix theta = solve_pivoted_qr(Matrix(columns.middleRows(fit.begin, fit.size())),
                                          Matrix(outputs.middleRows(fit.begin, fit.size())));
    sum += rms(outputs.middleRows(tune.begin, tune.size()) -
               columns.middleRows(tune.begin, tune.size()) * theta);
  }
  return sum / double(folds.size());
}

Vector recent_operating_point(const Matrix& residuals, bool towards_end) {
  const Index half = (residuals.rows() + 1) / 2;
  const auto nearest = residuals.middleRows(towards_end ? residuals.rows() - half : 0, half);
  return nearest.colwise().mean().transpose();
}

}  // namespace reident::identification
