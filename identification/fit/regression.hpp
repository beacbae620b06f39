// The regression of the measured output on everything that the simulated output is linear in
// (METHOD.md, sections 6 and 9). Private to this folder. Records are of normalised
// channels; sizes agree with the Columns. Nothing here throws but what a caller's function throws.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Columns of the regression, in their order:
///   x0 (n) | B by columns (n m) | L (n p) | for each output q: D_q (m), y0_q (1), dC_q (n) |
///   target
/// D is there with `direct`. L and dC move the dynamics to A + L C and C + dC: they are there with
/// `moves`, dC with more than one output only, since L reaches every spectrum of a single output.
struct Columns {
  Index n = 0, m = 0, p = 0;
  bool direct = true;
  bool moves = false;

  // First column of each part; of the parts of an output, of the output q.
  Index input_gain() const { return n; }                   // B
  Index dynamics() const { return input_gain() + n * m; }  // L
  Index output(Index q) const { return dynamics() + (moves ? n * p : 0) + q * per_output(); }
  Index offset(Index q) const { return output(q) + direct_inputs(); }
  Index output_map(Index q) const { return offset(q) + 1; }  // dC_q
  Index target() const { return output(p); }
  // Sizes of parts.
  Index direct_inputs() const { return direct ? m : 0; }
  Index per_output() const { return direct_inputs() + 1 + (moves && p > 1 ? n : 0); }
  Index count() const { return target() + 1; }
};

/// A tile of the rows that belong to one output. Column t of `values` holds, for one time, the
/// columns before output(0), those of the output, and the target. All others are zero.
struct RegressionRows {
  Index output;
  Eigen::Ref<const Matrix> values;
};

/// Walks the regression over a segment of the record in tiles, so that memory does not follow
/// its length, and hands each to `visit`, output by output. With `columns.moves`, B, D and y0 of
/// the model and the segment's initial state `x0` (n) give the trajectory about which the dynamics
/// move. Without, `x0` is not read.
void walk_regression(const Columns& columns, const StateSpaceModel& model, const Record& record,
                     const Segment& segment, const Vector& x0,
                     const std::function<void(const RegressionRows&)>& visit);

/// B, D, y0 and the dynamics' moves (all columns between x0 and the target), and the initial
/// states.
struct RegressionSolution {
  Vector theta;               // indexed by Columns; the first n entries are zero
  std::vector<Vector> x0;     // one for each segment
  double sum_of_squares = 0;  // of what is left of the target
};

/// Least squares by the normal equations: fast, at the price of squaring the condition. The initial
/// state of each segment is eliminated as the segment ends. Solutions are of the segments that
/// have ended.
class NormalEquations {
 public:
  explicit NormalEquations(const Columns& columns);
  /// Takes rows of the open segment in.
  void add(const RegressionRows& rows);
  /// Ends the open segment. The next rows begin another one.
  void end_segment();

  /// Solves with the moves of the dynamics weighted down by `damping` times their own sums of
  /// squares. Absent when too few digits are left: when the square of `least_pivot` is more than
  /// the share that a column has for its own, those before it known, or `least_rcond` more than the
  /// reciprocal condition number of the columns' sums, each scaled to 1.
  std::optional<RegressionSolution> solve(double damping, double least_pivot,
                                          double least_rcond = 0) const;

  /// Solves without the combinations of columns, each scaled to size 1, that are smaller than
  /// `least_size`; of least norm in this scale. Absent where these would show: where a thousandth
  /// of the target or less is left, or they lower its sum of squares by a hundredth.
  std::optional<RegressionSolution> solve_without_small(double least_size) const;

  /// Solves with the share s / (s + half_at) of the coefficient of each principal component of the
  /// columns, scaled to size 1. s is what the component explains of the target's sum of squares.
  /// Components smaller than `least_size` are left out. Absent where they are not found.
  std::optional<RegressionSolution> solve_shrunk(double half_at, double least_size) const;

  /// Returns, for each column of `combinations` of the unknowns after x0, the B, D, y0 and x0 of
  /// the response that the estimate of the combination weighs the errors of the rows with.
  /// Combinations that the rows do not determine get a weight that is large and finite. Absent
  /// where principal components are not found.
  std::optional<std::vector<RegressionSolution>> influences(const Matrix& combinations) const;

 private:
  /// What eliminated the initial state of a closed segment.
  struct Elimination {
    Matrix inverse;  // of the initial state's own sums
    Matrix coupling;
  };
  /// The columns in the directions of their principal components.
  struct Components {
    Vector scale;    // of the columns, to size 1
    Matrix columns;  // a column for each component
    Vector squares;  // of their sizes
    Vector target;   // its products with them
  };
  /// Absent where the iteration for them does not converge.
  std::optional<Components> components() const;
  /// The solution with `found` for the columns after x0, and what the initial states are then.
  RegressionSolution solution_of(const Vector& found) const;

  Columns columns_;
  std::vector<Matrix> of_output_;  // sums of the open segment, one for each output
  Matrix sums_;                    // of the closed segments, over the columns after x0
  std::vector<Elimination> segments_;
};

/// Least squares by orthogonal factors, to full accuracy; solutions are of least norm where the
/// rows do not determine them. Used like NormalEquations.
class OrthogonalFactor {
 public:
  explicit OrthogonalFactor(const Columns& columns);
  /// Folds rows in batches: fewer at once cost more, more leave the cache.
  void add(const RegressionRows& rows);
  void end_segment();
  /// Solves for the segments that have ended; there is always a solution.
  RegressionSolution solve() const;
  /// Solves likewise where the target's errors have this `variance`. A principal component of the
  /// columns, scaled to size 1, whose coefficient is beyond four deviations has that of least
  /// squares. That of another is the likeliest one where the columns are as likely as not to move
  /// the target, by equal parts, as far as it goes: what the rows do not show is near zero.
  RegressionSolution solve_with_prior(double variance) const;

 private:
  /// The solution with `found` for the columns after x0, and what the initial states are then.
  RegressionSolution solution_of(const Vector& found) const;
  /// Takes the waiting rows into the factor of the open segment.
  void fold();

  Columns columns_;
  Matrix waiting_;  // rows of the open segment that are not folded in
  Index waiting_rows_ = 0;
  Matrix open_;    // triangular factor of the open segment
  Matrix factor_;  // triangular factor of the closed segments, over the columns after x0
  std::vector<Matrix> segments_;  // rows of each segment that determine its initial state
};

}  // namespace reident::identification
