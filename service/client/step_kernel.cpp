#include "service/client/step_kernel.hpp"

#include <cstring>

// Clones need the loader's indirect functions, which sanitizers and clang 14 do not go with.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define REIDENT_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define REIDENT_CLONES
#endif

namespace reident {
namespace {

constexpr std::size_t block = 8;  // rows whose sums stay in registers

REIDENT_CLONES
void product(const double* packed, std::size_t stride, std::size_t columns, const double* z,
             double* out) {
  for (std::size_t row = 0; row < stride; row += block) {
    double sum[block] = {};
    const double* column = packed + row;
    for (std::size_t c = 0; c < columns; ++c, column += stride)
      for (std::size_t r = 0; r < block; ++r) sum[r] += column[r] * z[c];
    std::memcpy(out + row, sum, sizeof sum);
  }
}

}  // namespace

StepKernel::StepKernel(const identification::StateSpaceModel& model)
    : columns_(static_cast<std::size_t>(model.order() + model.inputs())),
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

void StepKernel::run(const double* z, double* out) const {
  product(packed_.data(), stride_, columns_, z, out);
}

}  // namespace reident
