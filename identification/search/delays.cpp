#include "identification/search/delays.hpp"

#include <cassert>
#include <numeric>

namespace reident::identification {

Record delayed(const Record& record, RowRange rows, const std::vector<int>& delays, int left_out) {
  assert(static_cast<Index>(delays.size()) == record.u.cols());
  Record result{record.period_s, {}, {}, {}};
  Index total = 0;
  const std::vector<Segment> parts = segments_within(record, rows);
  for (const Segment& part : parts)
    if (part.size() > left_out) total += part.size() - left_out;
  result.u.resize(total, record.u.cols());
  result.y.resize(total, record.y.cols());
  Index at = 0;
  for (const Segment& part : parts) {
    const Index count = part.size() - left_out, begin = part.begin + left_out;
    if (count <= 0) continue;
    for (Index i = 0; i < record.u.cols(); ++i)
      result.u.col(i).segment(at, count) =
          record.u.col(i).segment(begin - delays[static_cast<std::size_t>(i)], count);
    result.y.middleRows(at, count) = record.y.middleRows(begin, count);
    result.segments.push_back({at, at + count, part.first_tick + left_out});
    at += count;
  }
  return result;
}

StateSpaceModel with_delay_states(const StateSpaceModel& model, const std::vector<int>& delays) {
  const Index n = model.order(), m = model.inputs(), p = model.outputs();
  const Index size = n + std::accumulate(delays.begin(), delays.end(), 0);
  StateSpaceModel result = model;
  result.A = Matrix::Zero(size, size);
  result.A.topLeftCorner(n, n) = model.A;
  result.B = Matrix::Zero(size, m);
  result.C = Matrix::Zero(p, size);
  result.C.leftCols(n) = model.C;
  result.D = Matrix::Zero(p, m);
  if (model.K.size() != 0) {
    result.K = Matrix::Zero(size, p);
    result.K.topRows(n) = model.K;
  }
  Index newest = n;  // state that holds the input of the sample before
  for (Index i = 0; i < m; ++i) {
    const Index delay = delays[static_cast<std::size_t>(i)];
    if (delay == 0) {
      result.B.col(i).head(n) = model.B.col(i);
      result.D.col(i) = model.D.col(i);
      continue;
    }
    const Index oldest = newest + delay - 1;
    result.B(newest, i) = 1;
    for (Index k = newest; k < oldest; ++k) result.A(k + 1, k) = 1;
    result.A.col(oldest).head(n) = model.B.col(i);
    result.C.col(oldest) = model.D.col(i);
    newest += delay;
  }
  return result;
}

StateSpaceModel without_delay_states(const StateSpaceModel& model, const std::vector<int>& delays) {
  const Index n = model.order() - std::accumulate(delays.begin(), delays.end(), 0);
  StateSpaceModel result = model;
  result.A = model.A.topLeftCorner(n, n);
  result.B = model.B.topRows(n);
  result.C = model.C.leftCols(n);
  if (model.K.size() != 0) result.K = model.K.topRows(n);
  Index oldest = n - 1;
  for (std::size_t i = 0; i < delays.size(); ++i) {
    if (delays[i] == 0) continue;
    oldest += delays[i];
    const auto input = static_cast<Index>(i);
    result.B.col(input) = model.A.col(oldest).head(n);
    result.D.col(input) = model.C.col(oldest);
  }
  return result;
}

}  // namespace reident::identification
