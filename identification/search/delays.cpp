#include "identification/search/delays.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <utility>

#include "identification/samples/tick_ranges.hpp"
#include "identification/simulation/hole_bridging.hpp"

namespace reident::identification {
namespace {

constexpr double most_unknown = 1.0 / 8;  // of the rows: to leave out more cuts the rest to pieces

/// A channel at ticks that ascend, with a straight line through holes.
class ThroughHoles {
 public:
  /// `segment` is the first of those that follow each other in an array.
  ThroughHoles(Eigen::Ref<const Vector> values, const Segment* segment)
      : values_(values), segment_(segment) {}

  /// Requires a tick from the first one of the first segment to the last one of the last.
  double at(std::int64_t tick) {
    while (tick >= segment_->end_tick()) ++segment_;
    if (tick >= segment_->first_tick)
      return values_(segment_->begin + (tick - segment_->first_tick));
    const Segment& before = *(segment_ - 1);
    const double first = values_(before.end - 1), last = values_(segment_->begin);
    return first + (last - first) * double(tick - before.end_tick() + 1) /
                       double(segment_->first_tick - before.end_tick() + 1);
  }

 private:
  Eigen::Ref<const Vector> values_;
  const Segment* segment_;
};

}  // namespace

std::vector<Segment> longest_run(const Record& record, RowRange rows) {
  std::vector<Segment> longest, run;
  Index most = 0, size = 0;
  for (const Segment& segment : segments_within(record, rows)) {
    if (!run.empty() && !is_bridged(record, run.back(), segment)) {
      run.clear();
      size = 0;
    }
    run.push_back(segment);
    size += segment.size();
    if (size < most) continue;
    most = size;
    longest = run;
  }
  return longest;
}

Record last_ticks(const Record& record, const std::vector<Segment>& run, Index most) {
  const std::int64_t begin = std::max(run.front().first_tick, run.back().end_tick() - most);
  const Index ticks = run.back().end_tick() - begin;
  const auto columns = [&](const Matrix& channels) {
    Matrix result(ticks, channels.cols());
    for (Index c = 0; c < channels.cols(); ++c) {
      ThroughHoles channel(channels.col(c), run.data());
      for (Index k = 0; k < ticks; ++k) result(k, c) = channel.at(begin + k);
    }
    return result;
  };
  return contiguous_record(record.period_s, columns(record.u), columns(record.y));
}

Record delayed(const Record& record, RowRange rows, const std::vector<int>& delays, int left_out) {
  assert(static_cast<Index>(delays.size()) == record.u.cols());
  const std::vector<Segment> parts = segments_within(record, rows);
  Record result{record.period_s,
                Matrix(rows.size(), record.u.cols()),
                Matrix(rows.size(), record.y.cols()),
                {}};
  Index total = 0;
  std::int64_t begin = 0;  // of the run of segments
  std::vector<ThroughHoles> inputs;
  for (std::size_t s = 0; s < parts.size(); ++s) {
    const Segment& part = parts[s];
    if (s == 0 || !is_bridged(record, parts[s - 1], part)) {
      begin = part.first_tick;
      inputs.clear();
      for (Index i = 0; i < record.u.cols(); ++i) inputs.emplace_back(record.u.col(i), &part);
    }
    const Index missing = static_cast<Index>(
        std::clamp<std::int64_t>(begin + left_out - part.first_tick, 0, part.size()));
    const Index count = part.size() - missing, from = part.begin + missing;
    if (count == 0) continue;
    const std::int64_t first_tick = part.first_tick + missing;
    for (Index i = 0; i < record.u.cols(); ++i)
      for (Index k = 0; k < count; ++k)
        result.u(total + k, i) = inputs[static_cast<std::size_t>(i)].at(
            first_tick + k - delays[static_cast<std::size_t>(i)]);
    result.y.middleRows(total, count) = record.y.middleRows(from, count);
    result.segments.push_back({total, total + count, first_tick});
    total += count;
  }
  result.u.conservativeResize(total, Eigen::NoChange);
  result.y.conservativeResize(total, Eigen::NoChange);
  return result;
}

Record delayed_to_identify(const Record& record, RowRange rows, const std::vector<int>& delays) {
  const std::vector<Segment> parts = segments_within(record, rows);
  std::vector<TickRange> unknown;
  for (std::size_t s = 1; s < parts.size(); ++s)
    for (const int delay : delays)
      unknown.push_back({parts[s - 1].end_tick() + delay, parts[s].first_tick + delay});
  Record all = delayed(record, rows, delays, *std::max_element(delays.begin(), delays.end()));
  Record known = without(all, united(std::move(unknown)));
  return double(known.rows()) >= (1 - most_unknown) * double(all.rows()) ? known : all;
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
