// Statistics of stretches of samples that add up: what N4SID needs of a window, at a cost that does
// not depend on its length.
//
// For the samples z[t] = [u[t]; y[t]] (w = m + p channels) of a run (consecutive ticks) the lag
// products are F(tau) = sum_t z[t+tau] z[t]', 0 <= tau < L. Those of two adjacent runs add up with
// the products across the seam, which the samples at the ends give; the Hankel matrix's inner
// products follow from F and the same end samples (hankel.hpp). Sums are of z less a reference near
// it, so that an operating point far above the signal costs no digits.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "identification/numerics/matrix.hpp"
#include "identification/samples/record.hpp"

namespace reident::identification {

/// The statistics of one run.
class RunSums {
 public:
  /// `z` is w x N, one column a tick, N >= 1.
  RunSums(const Matrix& z, std::int64_t first_tick, Index block_rows);

  Index count() const { return count_; }
  TickRange ticks() const { return {first_tick_, first_tick_ + count_}; }

  /// Takes in the run whose first tick is this one's end.
  void append(RunSums next);
  /// Moves the sums to another reference (w).
  void refer_to(const Vector& reference);

  const Vector& reference() const { return reference_; }
  const Vector& sum() const { return sum_; }      // of z - reference
  const Matrix& products() const { return F_; }   // L w x w: F(0) on top of F(1) ...
  const Vector& least() const { return least_; }  // of z (w)
  const Vector& greatest() const { return greatest_; }
  const Matrix& first() const { return first_; }  // w x min(N, L - 1): z - reference
  const Matrix& last() const { return last_; }    // the same of the last samples

 private:
  Index block_rows_;
  std::int64_t first_tick_;
  Index count_;
  Vector reference_, sum_, least_, greatest_;
  Matrix F_, first_, last_;
};

/// The statistics of the runs in a stretch of time, ascending and apart from each other.
struct StretchSums {
  std::vector<RunSums> runs;

  /// Takes in a later stretch; a run that continues the last one is joined to it.
  void append(StretchSums later);
  Index rows() const;
  /// Mean and range of every channel (w); at least one run is there.
  Vector mean() const;
  Vector least() const;
  Vector greatest() const;
};

/// Statistics of the record's rows at `ticks`, summed as one stretch.
StretchSums sums_of_rows(const Record& record, TickRange ticks, Index block_rows);

/// Statistics kept between windows. Time is cut into chunks [k c, (k + 1) c) ticks, and pairs of
/// chunks, pairs of pairs and so on are nodes of a binary tree over time. A stretch is the sum of
/// the largest nodes in it, in their order: its bits depend on its samples alone, neither on when
/// they arrived nor on what was kept, and a window that slides by a chunk costs that chunk and a
/// few additions, however long it is.
class LagSums {
 public:
  struct Shape {
    Index channels = 0;     // w
    Index block_rows = 0;   // L
    Index chunk_ticks = 0;  // c
    bool operator==(const Shape&) const = default;
  };
  explicit LagSums(const Shape& shape) : shape_(shape) {}

  const Shape& shape() const { return shape_; }

  /// Sums over the ticks. Samples are read from the record where no kept node stands for them.
  StretchSums over(TickRange ticks, const Record& record) const;

  /// The same; nodes within `ticks` are kept for later windows.
  StretchSums keep_over(TickRange ticks, const Record& record);

  /// Chunks [begin, end) in ticks that have to be read for `ticks`: those not kept, with the
  /// partial ones at both ends. Ascending, adjacent ones joined.
  std::vector<TickRange> missing(TickRange ticks) const;

  /// Forgets every node that overlaps `ticks`, such as where a late sample landed.
  void forget(TickRange ticks);

  std::size_t kept_nodes() const { return nodes_.size(); }

 private:
  /// Node `index` of level l holds the chunks [index 2^l, (index + 1) 2^l).
  struct Node {
    int level;
    std::int64_t index;
    auto operator<=>(const Node&) const = default;
  };
  using Nodes = std::map<Node, StretchSums>;

  TickRange ticks_of(Node node) const;
  /// The largest nodes that make up the chunks within `ticks`, ascending.
  std::vector<Node> nodes_of(TickRange ticks) const;
  StretchSums sum_node(Node node, const Record& record, Nodes* keep) const;
  /// Neither the record nor what is kept has samples in the node: then its parts need no look,
  /// so that cost and memory follow the samples, not the length of the gaps.
  bool is_empty(Node node, const Record& record) const;
  StretchSums sum(TickRange ticks, const Record& record, Nodes* keep) const;
  void add_missing(Node node, std::vector<TickRange>& found) const;

  Shape shape_;
  Nodes nodes_;
};

}  // namespace reident::identification
