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
  const auto whiten = [&](Index begin, Index columns, Index known) {
    const auto k = static_cast<std::size_t>(known);
    auto part = result.middleCols(begin, columns);
    for (Index i = 0; i < known; ++i)
      part -= past.coefficients[k](i) * all.middleCols(before + begin - 1 - i, columns);
    part *= past.deviation.back() / (past.deviation[k] * colour_.deviation);
  };
  const Index first = std::clamp<Index>(past.order() - before, 0, count);
  for (Index t = 0; t < first; ++t) whiten(t, 1, before + t);
  if (first < count) whiten(first, count - first, past.order());
  latest_ = all.rightCols(std::min(past.order(), all.cols()));
  return result;
}

}  // namespace reident::identification
