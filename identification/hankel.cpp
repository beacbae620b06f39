#include "identification/hankel.hpp"

#include <algorithm>

namespace reident::identification {

Index hankel_columns(const std::vector<Segment>& segments, Index block_rows) {
  Index columns = 0;
  for (const Segment& segment : segments)
    columns += std::max<Index>(0, segment.size() - block_rows + 1);
  return columns;
}

HankelFactor compress(const Record& record, RowRange rows, Index block_rows) {
  const Index m = record.u.cols(), p = record.y.cols(), width = m + p;
  const Index size = 1 + block_rows * width;
  const std::vector<Segment> segments = segments_within(record, rows);
  HankelFactor factor{m, p, block_rows, hankel_columns(segments, block_rows), {}};

  // R so far on top, then a batch of transposed columns of H: memory does not follow the rows.
  const Index batch = 4 * size;
  Matrix stacked = Matrix::Zero(size + batch, size);
  Index filled = size;
  const auto fold = [&] {
    auto active = stacked.topRows(filled);
    const Eigen::HouseholderQR<Matrix> qr(active);
    stacked.topRows(size) = qr.matrixQR().topRows(size).triangularView<Eigen::Upper>();
    filled = size;
  };
  for (const Segment& segment : segments) {
    for (Index t = segment.begin; t + block_rows <= segment.end; ++t) {
      auto row = stacked.row(filled++);
      row(0) = 1;
      for (Index k = 0; k < block_rows; ++k) {
        row.segment(1 + k * width, m) = record.u.row(t + k);
        row.segment(1 + k * width + m, p) = record.y.row(t + k);
      }
      if (filled == stacked.rows()) fold();
    }
  }
  fold();
  factor.R = stacked.topRows(size);
  return factor;
}

}  // namespace reident::identification
