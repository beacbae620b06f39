#include "service/client/step_kernel.hpp"

#include "identification/cpu_clones.hpp"

namespace reident {
namespace {

using identification::Four;
using identification::load;
using identification::store;

constexpr std::size_t block = 8;  // rows whose sums stay in registers

REIDENT_CLONES
void product(const double* packed, std::size_t stride, std::size_t columns, const double* z,
             double* out) {
  for (std::size_t row = 0; row < stride; row += block) {
    // Two sums, of the even and of the odd columns: an addition need not wait for the one before.
    Four even[2] = {}, odd[2] = {};
    const double* column = packed + row;
    std::size_t c = 0;
    for (; c + 1 < columns; c += 2, column += 2 * stride) {
      even[0] += load(column) * z[c];
      even[1] += load(column + 4) * z[c];
      odd[0] += load(column + stride) * z[c + 1];
      odd[1] += load(column + stride + 4) * z[c + 1];
    }
    if (c < columns) {
      even[0] += load(column) * z[c];
      even[1] += load(column + 4) * z[c];
    }
    store(out + row, even[0] + odd[0]);
    store(out + row + 4, even[1] + odd[1]);
  }
}

}  // namespace

StepKernel::StepKernel(const identification::StateSpaceModel& model)
    : product_(&product),
      columns_(static_cast<std::size_t>(model.order() + model.inputs())),
      stride_((static_cast<std::size_t>(model.order() + model.outputs()) + block - 1) / block *
              block),
      packed_(stride_ * columns_) {
  const identification::Index n = model.order(), m = model.inputs(), p = model.outputs();
  Eigen::Map<identification::Matrix> packed(packed_.data(),
                                            static_cast<identification::Index>(stride_), n + m);
  packed.topLeftCorner(n, n) = model.A;
  packed.block(0, n, n, m) = model.B;
  packed.block(n, 0, p, n) = model.C;
  packed.block(n, n, p, m) = model.D;
}

}  // namespace reident
