#include "identification/statistics/feedback.hpp"

#include <cmath>

#include "identification/numerics/decompositions.hpp"
#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

constexpr double feedback_confidence = 0.999;
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

std::vector<Feedback> feedback_of(const Record& record, RowRange rows, Index past) {
  const Index m = record.u.cols(), p = record.y.cols();
  const std::vector<Segment> segments = segments_within(record, rows);
  Index count = 0;
  for (const Segment& segment : segments) count += std::max<Index>(0, segment.size() - past);
  if (m == 0 || count < 3 * (m + 1) * past) return {};
  const Matrix inputs = past_of(record.u, segments, past, count);
  Matrix now(count, m);
  Index at = 0;
  for (const Segment& segment : segments)
    for (Index t = segment.begin + past; t < segment.end; ++t) now.row(at++) = record.u.row(t);
  const Matrix basis = orthonormal_basis(inputs);
  const Matrix left = now - basis * (basis.transpose() * now);

  std::vector<Feedback> found;
  for (Index q = 0; q < p; ++q) {
    const Matrix outputs = past_of(record.y.col(q), segments, past, count).rightCols(past);
    const Matrix beside = orthonormal_basis(outputs - basis * (basis.transpose() * outputs));
    for (Index i = 0; i < m; ++i) {
      const double all = left.col(i).squaredNorm();
      if (!(all > nothing_left * now.col(i).squaredNorm())) continue;
      const double share = (beside.transpose() * left.col(i)).squaredNorm() / all;
      const double ratio = -double(count) * std::log1p(-std::min(share, 1 - nothing_left));
      if (share >= least_share && ratio > chi_squared_quantile(feedback_confidence, double(past)))
        found.push_back({i, q, share});
    }
  }
  return found;
}

}  // namespace reident::identification
