#include "identification/search/parsimony.hpp"

#include <cassert>
#include <cmath>

#include "identification/simulation/free_run.hpp"
#include "identification/statistics/correlation.hpp"
#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

constexpr double least_deviation = 1e-6;  // of an output's: below it errors are rounding

Matrix errors_of(const Response& fit, const Record& record, RowRange rows) {
  return record.y.middleRows(rows.begin, rows.size()) - free_run(fit.model, record, rows, fit.x0);
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
    ratio += count / correlated_rows(errors) *
             std::log((left_by_simple.col(q).squaredNorm() + floor) /
                      (left_by_rich.col(q).squaredNorm() + floor));
  }
  return !(ratio <= chi_squared_quantile(0.9999, double(extra)));
}

double loss_by_chance(Index extra, Index fitted, Index held_out) {
  return 4 * std::sqrt(double(extra) / (double(fitted) * double(held_out)));
}

}  // namespace reident::identification
