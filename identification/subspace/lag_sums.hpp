// Statistics of ranges of samples that add up: what N4SID needs of a window, at a cost that does
// not depend on its length (METHOD.md, section 2).
//
// z[t] = [u[t]; y[t]] are the samples of a segment (consecutive ticks), w = m + p channels in their
// units. The lag products are F(tau) = sum_t z[t+tau] z[t]', 0 <= tau < L. Those of two adjacent
// segments add up with the products across the seam, which the samples at the ends give. Sums are
// of z less a reference near it, so that an operating point far above the signal costs no digits.
//
// L, the block rows, is 2 s for the horizon s and is the same in all sums that meet. Nothing here
// throws.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "identification/numerics/matrix.hpp"
#include "identification/samples/record.hpp"

namespace reident::identification {

/// The statistics of one segment.
class SegmentSums {
 public:
  /// Sums the samples `z` (w x N, one column a tick) from `first_tick` on. The reference is their
  /// mean. Requires N >= 1 and block_rows >= 1.
  SegmentSums(const Matrix& z, std::int64_t first_tick, Index block_rows);

  Index count() const { return count_; }
  TickRange ticks() const { return {first_tick_, first_tick_ + count_}; }

  /// Takes in a later segment, whatever its reference. Requires its first tick to be this one's
  /// end.
  void append(SegmentSums next);
  /// Moves the sums to another reference (w), exact to rounding.
  void refer_to(const Vector& reference);

  /// Return the sums: of z less the reference but for the least and greatest values.
  const Vector& reference() const { return reference_; }
  const Vector& sum() const { return sum_; }      // w
  const Matrix& products() const { return F_; }   // L w x w: F(0) on top of F(1) ...
  const Vector& least() const { return least_; }  // of z (w)
  const Vector& greatest() const { return greatest_; }
  const Matrix& first() const { return first_; }  // w x min(N, L - 1)
  const Matrix& last() const { return last_; }    // w x min(N, L - 1)

 private:
  Index block_rows_;
  std::int64_t first_tick_;
  Index count_;
  Vector reference_, sum_, least_, greatest_;
  Matrix F_, first_, last_;
};

/// The statistics of the segments in a range of time, ascending and apart from each other.
struct RangeSums {
  std::vector<SegmentSums> segments;

  /// Takes in a range that begins where this one ends, or later; a segment that continues the last
  /// one is joined to it.
  void append(RangeSums later);
  /// Returns the number of samples of all segments.
  Index rows() const;
  /// Return the mean and the range of every channel (w). Require at least one segment.
  Vector mean() const;
  Vector least() const;
  Vector greatest() const;
};

/// Returns the statistics of the record's rows at `ticks`, summed as one range.
RangeSums sums_of_rows(const Record& record, TickRange ticks, Index block_rows);

/// Statistics kept between windows. Time is cut into chunks [k c, (k + 1) c) ticks; pairs of
/// chunks, pairs of pairs and so on are nodes of a binary tree over time. A range is the sum of
/// the largest nodes in it, in their order. So its bits depend on its samples alone, neither on
/// when they arrived nor on what was kept. A window that slides by a chunk costs that chunk and a
/// few additions, however long it is. Memory grows with what is kept: L w^2 numbers a segment.
class LagSums {
 public:
  struct Shape {
    Index channels = 0;     // w
    Index block_rows = 0;   // L
    Index chunk_ticks = 0;  // c
    bool operator==(const Shape&) const = default;
  };
  /// Keeps nothing yet. Requires positive sizes.
  explicit LagSums(const Shape& shape) : shape_(shape) {}

  const Shape& shape() const { return shape_; }

  /// Returns the sums over the ticks. Samples are read from the record, which has w channels, where
  /// no kept node stands for them.
  RangeSums over(TickRange ticks, const Record& record) const;

  /// Returns what over() does and keeps the nodes within `ticks` for later windows.
  RangeSums keep_over(TickRange ticks, const Record& record);

  /// Returns the ticks that have to be read for `ticks`: chunks not kept, and the partial ones at
  /// both ends. Ascending, adjacent ones joined.
  std::vector<TickRange> missing(TickRange ticks) const;

  /// Forgets every node that overlaps `ticks`, as where a late sample came.
  void forget(TickRange ticks);

  std::size_t kept_nodes() const { return nodes_.size(); }

 private:
  /// Node `index` of level l holds the chunks [index 2^l, (index + 1) 2^l).
  struct Node {
    int level;
    std::int64_t index;
    auto operator<=>(const Node&) const = default;
  };
  using Nodes = std::map<Node, RangeSums>;

  TickRange ticks_of(Node node) const;
  /// The largest nodes that make up the chunks within `ticks`, ascending.
  std::vector<Node> nodes_of(TickRange ticks) const;
  RangeSums sum_node(Node node, const Record& record, Nodes* keep) const;
  /// Neither the record nor what is kept has samples in the node: then its parts need no look,
  /// so that cost and memory follow the samples, not the length of the gaps.
  bool is_empty(Node node, const Record& record) const;
  RangeSums sum(TickRange ticks, const Record& record, Nodes* keep) const;
  void add_missing(Node node, std::vector<TickRange>& found) const;

  Shape shape_;
  Nodes nodes_;
};

}  // namespace reident::identification
