#include "identification/statistics/followed.hpp"

#include <algorithm>
#include <cmath>

#include "identification/statistics/autoregression.hpp"

namespace reident::identification {
namespace {

constexpr double alike = 1e-12;  // of effects
constexpr Index blocks = 20;

/// What the values before in the same segment do not explain.
Vector without_past(const Vector& values, const Vector& past,
                    const std::vector<RowRange>& segments) {
  Vector rest = values;
  for (const RowRange& segment : segments)
    for (Index row = segment.begin; row < segment.end; ++row)
      for (Index k = 0; k < std::min(past.size(), row - segment.begin); ++k)
        rest(row) -= past(k) * values(row - 1 - k);
  return rest;
}

/// Where clusters begin: at each range of the rows, and at so many places elsewhere.
std::vector<Index> cluster_begins(const std::vector<Index>& rows, Index all) {
  std::vector<Index> begins;
  for (Index i = 0; i < blocks; ++i) begins.push_back(i * all / blocks);
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (i == 0 || rows[i] > rows[i - 1] + 1) begins.push_back(rows[i]);
  std::sort(begins.begin(), begins.end());
  begins.erase(std::unique(begins.begin(), begins.end()), begins.end());
  return begins;
}

}  // namespace

std::array<Followed, 2> followed(const Matrix& errors, const std::array<Matrix, 2>& effects,
                                 const std::vector<Index>& rows,
                                 const std::vector<RowRange>& segments) {
  using Pair = Eigen::Vector2d;
  using Pairs = Eigen::Matrix<double, Eigen::Dynamic, 2>;
  // The normal equations of each row, summed over outputs.
  Pairs products = Pairs::Zero(errors.rows(), 2);
  std::array<Pairs, 2> squares{products, products};
  for (Index q = 0; q < errors.cols(); ++q) {
    const Vector past = burg_coefficients(errors.col(q), segments);
    Vector left = without_past(errors.col(q), past, segments);
    left.array() -= left.mean();
    Pairs moved(errors.rows(), 2);
    for (Index i = 0; i < 2; ++i)
      moved.col(i) = without_past(effects[static_cast<std::size_t>(i)].col(q), past, segments);
    moved.rowwise() -= moved.colwise().mean();
    const double weight = 1 / left.squaredNorm();
    products += weight * (moved.array().colwise() * left.array()).matrix();
    for (Index i = 0; i < 2; ++i)
      squares[static_cast<std::size_t>(i)] +=
          weight * (moved.array().colwise() * moved.col(i).array()).matrix();
  }
  Eigen::Matrix2d information;
  information << squares[0].colwise().sum(), squares[1].colwise().sum();
  const double product = information.diagonal().prod();
  const double determinant = product - information(0, 1) * information(1, 0);
  if (!(determinant > alike * product) || !std::isfinite(determinant)) return {};
  Eigen::Matrix2d inverse;
  inverse << information(1, 1), -information(0, 1), -information(1, 0), information(0, 0);
  inverse /= determinant;
  const Pair coefficients = inverse * products.colwise().sum().transpose();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  const std::vector<Index> begins = cluster_begins(rows, errors.rows());
  for (std::size_t cluster = 0; cluster < begins.size(); ++cluster) {
    const Index begin = begins[cluster];
    const Index size = (cluster + 1 < begins.size() ? begins[cluster + 1] : errors.rows()) - begin;
    Pair score = products.middleRows(begin, size).colwise().sum().transpose();
    for (std::size_t i = 0; i < 2; ++i)
      score -=
          coefficients(Index(i)) * squares[i].middleRows(begin, size).colwise().sum().transpose();
    spread += score * score.transpose();
  }
  const Pair of_white_errors = inverse.diagonal() / double(errors.rows());
  const Pair of_clusters = (inverse * spread * inverse).diagonal();
  // Few rows hold all that there is of the first share: then their own cluster says nothing.
  const double misfit = std::max(1.0, of_clusters(1) / of_white_errors(1));
  const Pair variances = of_clusters.cwiseMax(misfit * of_white_errors);
  return {Followed{1 + coefficients(0), std::sqrt(variances(0))},
          Followed{1 + coefficients(1), std::sqrt(variances(1))}};
}

Vector bridged(Vector values, const std::vector<Index>& rows,
               const std::vector<RowRange>& segments) {
  auto next = rows.begin();
  for (const RowRange& segment : segments)
    while (next != rows.end() && *next < segment.end) {
      const Index begin = *next;
      Index end = begin;
      while (next != rows.end() && *next == end && end < segment.end) ++next, ++end;
      if (begin == segment.begin && end == segment.end) continue;
      const double last = end < segment.end ? values(end) : values(begin - 1);
      const double first = begin > segment.begin ? values(begin - 1) : last;
      for (Index row = begin; row < end; ++row)
        values(row) = first + (last - first) * double(row - begin + 1) / double(end - begin + 1);
    }
  return values;
}

}  // namespace reident::identification
