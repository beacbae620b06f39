#include "identification/hankel.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "identification/kernels.hpp"

namespace reident::identification {

Index hankel_columns(const std::vector<Segment>& segments, Index block_rows) {
  Index columns = 0;
  for (const Segment& segment : segments)
    columns += std::max<Index>(0, segment.size() - block_rows + 1);
  return columns;
}

namespace {

/// Least share of a row of the Hankel matrix that those before it may leave, squared, for the sums
/// of products to keep enough of its digits.
constexpr double least_share = 1e-9;

/// H H' from lag products: the first block row is F(tau) = sum_t z[t] z[t+tau]', and every other
/// block follows from its upper left neighbour by the terms that enter and leave. Lower triangle.
Matrix gram(const Record& record, const std::vector<Segment>& segments, Index L) {
  const Index m = record.u.cols(), width = m + record.y.cols();
  Matrix G = Matrix::Zero(1 + L * width, 1 + L * width);
  for (const Segment& segment : segments) {
    const Index columns = segment.size() - L + 1;
    if (columns <= 0) continue;
    Matrix z(width, segment.size());
    z << record.u.middleRows(segment.begin, segment.size()).transpose(),
        record.y.middleRows(segment.begin, segment.size()).transpose();

    Matrix own = Matrix::Zero(1 + L * width, 1 + L * width);
    own(0, 0) = double(columns);
    Vector sum = z.leftCols(columns).rowwise().sum();
    Matrix F = Matrix::Zero(L * width, width);
    add_outer_products({z.data(), L * width, width}, {z.data(), width, width}, columns,
                       Triangle::full, F.data());
    own.block(1, 1, L * width, width) = F;
    for (Index j = 0; j < L; ++j) {
      own.block(1 + j * width, 0, width, 1) = sum;
      if (j + 1 == L) break;
      sum += z.col(columns + j) - z.col(j);
      for (Index i = j; i + 1 < L; ++i)
        own.block(1 + (i + 1) * width, 1 + (j + 1) * width, width, width) =
            own.block(1 + i * width, 1 + j * width, width, width) +
            z.col(columns + i) * z.col(columns + j).transpose() - z.col(i) * z.col(j).transpose();
    }
    G += own;
  }
  return G;
}

/// The triangular factor of the sums, absent when it would have lost too much.
std::optional<Matrix> factor_of_sums(const Matrix& G) {
  const Vector diagonal = G.diagonal();
  const Eigen::LLT<Matrix> llt(G);
  if (llt.info() != Eigen::Success) return std::nullopt;
  const Vector left = llt.matrixLLT().diagonal().array().square();
  if (!((left.array() > least_share * diagonal.array()).all())) return std::nullopt;
  return llt.matrixU();
}

/// The same to full accuracy: a QR of the transposed columns of H, in batches, so that memory does
/// not follow the rows.
Matrix factor_of_rows(const Record& record, const std::vector<Segment>& segments, Index L) {
  const Index m = record.u.cols(), p = record.y.cols(), width = m + p, size = 1 + L * width;
  Matrix stacked = Matrix::Zero(5 * size, size);
  Index filled = size;
  const auto fold = [&] {
    const Eigen::HouseholderQR<Matrix> qr(stacked.topRows(filled));
    stacked.topRows(size) = qr.matrixQR().topRows(size).triangularView<Eigen::Upper>();
    filled = size;
  };
  for (const Segment& segment : segments) {
    for (Index t = segment.begin; t + L <= segment.end; ++t) {
      auto row = stacked.row(filled++);
      row(0) = 1;
      for (Index k = 0; k < L; ++k) {
        row.segment(1 + k * width, m) = record.u.row(t + k);
        row.segment(1 + k * width + m, p) = record.y.row(t + k);
      }
      if (filled == stacked.rows()) fold();
    }
  }
  fold();
  return stacked.topRows(size);
}

}  // namespace

HankelFactor compress(const Record& record, RowRange rows, Index block_rows) {
  const std::vector<Segment> segments = segments_within(record, rows);
  HankelFactor factor{
      record.u.cols(), record.y.cols(), block_rows, hankel_columns(segments, block_rows), {}};
  if (auto R = factor_of_sums(gram(record, segments, block_rows)))
    factor.R = std::move(*R);
  else
    factor.R = factor_of_rows(record, segments, block_rows);
  return factor;
}

}  // namespace reident::identification
