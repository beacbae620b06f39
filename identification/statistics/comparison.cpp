#include "identification/statistics/comparison.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "identification/simulation/square_changes.hpp"
#include "identification/statistics/correlation.hpp"
#include "identification/statistics/error_confidence.hpp"
#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

constexpr Index most_blocks = 50;
/// No single range of this share of the rows may decide.
constexpr double range_share = 0.05;
/// A run without error errs by this share of the output all the same, so that it has a logarithm.
constexpr double least_error = 1e-12;

using Array = Eigen::ArrayXd;

/// Sums of squares over some rows, by output.
struct Sums {
  Array incumbent, candidate, y;

  Sums operator-(const Sums& other) const {
    return {incumbent - other.incumbent, candidate - other.candidate, y - other.y};
  }
};

/// ||e_q|| / ||y_q|| of each output.
Array errors_of(const Array& squares, const Array& y) {
  return (squares.max(0) / y).sqrt() + least_error;
}

double log_ratio(const Sums& sums) {
  return std::log(errors_of(sums.incumbent, sums.y).sum()) -
         std::log(errors_of(sums.candidate, sums.y).sum());
}

/// What each row adds to the logarithm of a run's error, to first order, but for what both runs
/// have in common.
Array influence(const Matrix& squares, const Array& totals, const Array& y) {
  const Array errors = errors_of(totals, y);
  const Array weights = errors / errors.sum() / totals.max(least_error * least_error * y);
  return 0.5 * (squares * weights.matrix()).array();
}

Index block_rows_for(const Matrix& incumbent, const Matrix& candidate, const Sums& sums,
                     const std::vector<RowRange>& segments) {
  const Index rows = incumbent.rows();
  Series difference(
      (influence(incumbent, sums.incumbent, sums.y) - influence(candidate, sums.candidate, sums.y))
          .matrix(),
      segments);
  const double length = 3 * optimal_block_rows(correlated_rows(difference), rows);
  return std::clamp(static_cast<Index>(std::ceil(length)), (rows + most_blocks - 1) / most_blocks,
                    rows / least_blocks);
}

/// By how much the variance of a mean grows where neighbours are alike; of values without mean.
double neighbour_factor(const Array& values) {
  const double energy = values.square().sum();
  if (!(energy > 0)) return 1;
  const Index n = values.size();
  const double r = (values.head(n - 1) * values.tail(n - 1)).sum() / energy;
  return r > 0 ? (1 + r) / (1 - std::min(r, 0.9)) : 1;
}

struct Deviation {
  double of_mean = 0;
  double degrees_of_freedom = 0;
};

/// The deviation of the mean of values in the order of time.
Deviation deviation(const Array& values, Stationarity stationarity) {
  const auto n = double(values.size());
  Array left = values - values.mean();
  double degrees_of_freedom = n - 1;
  const Array times = Array::LinSpaced(values.size(), -(n - 1) / 2, (n - 1) / 2);
  const double slope = (times * left).sum() / times.square().sum();
  if (stationarity == Stationarity::changing && slope > 0) {
    left -= slope * times;
    --degrees_of_freedom;
  }
  const double variance = left.square().sum() / degrees_of_freedom / n;
  return {std::sqrt(variance * neighbour_factor(left)), degrees_of_freedom};
}

/// The least logarithm that remains without one range of rows.
template <class Over>
double least_without_a_range(const Sums& all, Index rows, const Over& over) {
  constexpr Index steps = 5;  // in a range, from one to the next
  const auto length = static_cast<Index>(std::ceil(range_share * double(rows)));
  const Index step = std::max<Index>(1, length / steps);
  double least = log_ratio(all);
  for (Index begin = 0; begin < rows; begin += step) {
    const Index count = std::min(length + step, rows - begin);
    least = std::min(least, log_ratio(all - over(begin, count)));
  }
  return least;
}

}  // namespace

std::optional<PairedComparison> compare_runs(const Matrix& y, const Matrix& incumbent,
                                             const Matrix& candidate,
                                             const std::vector<RowRange>& segments,
                                             double confidence, Stationarity stationarity) {
  assert(y.rows() == incumbent.rows() && y.cols() == incumbent.cols());
  assert(y.rows() == candidate.rows() && y.cols() == candidate.cols());
  const Index rows = y.rows();
  if (rows < least_rows) return std::nullopt;
  const Matrix of_incumbent = (y - incumbent).cwiseAbs2(),
               of_candidate = (y - candidate).cwiseAbs2(), of_y = y.cwiseAbs2();
  const auto over = [&](Index begin, Index count) -> Sums {
    const auto sum = [&](const Matrix& squares) -> Array {
      return squares.middleRows(begin, count).colwise().sum().transpose().array();
    };
    return {sum(of_incumbent), sum(of_candidate), sum(of_y)};
  };
  const Sums all = over(0, rows);
  if (!all.incumbent.allFinite() || !all.candidate.allFinite() || !all.y.allFinite() ||
      !(all.y.minCoeff() > 0))
    return std::nullopt;

  PairedComparison result;
  result.block_rows = block_rows_for(of_incumbent, of_candidate, all, segments);
  result.blocks = rows / result.block_rows;
  const double phi = log_ratio(all);
  Array pseudo(result.blocks);
  const auto blocks = double(result.blocks);
  for (Index b = 0; b < result.blocks; ++b) {
    // The rows that are left over go to the last block.
    const Index begin = b * result.block_rows;
    const Index count = b + 1 < result.blocks ? result.block_rows : rows - begin;
    pseudo(b) = blocks * phi - (blocks - 1) * log_ratio(all - over(begin, count));
  }
  if (!pseudo.allFinite()) return std::nullopt;
  const Deviation chance = deviation(pseudo, stationarity);
  const double quantile = student_quantile(confidence, chance.degrees_of_freedom);
  result.reduction = 1 - std::exp(-phi);
  const double low =
      std::min(phi - quantile * chance.of_mean, least_without_a_range(all, rows, over));
  result.low = 1 - std::exp(-low);
  return result;
}

Vector noise_squares(const Matrix& y, const Matrix& run, const std::vector<RowRange>& segments) {
  Vector squares(y.cols());
  for (Index q = 0; q < y.cols(); ++q) {
    const Vector errors = y.col(q) - run.col(q);
    std::vector<double> fresh;  // errors where a sample is new
    std::vector<RowRange> of_fresh;
    Index pairs = 0, changes = 0;
    for (const RowRange& segment : segments) {
      const auto first = static_cast<Index>(fresh.size());
      for (Index k = segment.begin + 1; k < segment.end; ++k) {
        ++pairs;
        if (y(k, q) == y(k - 1, q)) continue;
        ++changes;
        fresh.push_back(errors(k));
      }
      of_fresh.push_back({first, static_cast<Index>(fresh.size())});
    }
    squares(q) =
        2 * changes < pairs
            ? square_changes(Eigen::Map<const Vector>(fresh.data(), std::ssize(fresh)), of_fresh)
                  .usual(0)
            : square_changes(errors, segments).usual(0);
  }
  return squares / 2;
}

double noise_percent(const Matrix& y, const Matrix& run, const std::vector<RowRange>& segments) {
  return 100 *
         errors_of(noise_squares(y, run, segments), y.cwiseAbs2().colwise().mean().transpose())
             .mean();
}

}  // namespace reident::identification
