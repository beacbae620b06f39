#include "identification/subspace/lag_sums.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "identification/numerics/kernels.hpp"

namespace reident::identification {
namespace {

std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

/// F += the lag products of the later samples z (w x N) with the earlier v (w x N'), column t of v
/// meeting the columns t, ..., t + L - 1 of z; columns of z past its end count as zero.
void add_lag_products(const Matrix& z, const Matrix& v, Index block_rows, Matrix& F) {
  const Index width = z.rows();
  Matrix padded = Matrix::Zero(width, v.cols() + block_rows - 1);
  padded.leftCols(z.cols()) = z;
  add_outer_products({padded.data(), block_rows * width, width}, {v.data(), width, width}, v.cols(),
                     Triangle::full, F.data());
}

Matrix side_by_side(const Matrix& left, const Matrix& right) {
  Matrix both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}

}  // namespace

SegmentSums::SegmentSums(const Matrix& z, std::int64_t first_tick, Index block_rows)
    : block_rows_(block_rows),
      first_tick_(first_tick),
      count_(z.cols()),
      reference_(z.rowwise().mean()),
      least_(z.rowwise().minCoeff()),
      greatest_(z.rowwise().maxCoeff()),
      F_(Matrix::Zero(block_rows * z.rows(), z.rows())) {
  assert(count_ >= 1 && block_rows >= 1);
  const Matrix centred = z.colwise() - reference_;
  const Index ends = std::min(count_, block_rows - 1);
  sum_ = centred.rowwise().sum();
  first_ = centred.leftCols(ends);
  last_ = centred.rightCols(ends);
  add_lag_products(centred, centred, block_rows, F_);
}

void SegmentSums::refer_to(const Vector& reference) {
  const Vector d = reference_ - reference;
  const Index width = d.size();
  // With N(tau) pairs at lag tau: (z[t+tau] + d)(z[t] + d)' summed over them.
  Vector early = sum_, late = sum_;  // of z[t] and of z[t+tau] over the pairs
  for (Index tau = 0; tau < std::min(block_rows_, count_); ++tau) {
    if (tau > 0) {
      early -= last_.col(last_.cols() - tau);
      late -= first_.col(tau - 1);
    }
    auto F = F_.middleRows(tau * width, width);
    F += late * d.transpose() + d * early.transpose();
    F += double(count_ - tau) * d * d.transpose();
  }
  sum_ += double(count_) * d;
  first_.colwise() += d;
  last_.colwise() += d;
  reference_ = reference;
}

void SegmentSums::append(SegmentSums next) {
  assert(next.first_tick_ == ticks().end && next.block_rows_ == block_rows_);
  next.refer_to(reference_);
  F_ += next.F_;
  // Across the seam: the samples before it meet those behind it, never their own kind.
  const Index before = last_.cols();
  Matrix behind = Matrix::Zero(reference_.size(), before + next.first_.cols());
  behind.rightCols(next.first_.cols()) = next.first_;
  add_lag_products(behind, last_, block_rows_, F_);
  const Index ends = block_rows_ - 1;
  if (first_.cols() < ends)
    first_ = side_by_side(first_,
                          next.first_.leftCols(std::min(ends - first_.cols(), next.first_.cols())));
  if (next.last_.cols() < ends)
    last_ =
        side_by_side(last_.rightCols(std::min(ends - next.last_.cols(), last_.cols())), next.last_);
  else
    last_ = std::move(next.last_);
  sum_ += next.sum_;
  least_ = least_.cwiseMin(next.least_);
  greatest_ = greatest_.cwiseMax(next.greatest_);
  count_ += next.count_;
}

void RangeSums::append(RangeSums later) {
  for (SegmentSums& segment : later.segments) {
    assert(segments.empty() || segment.ticks().begin >= segments.back().ticks().end);
    if (!segments.empty() && segments.back().ticks().end == segment.ticks().begin)
      segments.back().append(std::move(segment));
    else
      segments.push_back(std::move(segment));
  }
}

Index RangeSums::rows() const {
  Index rows = 0;
  for (const SegmentSums& segment : segments) rows += segment.count();
  return rows;
}

Vector RangeSums::mean() const {
  const Vector& reference = segments.front().reference();
  Vector sum = Vector::Zero(reference.size());
  for (const SegmentSums& segment : segments)
    sum += segment.sum() + double(segment.count()) * (segment.reference() - reference);
  return reference + sum / double(rows());
}

Vector RangeSums::least() const {
  Vector least = segments.front().least();
  for (const SegmentSums& segment : segments) least = least.cwiseMin(segment.least());
  return least;
}

Vector RangeSums::greatest() const {
  Vector greatest = segments.front().greatest();
  for (const SegmentSums& segment : segments) greatest = greatest.cwiseMax(segment.greatest());
  return greatest;
}

RangeSums sums_of_rows(const Record& record, TickRange ticks, Index block_rows) {
  RangeSums sums;
  const Index m = record.u.cols(), p = record.y.cols();
  const RowRange rows{first_row_at(record, ticks.begin), first_row_at(record, ticks.end)};
  for (const Segment& part : segments_within(record, rows)) {
    Matrix z(m + p, part.size());
    z.topRows(m) = record.u.middleRows(part.begin, part.size()).transpose();
    z.bottomRows(p) = record.y.middleRows(part.begin, part.size()).transpose();
    sums.segments.emplace_back(z, part.first_tick, block_rows);
  }
  return sums;
}

TickRange LagSums::ticks_of(Node node) const {
  const std::int64_t size = shape_.chunk_ticks << node.level;
  return {node.index * size, (node.index + 1) * size};
}

std::vector<LagSums::Node> LagSums::nodes_of(TickRange ticks) const {
  std::int64_t chunk = -floor_divide(-ticks.begin, shape_.chunk_ticks);
  const std::int64_t end = floor_divide(ticks.end, shape_.chunk_ticks);
  std::vector<Node> nodes;
  while (chunk < end) {
    int level = 0;
    while (chunk % (std::int64_t{2} << level) == 0 && chunk + (std::int64_t{2} << level) <= end)
      ++level;
    nodes.push_back({level, chunk >> level});
    chunk += std::int64_t{1} << level;
  }
  return nodes;
}

RangeSums LagSums::sum_node(Node node, const Record& record, Nodes* keep) const {
  if (const auto kept = nodes_.find(node); kept != nodes_.end()) return kept->second;
  RangeSums sums;
  if (node.level == 0) {
    sums = sums_of_rows(record, ticks_of(node), shape_.block_rows);
  } else if (!is_empty(node, record)) {
    sums = sum_node({node.level - 1, 2 * node.index}, record, keep);
    sums.append(sum_node({node.level - 1, 2 * node.index + 1}, record, keep));
  }
  if (keep) keep->emplace(node, sums);
  return sums;
}

bool LagSums::is_empty(Node node, const Record& record) const {
  const TickRange ticks = ticks_of(node);
  if (first_row_at(record, ticks.begin) < first_row_at(record, ticks.end)) return false;
  // Every kept node that holds samples has its chunks kept as well.
  const auto chunk = nodes_.lower_bound({0, node.index << node.level});
  return chunk == nodes_.end() || chunk->first >= Node{0, (node.index + 1) << node.level};
}

RangeSums LagSums::sum(TickRange ticks, const Record& record, Nodes* keep) const {
  const std::vector<Node> nodes = nodes_of(ticks);
  if (nodes.empty()) return sums_of_rows(record, ticks, shape_.block_rows);
  const TickRange whole{ticks_of(nodes.front()).begin, ticks_of(nodes.back()).end};
  RangeSums sums = sums_of_rows(record, {ticks.begin, whole.begin}, shape_.block_rows);
  for (const Node& node : nodes) sums.append(sum_node(node, record, keep));
  sums.append(sums_of_rows(record, {whole.end, ticks.end}, shape_.block_rows));
  return sums;
}

RangeSums LagSums::over(TickRange ticks, const Record& record) const {
  return sum(ticks, record, nullptr);
}

RangeSums LagSums::keep_over(TickRange ticks, const Record& record) {
  return sum(ticks, record, &nodes_);
}

void LagSums::add_missing(Node node, std::vector<TickRange>& found) const {
  if (nodes_.contains(node)) return;
  if (node.level == 0) {
    const TickRange ticks = ticks_of(node);
    if (!found.empty() && found.back().end == ticks.begin)
      found.back().end = ticks.end;
    else
      found.push_back(ticks);
    return;
  }
  add_missing({node.level - 1, 2 * node.index}, found);
  add_missing({node.level - 1, 2 * node.index + 1}, found);
}

std::vector<TickRange> LagSums::missing(TickRange ticks) const {
  const std::vector<Node> nodes = nodes_of(ticks);
  if (nodes.empty()) return {ticks};
  std::vector<TickRange> found;
  const TickRange whole{ticks_of(nodes.front()).begin, ticks_of(nodes.back()).end};
  if (ticks.begin < whole.begin) found.push_back({ticks.begin, whole.begin});
  for (const Node& node : nodes) add_missing(node, found);
  if (whole.end < ticks.end) {
    if (!found.empty() && found.back().end == whole.end)
      found.back().end = ticks.end;
    else
      found.push_back({whole.end, ticks.end});
  }
  return found;
}

void LagSums::forget(TickRange ticks) {
  std::erase_if(nodes_, [&](const auto& kept) {
    const TickRange own = ticks_of(kept.first);
    return own.begin < ticks.end && ticks.begin < own.end;
  });
}

}  // namespace reident::identification
