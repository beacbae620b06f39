#include "identification/search/parsimony.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "identification/fit/dual_filters.hpp"
#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/kernels.hpp"
#include "identification/statistics/correlation.hpp"
#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

constexpr double least_deviation = 1e-6;  // of an output's: below it errors are rounding
constexpr double chance_deviations = 4;
constexpr double certain_loss = 2;  // standard errors

/// Rows of segments that lie so many behind their first.
double rows_behind(Index first, const std::vector<Segment>& segments) {
  double rows = 0;
  for (const Segment& segment : segments)
    rows += double(std::max<Index>(0, segment.size() - first));
  return rows;
}

/// A row for each of the mixtures of outputs whose errors are uncorrelated. Where outputs are
/// linear in one another, mixtures without errors are among them.
Matrix uncorrelated_mixtures(const Matrix& errors) {
  const Index p = errors.cols();
  if (p == 1 || !errors.allFinite()) return Matrix::Identity(p, p);
  const SymmetricEigen found = symmetric_eigen(errors.transpose() * errors);
  return found.converged ? Matrix(found.vectors.transpose()) : Matrix::Identity(p, p);
}

/// Sums of squares and products (lower triangle) of the inputs u (m x N), the states of
/// x[t+1] = F x[t] + 1 u[t] for each of them, with F = A and F = slow, and the errors. All are less
/// what their past (of an autoregression) foretells, and less their means in each segment. The
/// states span what a system with these modes makes of the inputs.
Matrix white_products(const Matrix& A, double slow, const Matrix& u, const Vector& errors,
                      const Vector& past, const std::vector<RowRange>& segments) {
  constexpr Index tile_rows = 64;
  const Index n = A.rows(), m = u.rows(), before = past.size(), width = m + n * m + m + 1;
  DualFilters fast(A.transpose(), Vector::Ones(n), Matrix::Zero(n, m));
  DualFilters sums(Matrix::Constant(1, 1, slow), Vector::Ones(1), Matrix::Zero(1, m));
  Matrix values = Matrix::Zero(width, before + tile_rows);  // behind those before
  Matrix white = Matrix::Ones(width + 1, tile_rows);        // the last row for the means
  Matrix products = Matrix::Zero(width, width);
  for (const RowRange& segment : segments) {
    Matrix own = Matrix::Zero(width + 1, width + 1);
    for (Index begin = segment.begin; begin < segment.end; begin += tile_rows) {
      const Index count = std::min(tile_rows, segment.end - begin);
      auto now = values.middleCols(before, count);
      now.topRows(m) = u.middleCols(begin, count);
      fast.run(u.col(begin).data(), count, &now(m, 0), width);
      sums.run(u.col(begin).data(), count, &now(m + n * m, 0), width);
      now.bottomRows(1) = errors.segment(begin, count).transpose();
      auto left = white.topLeftCorner(width, count);
      left = now;
      for (Index i = 0; i < before; ++i) left -= past(i) * values.middleCols(before - 1 - i, count);
      values.leftCols(before) = values.middleCols(count, before).eval();
      const Index unknown = std::clamp<Index>(segment.begin + before - begin, 0, count);
      const VectorSequence rows{white.col(0).data() + unknown * (width + 1), width + 1, width + 1};
      add_outer_products(rows, rows, count - unknown, Triangle::lower, own.data());
    }
    if (segment.size() <= before) continue;
    const Vector totals = own.row(width).head(width);
    products += own.topLeftCorner(width, width) - totals / own(width, width) * totals.transpose();
  }
  return products;
}

Response mixed(Response fit, const Matrix& mixtures) {
  fit.model.C = mixtures * fit.model.C;
  fit.model.D = mixtures * fit.model.D;
  fit.model.y0 = mixtures * fit.model.y0;
  return fit;
}

/// The error of one model over that of another, median over the folds.
double median_ratio(const std::vector<HeldOutError>& one, const std::vector<HeldOutError>& other) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < one.size(); ++i)
    ratios.push_back((one[i].rms + least_deviation) / (other[i].rms + least_deviation));
  std::sort(ratios.begin(), ratios.end());
  return (ratios[(ratios.size() - 1) / 2] + ratios[ratios.size() / 2]) / 2;
}

/// The mean of the values in its standard errors; 0 where it is below zero.
double mean_in_deviations(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const double count = double(values.size()), mean = sum / count;
  return mean > 0 ? mean / std::sqrt((squares / count - mean * mean) / (count - 1)) : 0;
}

/// By how many standard errors one model errs more than another, over the parts of all folds: in
/// squares or, where few parts hold most of these, in their logarithms.
double loss_in_deviations(const std::vector<HeldOutError>& one,
                          const std::vector<HeldOutError>& other) {
  constexpr double floor = least_deviation * least_deviation;
  std::vector<double> more, ratios;
  for (std::size_t i = 0; i < one.size(); ++i)
    for (std::size_t k = 0; k < error_blocks; ++k) {
      more.push_back(one[i].squares[k] - other[i].squares[k]);
      ratios.push_back(std::log((one[i].squares[k] + floor) / (other[i].squares[k] + floor)));
    }
  return std::max(mean_in_deviations(more), mean_in_deviations(ratios));
}

}  // namespace

Index parameters_of(Index n, Index m, Index p, bool direct, Index segments) {
  return n * (m + p) + (direct ? m * p : 0) + p + n * segments;
}

RicherFit::RicherFit(const Response& fit, bool direct, const Record& record, RowRange rows,
                     double least_rate)
    : RicherFit(fit, direct, record, rows, least_rate, errors_of(fit, record, rows)) {}

