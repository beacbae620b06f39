#include "service/client/step_kernel.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // Four never crosses a call: all is inlined
#endif
// Clones need the loader's indirect functions, which sanitizers and clang 14 do not go with.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define REIDENT_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define REIDENT_CLONES
#endif

namespace reident {
namespace {

// Inlined, so that each clone has its own.
#define REIDENT_INLINE inline __attribute__((always_inline))

/// Four doubles that the compiler keeps in one register where the machine has one for them, and in
/// two where it has not.
typedef double Four __attribute__((vector_size(32)));
constexpr std::size_t block = 8;  // rows whose sums stay in registers

REIDENT_INLINE Four load(const double* from) {
  Four value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}

REIDENT_INLINE void store(double* to, Four value) {
  __builtin_memcpy(to, &value, sizeof value);
}

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
