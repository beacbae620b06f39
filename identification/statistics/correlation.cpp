#include "identification/statistics/correlation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "identification/numerics/kernels.hpp"
#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

constexpr double confidence = 0.95;
const double two_sided = normal_quantile((1 + confidence) / 2);

/// sum a[t - lag] b[t] within the segments, for `count` lags from `first_lag` (at least 0) on. Of
/// `taken` samples of a at once, each meets as many of b for its lags: those at a constant lag lie
/// on a diagonal of the outer products.
Vector lagged_products(const Vector& a, const Vector& b, const std::vector<RowRange>& segments,
                       Index first_lag, Index count) {
  constexpr Index taken = 6;
  const Index met = count + taken - 1;
  Matrix products = Matrix::Zero(met, taken);
  for (const RowRange& segment : segments) {
    const Index pairs = segment.size() - first_lag;
    if (pairs < 1) continue;
    const Index blocks = (pairs + taken - 1) / taken;
    Vector early = Vector::Zero(blocks * taken), late = Vector::Zero((blocks - 1) * taken + met);
    early.head(pairs) = a.segment(segment.begin, pairs);
    late.head(pairs) = b.segment(segment.begin + first_lag, pairs);
    add_outer_products({late.data(), met, taken}, {early.data(), taken, taken}, blocks,
                       Triangle::full, products.data());
  }
  Vector sums = Vector::Zero(count);
  for (Index j = 0; j < taken; ++j) sums += products.col(j).segment(j, count);
  return sums;
}

double normalised(double product, double energy) {
  return energy == 0 ? 0 : product / energy;
}

/// The largest lag up to `lags` that the rows can say something of.
Index reach_within(const Series& series, Index lags) {
  return std::max<Index>(0, std::min({lags, series.rows() / 4, series.longest_segment() - 1}));
}

/// 1 + 2 sum term(k) over the window, at least 1.
template <typename Term>
double windowed_sum(const Series& series, Term term) {
  const Index last = reach_within(series, Series::longest_sum);
  double sum = 1;
  for (Index lag = 1; lag <= last; ++lag) {
    sum += 2 * term(lag);
    if (double(lag) >= 5 * sum) break;
  }
  return std::max(1.0, sum);
}

}  // namespace

Series::Series(Vector values, std::vector<RowRange> segments)
    : centred_(std::move(values)), segments_(std::move(segments)) {
  // The mean of a constant may be rounded: it does not move all the same.
  const bool constant = centred_.size() == 0 || centred_.maxCoeff() == centred_.minCoeff();
  if (constant)
    centred_.setZero();
  else
    centred_.array() -= centred_.mean();
  energy_ = centred_.squaredNorm();
}

Index Series::longest_segment() const {
  Index longest = 0;
  for (const RowRange& segment : segments_) longest = std::max(longest, segment.size());
  return longest;
}

Index Series::pairs(Index lag) const {
  Index count = 0;
  for (const RowRange& segment : segments_) count += std::max<Index>(0, segment.size() - lag);
  return count;
}

double Series::autocorrelation(Index lag) {
  constexpr Index at_once = 27;
  while (static_cast<Index>(known_.size()) <= lag) {
    const auto next = static_cast<Index>(known_.size());
    for (const double product : lagged_products(centred_, centred_, segments_, next, at_once))
      known_.push_back(normalised(product, energy_));
  }
  return known_[static_cast<std::size_t>(lag)];
}

Correlogram autocorrelogram(Series& series, Index lags) {
  const Index count = reach_within(series, lags);
  Correlogram result{1, Vector(count), Vector(count)};
  for (Index i = 0; i < count; ++i) {
    result.r(i) = series.autocorrelation(i + 1);
    result.bound(i) = two_sided * std::sqrt(double(series.pairs(i + 1))) / double(series.rows());
  }
  return result;
}

Correlogram cross_correlogram(Series& input, Series& residual, Index lags) {
  assert(input.rows() == residual.rows());
  const Index reach = reach_within(input, lags);
  if (reach == 0) return {};
  const Vector &u = input.centred(), &e = residual.centred();
  const double energy = u.norm() * e.norm();
  const double deviation = std::sqrt(bartlett_factor(input, residual)) / double(input.rows());
  Correlogram result{-reach, Vector(2 * reach + 1), Vector(2 * reach + 1)};
  const Vector before = lagged_products(e, u, input.segments(), 1, reach);
  const Vector behind = lagged_products(u, e, input.segments(), 0, reach + 1);
  for (Index lag = -reach; lag <= reach; ++lag) {
    result.r(lag + reach) = normalised(lag < 0 ? before(-lag - 1) : behind(lag), energy);
    result.bound(lag + reach) =
        two_sided * deviation * std::sqrt(double(input.pairs(std::abs(lag))));
  }
  return result;
}

double bartlett_factor(Series& a, Series& b) {
  return windowed_sum(
      a, [&a, &b](Index lag) { return a.autocorrelation(lag) * b.autocorrelation(lag); });
}

double correlated_rows(Series& series) {
  return windowed_sum(series, [&series](Index lag) { return series.autocorrelation(lag); });
}

double most_correlated_rows(const Matrix& columns, const std::vector<RowRange>& segments) {
  double most = 1;
  for (Index q = 0; q < columns.cols(); ++q) {
    Series series(columns.col(q), segments);
    most = std::max(most, correlated_rows(series));
  }
  return most;
}

CorrelationSummary summary(const Correlogram& correlogram) {
  const Index lags = correlogram.r.size();
  if (lags == 0) return {};
  Index at = 0;
  correlogram.r.cwiseAbs().maxCoeff(&at);
  const double each = std::pow(confidence, 1 / double(lags));
  const Index outside = (correlogram.r.array().abs() > correlogram.bound.array()).count();
  return {lags,
          correlogram.r(at),
          correlogram.first_lag + at,
          correlogram.bound(at),
          correlogram.bound(at) * normal_quantile((1 + each) / 2) / two_sided,
          double(outside) / double(lags)};
}

Portmanteau portmanteau(const Series& series, const Correlogram& correlogram) {
  const Index lags = correlogram.r.size();
  if (lags == 0) return {};
  const auto rows = double(series.rows());
  double sum = 0;
  for (Index i = 0; i < lags; ++i)
    sum += correlogram.r(i) * correlogram.r(i) / double(series.pairs(correlogram.first_lag + i));
  return {rows * (rows + 2) * sum, chi_squared_quantile(confidence, double(lags))};
}

}  // namespace reident::identification
