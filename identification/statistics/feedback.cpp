#include "identification/statistics/feedback.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "identification/numerics/decompositions.hpp"
#include "identification/statistics/correlation.hpp"
#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

constexpr double false_alarms = 5e-4;  // share of the records without feedback
constexpr Index latest = 3;            // rows that most controllers look back at the most
constexpr double least_share = 0.02;
constexpr Index rows_for_each = 3;      // for each number that is known
constexpr Index long_past = 4;          // times the usual one
constexpr Index around_rhythm = 1;      // rows: a period need not be of whole ones
constexpr double nothing_left = 1e-12;  // of an input's square: below it nothing is left to explain

/// What is known before a row: so many rows of the inputs, so many of what a model makes of them,
/// and the rows of each input around the one that lies its rhythm ago. There may be no rhythms.
struct Past {
  Index of_inputs;
  Index rows;
  Index unseen;  // newest rows of the outputs, which are not
  std::vector<Index> rhythms{};

  Index longest() const {
    const Index of_all = std::max(of_inputs, unseen + rows);
    return rhythms.empty() ? of_all
                           : std::max(of_all, *std::max_element(rhythms.begin(), rhythms.end()) +
                                                  around_rhythm);
  }
  /// Numbers known, with m inputs and p outputs.
  Index known(Index m, Index p) const {
    return 1 + m * of_inputs + p * rows + std::ssize(rhythms) * (2 * around_rhythm + 1);
  }
};

/// Calls `use` with the place, from 0, and the number of each row that has its past.
template <typename Use>
Index for_each_row(const std::vector<Segment>& segments, const Past& past, const Use& use) {
  Index at = 0;
  for (const Segment& segment : segments)
    for (Index t = segment.begin + past.longest(); t < segment.end; ++t) use(at++, t);
  return at;
}

/// The lag beyond `past`, up to a third of the longest segment, at which the values are most like
/// themselves; the first one of those that are about as good, as after two periods.
Index rhythm_of(Series values, Index past) {
  constexpr double about_as_good = 0.02;
  std::vector<double> likeness;
  for (Index lag = past + 1; lag <= std::max(values.longest_segment() / 3, past + 1); ++lag) {
    const Index pairs = values.pairs(lag);
    likeness.push_back(
        pairs > 0 ? values.autocorrelation(lag) * double(values.rows()) / double(pairs) : 0);
  }
  const double best = *std::max_element(likeness.begin(), likeness.end());
  const auto first = std::find_if(likeness.begin(), likeness.end(), [&](double one) {
    return one >= best - about_as_good * std::abs(best);
  });
  return past + 1 + (first - likeness.begin());
}

/// What feedback_of() finds beside such a past; absent where the rows are too few.
std::optional<std::vector<Feedback>> feedback_beside(const Record& record,
                                                     const std::vector<Segment>& segments,
                                                     const Past& past, const Matrix& of_inputs) {
  const Index m = record.u.cols(), p = record.y.cols();
  const Index known = past.known(m, p), told = p * past.rows;
  const Index count = for_each_row(segments, past, [](Index, Index) {});
  if (m == 0 || count < rows_for_each * (known + past.rows)) return std::nullopt;
  Matrix columns(count, known + told + m);
  for_each_row(segments, past, [&](Index at, Index t) {
    auto row = columns.row(at);
    row(0) = 1;
    Index column = 1;
    for (Index i = 1; i <= past.of_inputs; ++i, column += m)
      row.segment(column, m) = record.u.row(t - i);
    for (Index i = 1; i <= past.rows; ++i, column += p)
      row.segment(column, p) = of_inputs.row(t - i);
    for (std::size_t j = 0; j < past.rhythms.size(); ++j)
      for (Index i = -around_rhythm; i <= around_rhythm; ++i)
        row(column++) = record.u(t - past.rhythms[j] + i, static_cast<Index>(j));
    for (Index q = 0; q < p; ++q)
      for (Index i = 1; i <= past.rows; ++i) row(column++) = record.y(t - past.unseen - i, q);
    row.tail(m) = record.u.row(t);
  });
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
    Matrix beside(told + m, past.rows + m);
    beside << left.middleCols(q * past.rows, past.rows), left.rightCols(m);
    const Matrix factor = triangular_factor(beside), inputs = factor.rightCols(m);
    for (Index i = 0; i < m; ++i) {
      const double all = left.rightCols(m).col(i).squaredNorm();
      if (!(all > nothing_left * triangle.rightCols(m).col(i).squaredNorm())) continue;
      const Vector explained = inputs.col(i).head(past.rows);
      const Index few = std::min(latest, past.rows);
      const double share = explained.squaredNorm() / all;
      if (share >= least_share && (is_explained(explained.head(few).squaredNorm() / all, few) ||
                                   is_explained(share, past.rows)))
        found.push_back({i, q, share, explained(0) * factor(0, 0) > 0});
    }
  }
  return found;
}

}  // namespace

std::vector<Feedback> feedback_of(const Record& record, RowRange rows, Index past,
                                  const Matrix& of_inputs, Index unseen) {
  assert(of_inputs.rows() == record.rows() && of_inputs.cols() == record.y.cols());
  const std::vector<Segment> segments = segments_within(record, rows);
  auto found = feedback_beside(record, segments, {past, past, unseen}, of_inputs)
                   .value_or(std::vector<Feedback>());
  if (found.empty()) return found;
  Past with_rhythms{past, past, unseen};
  const std::vector<RowRange> ranges = ranges_from(record, rows);
  const Index m = record.u.cols();
  for (Index i = 0; i < m; ++i)
    with_rhythms.rhythms.push_back(rhythm_of(
        Series(record.u.col(i).segment(rows.begin, rows.size()), ranges), past + around_rhythm));
  Past longer = with_rhythms;
  longer.of_inputs = long_past * past;
  const Index count = for_each_row(segments, longer, [](Index, Index) {});
  const Index beside = longer.known(m, record.y.cols()) - m * longer.of_inputs + past;
  longer.of_inputs = std::clamp((count / rows_for_each - beside) / m, past, longer.of_inputs);
  for (const Past& one : {longer, with_rhythms})
    if (auto again = feedback_beside(record, segments, one, of_inputs)) {
      // With so much known, little of an input of few steps is left, and all of that is explained.
      for (Feedback& left : *again)
        for (const Feedback& before : found)
          if (before.input == left.input && before.output == left.output)
            left.share = std::min(left.share, before.share);
      return *again;
    }
  return found;
}

}  // namespace reident::identification
