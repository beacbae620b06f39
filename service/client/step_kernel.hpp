// One tick of a state-space model as one product of packed matrices.
#pragma once

#include <vector>

#include "identification/state_space.hpp"

namespace reident {

/// [x[k+1]; y - y0] = [A B; C D] [x[k]; du]. Sums the columns in a fixed order, so that every
/// machine gives the same bits.
class StepKernel {
 public:
  explicit StepKernel(const identification::StateSpaceModel& model);

  /// z: n + m values. out: n + p values, and room for out_room() in all; does not overlap z.
  void run(const double* z, double* out) const {
    product_(packed_.data(), stride_, columns_, z, out);
  }
  std::size_t out_room() const { return stride_; }

 private:
  using Product = void (*)(const double* packed, std::size_t stride, std::size_t columns,
                           const double* z, double* out);

  Product product_;  // the machine's own
  std::size_t columns_;
  std::size_t stride_;          // n + p, rounded up
  std::vector<double> packed_;  // column by column
};

}  // namespace reident
