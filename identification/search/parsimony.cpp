#include "identification/search/parsimony.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "identification/simulation/free_run.hpp"
#include "identification/statistics/correlation.hpp"
#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

constexpr double least_deviation = 1e-6;  // of an output's: below it errors are rounding
constexpr double chance_deviations = 4;
constexpr double certain_loss = 2;  // standard errors

/// Coefficients of the autoregression that makes a series white, by Levinson's recursion, with the
/// number of them that has the least BIC.
Vector whitening(Series& series) {
  const Index rows = series.rows();
  const Index most = std::min<Index>({20, rows / 20, series.longest_segment() - 1});
  Vector a(0), best(0);
  double variance = 1, least = 0;
  for (Index n = 1; n <= most; ++n) {
    double left = series.autocorrelation(n);
    for (Index i = 0; i < n - 1; ++i) left -= a(i) * series.autocorrelation(n - 1 - i);
    const double k = left / variance;
    Vector next(n);
    for (Index i = 0; i < n - 1; ++i) next(i) = a(i) - k * a(n - 2 - i);
    next(n - 1) = k;
    a = std::move(next);
    variance *= 1 - k * k;
    if (!(variance > 0)) break;
    const double criterion = double(rows) * std::log(variance) + double(n) * std::log(double(rows));
    if (criterion < least) {
      least = criterion;
      best = a;
    }
  }
  return best;
}

double whitened_squares(const Vector& errors, const Vector& a,
                        const std::vector<RowRange>& ranges) {
  double sum = 0;
  for (const RowRange& range : ranges)
    for (Index t = range.begin + a.size(); t < range.end; ++t) {
      double w = errors(t);
      for (Index i = 0; i < a.size(); ++i) w -= a(i) * errors(t - 1 - i);
      sum += w * w;
    }
  return sum;
}

Matrix errors_of(const Response& fit, const Record& record, RowRange rows) {
  return record.y.middleRows(rows.begin, rows.size()) - free_run(fit.model, record, rows, fit.x0);
}

/// The error of one model over that of another, median over the folds.
double median_ratio(const std::vector<HeldOutError>& one, const std::vector<HeldOutError>& other) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < one.size(); ++i)
    ratios.push_back((one[i].rms + least_deviation) / (other[i].rms + least_deviation));
  std::sort(ratios.begin(), ratios.end());
  return (ratios[(ratios.size() - 1) / 2] + ratios[ratios.size() / 2]) / 2;
}

/// By how many standard errors one model errs more than another, over the parts of all folds.
double loss_in_deviations(const std::vector<HeldOutError>& one,
                          const std::vector<HeldOutError>& other) {
  double sum = 0, squares = 0, count = 0;
  for (std::size_t i = 0; i < one.size(); ++i)
    for (std::size_t k = 0; k < error_blocks; ++k) {
      const double more = one[i].squares[k] - other[i].squares[k];
      sum += more;
      squares += more * more;
      ++count;
    }
  const double mean = sum / count, variance = squares / count - mean * mean;
  return mean > 0 ? mean / std::sqrt(variance / (count - 1)) : 0;
}

}  // namespace

Index parameters_of(Index n, Index m, Index p, bool direct, Index segments) {
  return n * (m + p) + (direct ? m * p : 0) + p + n * segments;
}

bool is_refuted(const Response& simple, const Response& rich, Index extra, const Record& record,
                RowRange rows) {
  assert(extra >= 1);
  const Matrix left_by_simple = errors_of(simple, record, rows);
  const Matrix left_by_rich = errors_of(rich, record, rows);
  const double count = double(rows.size());
  const double floor = least_deviation * least_deviation * count;
  std::vector<RowRange> ranges;
  for (const Segment& segment : segments_from(record, rows))
    ranges.push_back({segment.begin, segment.end});
  double ratio = 0;
  for (Index q = 0; q < record.y.cols(); ++q) {
    Series errors(left_by_rich.col(q), ranges);
    const Vector a = whitening(errors);
    ratio += count * std::log((whitened_squares(left_by_simple.col(q), a, ranges) + floor) /
                              (whitened_squares(left_by_rich.col(q), a, ranges) + floor));
  }
  return !(ratio <= chi_squared_quantile(0.9999, double(extra)));
}

bool errs_more(const std::vector<HeldOutError>& simple, const std::vector<HeldOutError>& rich,
               Index extra, Index fitted, Index held_out) {
  const double by_chance =
      chance_deviations * std::sqrt(double(extra) / (double(fitted) * double(held_out)));
  return median_ratio(simple, rich) > 1 + by_chance &&
         loss_in_deviations(simple, rich) > certain_loss;
}

}  // namespace reident::identification
