// One tick of a state-space model as one product of packed matrices.
#pragma once

#include <vector>

#include "identification/simulation/state_space.hpp"

namespace reident {

/// [x[k+1]; y - y0] = [A B; C D] [x[k]; du]. Sums the columns in a fixed order, so that every
/// machine gives the same bits. It copies the matrices; any number of threads may run one.
class StepKernel {
 public:
  /// Requires a well-formed model.
  explicit StepKernel(const identification::StateSpaceModel& model);

  /// x: n values, du: m. out: n + p values, and room for out_room() in all, which overlaps neither:
  /// values behind n + p are written too. Allocates nothing.
  void run(const double* x, const double* du, double* out) const { product_(*this, x, du, out); }
  std::size_t out_room() const { return stride_; }

 private:
  static void product(const StepKernel& kernel, const double* x, const double* du, double* out);

  decltype(&product) product_;  // the machine's own
  std::size_t order_, inputs_;
  std::size_t stride_;          // n + p, rounded up
  std::vector<double> packed_;  // column by column
};

}  // namespace reident
