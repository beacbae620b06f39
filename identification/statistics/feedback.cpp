#include "identification/statistics/feedback.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "identification/numerics/decompositions.hpp"
#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

constexpr double false_alarms = 5e-4;  // share of the records without feedback
constexpr Index latest = 3;            // rows that most controllers look back at the most
constexpr double least_share = 0.02;
constexpr double nothing_left = 1e-12;  // of an input's square: below it nothing is left to explain

/// Columns: a one, then z[t-1], z[t-2], ... for each row t with so many rows before it.
Matrix past_of(const Matrix& values, const std::vector<Segment>& segments, Index past,
               Index count) {
  Matrix result(count, 1 + values.cols() * past);
  result.col(0).setOnes();
  Index at = 0;
  for (const Segment& segment : segments)
    for (Index t = segment.begin + past; t < segment.end; ++t, ++at)
      for (Index i = 0; i < past; ++i)
        result.row(at).segment(1 + i * values.cols(), values.cols()) = values.row(t - 1 - i);
  return result;
}

}  // namespace

std::vector<Feedback> feedback_of(const Record& record, RowRange rows, Index past,
                                  const Matrix& of_inputs) {
  const Index m = record.u.cols(), p = record.y.cols();
  assert(of_inputs.rows() == record.rows() && of_inputs.cols() == p);
  const std::vector<Segment> segments = segments_within(record, rows);
  Index count = 0;
  for (const Segment& segment : segments) count += std::max<Index>(0, segment.size() - past);
  if (m == 0 || count < 3 * (m + p + 1) * past) return {};
  Matrix own(record.rows(), m + p);
  own << record.u, of_inputs;
  const Index known = 1 + (m + p) * past, told = p * past;
  Matrix columns(count, known + told + m);
  columns.leftCols(known) = past_of(own, segments, past, count);
  for (Index q = 0; q < p; ++q)
    columns.middleCols(known + q * past, past) =
        past_of(record.y.col(q), segments, past, count).rightCols(past);
  Index at = 0;
  for (const Segment& segment : segments)
    for (Index t = segment.begin + past; t < segment.end; ++t)
      columns.row(at++).tail(m) = record.u.row(t);
  const Matrix triangle = triangular_factor(columns);
  const Matrix left = triangle.bottomRightCorner(told + m, told + m);
  // For the latest rows of an output and for all, by Bartlett's factor, with which the logarithm of
  // few rows is distributed as chi-squared, too.
  const auto is_explained = [&](double share, Index rows_of_past) {
    const double degrees = double(rows_of_past);
    const double factor = double(count - known - 1) - degrees / 2;
    return -factor * std::log1p(-std::min(share, 1 - nothing_left)) >
           chi_squared_quantile(1 - false_alarms / double(2 * m * p), degrees);
  };

  std::vector<Feedback> found;
  for (Index q = 0; q < p; ++q) {
    Matrix beside(told + m, past + m);
    beside << left.middleCols(q * past, past), left.rightCols(m);
    const Matrix inputs = triangular_factor(beside).rightCols(m);
    for (Index i = 0; i < m; ++i) {
      const double all = left.rightCols(m).col(i).squaredNorm();
      if (!(all > nothing_left * triangle.rightCols(m).col(i).squaredNorm())) continue;
      const Vector explained = inputs.col(i).head(past);
      const Index few = std::min(latest, past);
      const double share = explained.squaredNorm() / all;
      if (share >= least_share &&
          (is_explained(explained.head(few).squaredNorm() / all, few) || is_explained(share, past)))
        found.push_back({i, q, share});
    }
  }
  return found;
}

}  // namespace reident::identification
