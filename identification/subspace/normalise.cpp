#include "identification/subspace/normalise.hpp"

#include <cmath>

namespace reident::identification {
namespace {

Matrix apply(const Matrix& channels, RowRange rows, const Vector& mean, const Vector& scale,
             const std::vector<Index>& taking_part) {
  Matrix result(rows.size(), static_cast<Index>(taking_part.size()));
  for (Index c = 0; c < result.cols(); ++c) {
    const Index source = taking_part[static_cast<std::size_t>(c)];
    result.col(c) = (channels.col(source).segment(rows.begin, rows.size()).array() - mean(source)) /
                    scale(source);
  }
  return result;
}

/// About the mean of all (w x w).
Matrix covariance_of(const RangeSums& sums) {
  const Vector mean = sums.mean();
  Matrix squares = Matrix::Zero(mean.size(), mean.size());
  for (SegmentSums segment : sums.segments) {
    segment.refer_to(mean);
    squares += segment.products().topRows(mean.size());
  }
  return squares / double(sums.rows());
}

}  // namespace

Normalisation normalisation_of(const RangeSums& sums, Index inputs) {
  const Vector mean = sums.mean();
  const Index width = mean.size();
  const Matrix covariance = covariance_of(sums);
  Vector scale = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  Normalisation result;
  for (Index c = 0; c < width; ++c) {
    constexpr double rounding = 1e-13;
    if (scale(c) > rounding * std::abs(mean(c)))
      (c < inputs ? result.inputs : result.outputs).push_back(c < inputs ? c : c - inputs);
    else
      scale(c) = 1;
  }
  result.u_mean = mean.head(inputs);
  result.u_scale = scale.head(inputs);
  result.y_mean = mean.tail(width - inputs);
  result.y_scale = scale.tail(width - inputs);
  return result;
}

Matrix input_correlation(const RangeSums& sums, const Normalisation& normalisation) {
  const auto weigh = normalisation.u_scale(normalisation.inputs).cwiseInverse().asDiagonal();
  return weigh * covariance_of(sums)(normalisation.inputs, normalisation.inputs) * weigh;
}

Record normalised(const Record& record, RowRange rows, const Normalisation& normalisation) {
  const Normalisation& s = normalisation;
  return {record.period_s, apply(record.u, rows, s.u_mean, s.u_scale, s.inputs),
          apply(record.y, rows, s.y_mean, s.y_scale, s.outputs), segments_from(record, rows)};
}

void set_operating_point(StateSpaceModel& model, const Normalisation& normalisation,
                         const Vector& mean) {
  const Normalisation& s = normalisation;
  const auto u_mean = mean.head(s.u_mean.size()), y_mean = mean.tail(s.y_mean.size());
  model.u0 = ((u_mean - s.u_mean).array() / s.u_scale.array()).matrix()(s.inputs);
  model.y0 = ((y_mean - s.y_mean).array() / s.y_scale.array()).matrix()(s.outputs);
}

StateSpaceModel in_units(const StateSpaceModel& model, const Normalisation& normalisation) {
  const Normalisation& s = normalisation;
  const Index n = model.order(), m = s.u_mean.size(), p = s.y_mean.size();
  StateSpaceModel result{model.A,
                         Matrix::Zero(n, m),
                         Matrix::Zero(p, n),
                         Matrix::Zero(p, m),
                         model.K.size() == 0 ? Matrix() : Matrix::Zero(n, p),
                         s.u_mean,
                         s.y_mean,
                         model.period_s};
  for (Index i = 0; i < model.inputs(); ++i) {
    const Index target = s.inputs[static_cast<std::size_t>(i)];
    result.B.col(target) = model.B.col(i) / s.u_scale(target);
    result.u0(target) += model.u0(i) * s.u_scale(target);
  }
  for (Index q = 0; q < model.outputs(); ++q) {
    const Index target = s.outputs[static_cast<std::size_t>(q)];
    const double scale = s.y_scale(target);
    result.C.row(target) = model.C.row(q) * scale;
    result.y0(target) += model.y0(q) * scale;
    for (Index i = 0; i < model.inputs(); ++i) {
      const Index source = s.inputs[static_cast<std::size_t>(i)];
      result.D(target, source) = model.D(q, i) * scale / s.u_scale(source);
    }
    if (model.K.size() != 0) result.K.col(target) = model.K.col(q) / scale;
  }
  return result;
}

}  // namespace reident::identification
