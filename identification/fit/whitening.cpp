#include "identification/fit/whitening.hpp"

#include <algorithm>

namespace reident::identification {

void Whitener::begin_segment() {
  latest_.resize(latest_.rows(), 0);
}

Matrix Whitener::white(const Eigen::Ref<const Matrix>& values) {
  const Autoregression& past = colour_.past;
  const Index count = values.cols(), before = latest_.cols();
  Matrix all(values.rows(), before + count);
  if (before > 0) all.leftCols(before) = latest_;
  all.rightCols(count) = values;
  Matrix result = values;
  for (Index t = 0; t < count; ++t) {
    const Index known = std::min(past.order(), before + t);
    const auto k = static_cast<std::size_t>(known);
    for (Index i = 0; i < known; ++i)
      result.col(t) -= past.coefficients[k](i) * all.col(before + t - 1 - i);
    result.col(t) *= past.deviation.back() / (past.deviation[k] * colour_.deviation);
  }
  latest_ = all.rightCols(std::min(past.order(), all.cols()));
  return result;
}

}  // namespace reident::identification