RicherFit::RicherFit(const Response& fit, bool direct, const Record& record, RowRange rows,
                     double least_rate, const Matrix& errors)
    : mixtures_(uncorrelated_mixtures(errors)),
      mixed_{record.period_s, record.u, record.y * mixtures_.transpose(), record.segments},
      rows_(rows),
      order_(fit.model.order()),
      parameters_(parameters_of(order_, record.u.cols(), 1, direct,
                                std::ssize(segments_within(record, rows)))),
      least_rate_(least_rate),
      colours_(colours_of(mixed(fit, mixtures_), mixed_, rows)),
      squares_(whitened_squares(fit, direct, colours_)),
      correlated_rows_(most_correlated_rows(errors, ranges_from(record, rows))) {}

Vector RicherFit::whitened_squares(const Response& fit, bool direct,
                                   const std::vector<ErrorColour>& colours) const {
  const int most = fit.model.order() == 0 ? 0 : steps;
  const Response white =
      refine_whitened(mixed(fit, mixtures_), direct, mixed_, rows_, most, colours, least_rate_);
  const Matrix errors = errors_of(white, mixed_, rows_);
  const std::vector<RowRange> segments = ranges_from(mixed_, rows_);
  Vector squares(errors.cols());
  for (Index q = 0; q < errors.cols(); ++q)
    squares(q) =
        innovations_of(errors.col(q), colours[static_cast<std::size_t>(q)].past.coefficients.back(),
                       segments)
            .squares;
  return squares;
}

double RicherFit::degrees_of_freedom(const ErrorColour& colour) const {
  const Index past = colour.past.coefficients.back().size();
  return std::max(1.0, rows_behind(past, segments_from(mixed_, rows_)) - double(parameters_));
}

bool RicherFit::refutes(const Response& simple, bool direct, Index extra) const {
  assert(extra >= 1);
  const double count = double(rows_.size());
  const double floor = least_deviation * least_deviation * count;
  // Two states more are an oscillation, at the frequency of all that fits the errors best.
  const double modes = double(std::max<Index>(0, order_ - simple.model.order())) / 2;
  const double places = std::exp(modes * std::log(count) - std::lgamma(modes + 1));
  const double limit = chi_squared_limit(0.01 / places, int(extra));
  const auto errs_too_much = [&](const std::vector<ErrorColour>& colours) {
    const Vector more = whitened_squares(simple, direct, colours);
    double ratio = 0;  // of likelihoods, its logarithm
    for (Index q = 0; q < more.size(); ++q)
      ratio += degrees_of_freedom(colours[static_cast<std::size_t>(q)]) *
               std::log((more(q) + floor) / (squares_(q) + floor));
    return !(ratio <= limit);
  };
  // The richer one may have followed a drift, whose colour is in the simpler one's errors alone.
  return errs_too_much(colours_) &&
         errs_too_much(colours_of(mixed(simple, mixtures_), mixed_, rows_));
}

bool errs_within_steps(const Response& fit, const Record& record, RowRange rows) {
  constexpr double allowed = 1.1;
  const Matrix errors = errors_of(fit, record, rows);
  for (Index q = 0; q < errors.cols(); ++q) {
    const double step = resolution(record.y.col(q).segment(rows.begin, rows.size()));
    if (!(errors.col(q).norm() <= allowed * step * std::sqrt(double(rows.size()) / 12)))
      return false;
  }
  return true;
}

bool drives_slow_modes(const Response& fit, const Record& record, RowRange rows, double rate) {
  constexpr double least_share =
      1e-10;  // of a column's square: below it the columns before have it
  const Index m = record.u.cols(), p = record.y.cols();
  if (rows.size() < 4 * m * (2 + fit.model.order())) return true;
  const std::vector<RowRange> segments = ranges_from(record, rows);
  const Matrix u = record.u.middleRows(rows.begin, rows.size()).transpose();
  const Matrix errors = errors_of(fit, record, rows);
  const Matrix mixed_errors = errors * uncorrelated_mixtures(errors).transpose();
  const double count = double(rows.size());
  const double floor = least_deviation * least_deviation * count;
  double ratio = 0;
  for (Index q = 0; q < p; ++q) {
    const Vector past = burg_coefficients(mixed_errors.col(q), segments);
    Matrix L = white_products(fit.model.A, std::exp(-rate), u, mixed_errors.col(q), past, segments);
    const Index last = L.rows() - 1;
    L(last, last) += floor;
    const Vector scale = L.diagonal().unaryExpr(
        [](double square) { return square > 0 ? 1 / std::sqrt(square) : 0.0; });
    L = (scale.asDiagonal() * L * scale.asDiagonal()).eval();
    L.diagonal().setConstant(1 + least_share);
    if (!cholesky(L.data(), L.rows())) return true;
    const double driven = L.row(last).segment(last - m, m).squaredNorm();
    ratio += count * std::log1p(driven / (L(last, last) * L(last, last)));
  }
  return !(ratio <= chi_squared_quantile(0.99, double(m * p)));
}

bool errs_more(const std::vector<HeldOutError>& simple, const std::vector<HeldOutError>& rich,
               Index extra, double fitted, double held_out) {
  const double by_chance = chance_deviations * std::sqrt(double(extra) / (fitted * held_out));
  return median_ratio(simple, rich) > 1 + by_chance &&
         loss_in_deviations(simple, rich) > certain_loss;
}

}  // namespace reident::identification
