#include "identification/statistics/error_confidence.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "identification/statistics/correlation.hpp"
#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

/// Fewer rows give no interval. A block is at most so long that there are as many blocks.
constexpr Index least_rows = 50;
constexpr Index least_blocks = 10;
constexpr Index most_interval_blocks = 250;
constexpr Index replicates = 1000;
constexpr double lengthening = 3;
constexpr std::uint32_t seed = 20170717;

/// The block length, in rows, of least mean square error for the variance of a mean.
double optimal_block(const Vector& e2, const Vector& y2, const std::vector<RowRange>& segments) {
  Series psi(e2 / e2.mean() - y2 / y2.mean(), segments);
  const double S = correlated_rows(psi), correlated = (S * S - 1) / (2 * S);
  return std::cbrt(1.5 * correlated * correlated * double(e2.size()));
}

/// Sums of squares over the blocks of `length` rows that start at each row, the first rows
/// following the last: column s holds e^2 of all outputs, then y^2.
Matrix block_sums(const Matrix& squares, Index length) {
  const Index rows = squares.cols();
  Matrix sums(squares.rows(), rows);
  Vector before = Vector::Zero(squares.rows());
  Matrix prefix(squares.rows(), rows + length + 1);
  for (Index k = 0; k < rows + length; ++k) {
    prefix.col(k) = before;
    before += squares.col(k % rows);
  }
  prefix.col(rows + length) = before;
  for (Index s = 0; s < rows; ++s) sums.col(s) = prefix.col(s + length) - prefix.col(s);
  return sums;
}

/// The p errors of each replicate, and their mean below them.
Matrix resampled_errors(const Matrix& sums, Index blocks) {
  const Index p = sums.rows() / 2;
  const auto starts = static_cast<std::uint64_t>(sums.cols());
  std::mt19937 generator(seed);  // the same numbers everywhere, unlike the standard distributions
  Matrix errors(p + 1, replicates);
  Vector total(2 * p);
  for (Index r = 0; r < replicates; ++r) {
    total.setZero();
    for (Index block = 0; block < blocks; ++block)
      total += sums.col(static_cast<Index>((generator() * starts) >> 32));
    errors.col(r).head(p) = 100 * (total.head(p).array() / total.tail(p).array()).sqrt();
    errors(p, r) = errors.col(r).head(p).mean();
  }
  return errors;
}

struct Ends {
  double low, high;
};

/// The values below which shares `tail` and 1 - `tail` of the row lie.
Ends percentiles(Vector values, double tail) {
  std::sort(values.begin(), values.end());
  const auto at = [&values](double share) {
    const double rank = share * double(values.size() - 1);
    const auto below = static_cast<Index>(rank);
    const Index above = std::min(below + 1, values.size() - 1);
    return values(below) + (rank - double(below)) * (values(above) - values(below));
  };
  return {at(tail), at(1 - tail)};
}

/// The share of replicates beyond either end.
double expanded_tail(Index blocks) {
  const auto b = double(blocks);
  const double reach = student_quantile(0.975, b - 1) * std::sqrt(b / (b - 1));
  return 0.5 * std::erfc(reach / std::numbers::sqrt2);
}

}  // namespace

std::optional<ErrorInterval> error_interval(const Matrix& y, const Matrix& y_hat,
                                            const std::vector<RowRange>& segments) {
  assert(y.rows() == y_hat.rows() && y.cols() == y_hat.cols());
  const Index N = y.rows(), p = y.cols();
  if (N < least_rows) return std::nullopt;
  const Matrix e2 = (y - y_hat).cwiseAbs2(), y2 = y.cwiseAbs2();
  const Vector errors = e2.colwise().sum(), sizes = y2.colwise().sum();
  if (!errors.allFinite() || !sizes.allFinite() || !(errors.minCoeff() > 0) ||
      !(sizes.minCoeff() > 0))
    return std::nullopt;

  double optimal = 0;
  for (Index q = 0; q < p; ++q)
    optimal = std::max(optimal, optimal_block(e2.col(q), y2.col(q), segments));
  const Index longest = N / least_blocks;
  const Index shortest = (N + most_interval_blocks - 1) / most_interval_blocks;
  ErrorInterval result{Vector(p), Vector(p)};
  result.block_rows =
      std::clamp(static_cast<Index>(std::ceil(lengthening * optimal)), shortest, longest);
  result.replicates = replicates;
  result.too_few_rows = optimal > double(longest);

  Matrix squares(2 * p, N);
  squares << e2.transpose(), y2.transpose();
  const Index blocks = (N + result.block_rows - 1) / result.block_rows;
  const Matrix resampled = resampled_errors(block_sums(squares, result.block_rows), blocks);
  const double tail = expanded_tail(blocks);
  for (Index q = 0; q < p; ++q) {
    const Ends ends = percentiles(resampled.row(q).transpose(), tail);
    result.low(q) = ends.low;
    result.high(q) = ends.high;
  }
  const Ends mean = percentiles(resampled.row(p).transpose(), tail);
  result.mean_low = mean.low;
  result.mean_high = mean.high;
  return result;
}

ErrorSpread error_spread(const Matrix& y, const Matrix& y_hat) {
  const Index parts = std::clamp<Index>(y.rows() / 10, 1, 10);
  const Matrix e = y - y_hat;
  Matrix errors(y.cols(), parts);
  for (Index part = 0; part < parts; ++part) {
    const Index begin = y.rows() * part / parts, end = y.rows() * (part + 1) / parts;
    for (Index q = 0; q < y.cols(); ++q) {
      const double error = e.col(q).segment(begin, end - begin).norm();
      const double share = std::sqrt(double(y.rows()) / double(end - begin));
      errors(q, part) = error == 0 ? 0 : 100 * share * error / y.col(q).norm();
    }
  }
  ErrorSpread result{parts, Vector(y.cols()), Vector(y.cols()), Vector(y.cols())};
  for (Index q = 0; q < y.cols(); ++q) {
    Vector sorted = errors.row(q).transpose();
    std::sort(sorted.begin(), sorted.end());
    result.smallest(q) = sorted(0);
    result.median(q) = (sorted((parts - 1) / 2) + sorted(parts / 2)) / 2;
    result.largest(q) = sorted(parts - 1);
  }
  return result;
}

}  // namespace reident::identification
