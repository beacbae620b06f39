#include "service/client/step_kernel.hpp"

#include "identification/numerics/cpu_clones.hpp"

namespace reident {
namespace {

using identification::Four;
using identification::load;
using identification::store;

constexpr std::size_t block = 8;  // rows whose sums stay in registers

// Two sums, of the even and of the odd columns: an addition need not wait for the one before.
struct Sums {
  Four even[2] = {}, odd[2] = {};

  /// Adds `count` columns times z; returns the column behind them.
  REIDENT_INLINE const double* add(const double* column, std::size_t stride, const double* z,
                                   std::size_t count) {
    std::size_t c = 0;
    for (; c + 1 < count; c += 2, column += 2 * stride) {
      even[0] += load(column) * z[c];
      even[1] += load(column + 4) * z[c];
      odd[0] += load(column + stride) * z[c + 1];
      odd[1] += load(column + stride + 4) * z[c + 1];
    }
    if (c == count) return column;
    even[0] += load(column) * z[c];
    even[1] += load(column + 4) * z[c];
    return column + stride;
  }
};

}  // namespace

REIDENT_CLONES
void StepKernel::product(const StepKernel& kernel, const double* x, const double* du, double* out) {
  const std::size_t stride = kernel.stride_;
  for (std::size_t row = 0; row < stride; row += block) {
    Sums sums;
    // The inputs first: they are there before the state is.
    const double* column = kernel.packed_.data() + row;
    column = sums.add(column, stride, du, kernel.inputs_);
    sums.add(column, stride, x, kernel.order_);
    store(out + row, sums.even[0] + sums.odd[0]);
    store(out + row + 4, sums.even[1] + sums.odd[1]);
  }
}

StepKernel::StepKernel(const identification::StateSpaceModel& model)
    : product_(&product),
      order_(static_cast<std::size_t>(model.order())),
      inputs_(static_cast<std::size_t>(model.inputs())),
      stride_((order_ + static_cast<std::size_t>(model.outputs()) + block - 1) / block * block),
      packed_(stride_ * (order_ + inputs_)) {
  const identification::Index n = model.order(), m = model.inputs(), p = model.outputs();
  Eigen::Map<identification::Matrix> packed(packed_.data(),
                                            static_cast<identification::Index>(stride_), n + m);
  packed.block(0, 0, n, m) = model.B;
  packed.block(n, 0, p, m) = model.D;
  packed.block(0, m, n, n) = model.A;
  packed.block(n, m, p, n) = model.C;
}

}  // namespace reident
