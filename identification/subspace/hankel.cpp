#include "identification/subspace/hankel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/kernels.hpp"

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
constexpr double enough_share = 1e-9;

/// What the Hankel products of one segment are made of, in the channels that take part, scaled.
struct ScaledSegment {
  Index count;
  Matrix products;     // L w x w, as SegmentSums::products
  Matrix first, last;  // w x (L - 1), the ends of the segment
  Vector sum;
};

struct ChosenChannels {
  std::vector<Index> index;  // among [u; y]
  Vector weight;             // 1 / scale
};

ChosenChannels chosen_channels(const Normalisation& normalisation) {
  const Normalisation& s = normalisation;
  ChosenChannels chosen{s.inputs, Vector(static_cast<Index>(s.inputs.size() + s.outputs.size()))};
  for (const Index q : s.outputs) chosen.index.push_back(s.u_scale.size() + q);
  chosen.weight << s.u_scale(s.inputs).cwiseInverse(), s.y_scale(s.outputs).cwiseInverse();
  return chosen;
}

ScaledSegment scaled(SegmentSums segment, const Vector& mean, const ChosenChannels& chosen,
                     Index L) {
  segment.refer_to(mean);
  const Index width = mean.size(), w = chosen.weight.size();
  const auto weigh = chosen.weight.asDiagonal();
  ScaledSegment result{segment.count(), Matrix(L * w, w),
                       weigh * segment.first().leftCols(L - 1)(chosen.index, Eigen::all),
                       weigh * segment.last().rightCols(L - 1)(chosen.index, Eigen::all),
                       weigh * segment.sum()(chosen.index)};
  for (Index tau = 0; tau < L; ++tau)
    result.products.middleRows(tau * w, w) =
        weigh * segment.products().middleRows(tau * width, width)(chosen.index, chosen.index) *
        weigh;
  return result;
}

/// Adds the segment's part of H H', rows 1, z[t], ..., z[t+L-1], to the lower triangle of G: the
/// first block column is made of the lag products, and every other one is its left neighbour, one
/// block up, with the terms that enter and leave.
void add_segment(const ScaledSegment& segment, Index L, Matrix& G) {
  const Index w = segment.sum.size();
  G(0, 0) += double(segment.count - L + 1);
  Vector sum = segment.sum - segment.last.rowwise().sum();
  Matrix column =
      segment.products;  // block i: sum over the columns of z[t+i] z[t+j]', from block j on
  for (Index i = 0; i + 1 < L; ++i)
    column.middleRows(i * w, w) -=
        segment.last.rightCols(L - 1 - i) * segment.last.leftCols(L - 1 - i).transpose();
  const Eigen::Map<const Vector> entering(segment.last.data(), segment.last.size());
  const Eigen::Map<const Vector> leaving(segment.first.data(), segment.first.size());
  for (Index j = 0; j < L; ++j) {
    const Index below = (L - j) * w;
    G.block(1 + j * w, 0, w, 1) += sum;
    G.block(1 + j * w, 1 + j * w, below, w) += column.topRows(below);
    if (j + 1 == L) break;
    sum += segment.last.col(j) - segment.first.col(j);
    for (Index c = 0; c < w; ++c)
      column.col(c).head(below - w) += entering.tail(below - w) * segment.last(c, j) -
                                       leaving.tail(below - w) * segment.first(c, j);
  }
}

/// Where the rows [1, U_f, U_p, Y_p, Y_f] stand among 1, z[t], ..., z[t+2s-1].
std::vector<Index> ordered_rows(Index m, Index p, Index s) {
  std::vector<Index> rows{0};
  const auto append = [&](Index begin, Index channel, Index count) {
    for (Index k = begin; k < begin + s; ++k)
      for (Index c = 0; c < count; ++c) rows.push_back(1 + k * (m + p) + channel + c);
  };
  append(s, 0, m);
  append(0, 0, m);
  append(0, m, p);
  append(s, m, p);
  return rows;
}

}  // namespace

std::optional<HankelFactor> factor_of_sums(const RangeSums& sums,
                                           const Normalisation& normalisation, Index horizon) {
  const Index L = 2 * horizon, m = static_cast<Index>(normalisation.inputs.size());
  const Index p = static_cast<Index>(normalisation.outputs.size()), size = 1 + L * (m + p);
  const ChosenChannels chosen = chosen_channels(normalisation);
  const Vector mean = sums.mean();
  HankelFactor factor{m, p, horizon, 0, Matrix(size, size), 1};
  Matrix G = Matrix::Zero(size, size);
  for (const SegmentSums& segment : sums.segments) {
    if (segment.count() < L) continue;
    factor.columns += segment.count() - L + 1;
    add_segment(scaled(segment, mean, chosen, L), L, G);
  }
  const std::vector<Index> rows = ordered_rows(m, p, horizon);
  for (Index j = 0; j < size; ++j)
    for (Index i = j; i < size; ++i) {
      const auto [low, high] =
          std::minmax(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
      factor.L(i, j) = G(high, low);
    }
  const Vector whole = factor.L.diagonal();
  if (!cholesky(factor.L.data(), size)) return std::nullopt;
  factor.L.triangularView<Eigen::StrictlyUpper>().setZero();
  factor.least_share = (factor.L.diagonal().array().square() / whole.array()).minCoeff();
  if (!(factor.least_share > enough_share)) return std::nullopt;
  return factor;
}

HankelFactor factor_of_rows(const Record& normalised, const std::vector<Segment>& segments,
                            Index horizon) {
  const Index m = normalised.u.cols(), p = normalised.y.cols(), s = horizon;
  const Index size = 1 + 2 * s * (m + p);
  Matrix stacked = Matrix::Zero(5 * size, size);
  Index filled = size;
  const auto fold = [&] {
    stacked.topRows(size) = triangular_factor(stacked.topRows(filled));
    filled = size;
  };
  for (const Segment& segment : segments) {
    for (Index t = segment.begin; t + 2 * s <= segment.end; ++t) {
      auto row = stacked.row(filled++);
      row(0) = 1;
      Index at = 1;
      const auto put = [&](const Matrix& channels, Index begin) {
        for (Index k = begin; k < begin + s; ++k, at += channels.cols())
          row.segment(at, channels.cols()) = channels.row(k);
      };
      put(normalised.u, t + s);
      put(normalised.u, t);
      put(normalised.y, t);
      put(normalised.y, t + s);
      if (filled == stacked.rows()) fold();
    }
  }
  fold();
  HankelFactor factor{m, p, s, hankel_columns(segments, 2 * s), stacked.topRows(size).transpose(),
                      0};
  const Vector whole = factor.L.rowwise().squaredNorm();
  factor.least_share = (factor.L.diagonal().array().square() / whole.array()).minCoeff();
  return factor;
}

HankelFactor compress(const RangeSums& sums, const Normalisation& normalisation,
                      const Record& normalised, const std::vector<Segment>& segments,
                      Index horizon) {
  if (auto factor = factor_of_sums(sums, normalisation, horizon)) return std::move(*factor);
  return factor_of_rows(normalised, segments, horizon);
}

}  // namespace reident::identification
