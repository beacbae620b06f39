#include "identification/search/parsimony.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "identification/simulation/free_run.hpp"
#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

constexpr double least_deviation = 1e-6;  // of an output's: below it errors are rounding
constexpr double chance_deviations = 4;
constexpr double certain_loss = 2;  // standard errors

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

bool is_refuted(const Response& simple, const Response& rich,
                const std::vector<ErrorColour>& colours, Index extra, const Record& record,
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
    const Vector& a = colours[static_cast<std::size_t>(q)].past.coefficients.back();
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
