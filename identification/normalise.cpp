#include "identification/normalise.hpp"

#include <cmath>

namespace reident::identification {
namespace {

struct Moments {
  double mean = 0;
  double deviation = 0;  // 0 for a channel that does not move
};

Moments moments_of(const Eigen::Ref<const Vector>& channel) {
  // Two passes: the deviation of a small signal on a large offset would drown in one.
  const double mean = channel.mean();
  const double deviation =
      (channel.array() - mean).matrix().stableNorm() / std::sqrt(double(channel.size()));
  const double rounding = 1e-13 * channel.cwiseAbs().maxCoeff();
  return {mean, deviation > rounding ? deviation : 0};
}

void measure(const Matrix& channels, RowRange rows, Vector& mean, Vector& scale,
             std::vector<Index>& taking_part) {
  mean.resize(channels.cols());
  scale.resize(channels.cols());
  for (Index c = 0; c < channels.cols(); ++c) {
    const Moments moments = moments_of(channels.col(c).segment(rows.begin, rows.size()));
    mean(c) = moments.mean;
    scale(c) = moments.deviation > 0 ? moments.deviation : 1;
    if (moments.deviation > 0) taking_part.push_back(c);
  }
}

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

}  // namespace

Normalisation normalisation_of(const Record& record, RowRange rows) {
  Normalisation result;
  measure(record.u, rows, result.u_mean, result.u_scale, result.inputs);
  measure(record.y, rows, result.y_mean, result.y_scale, result.outputs);
  return result;
}

Record normalised(const Record& record, RowRange rows, const Normalisation& normalisation) {
  const Normalisation& s = normalisation;
  Record result{record.period_s, apply(record.u, rows, s.u_mean, s.u_scale, s.inputs),
                apply(record.y, rows, s.y_mean, s.y_scale, s.outputs),
                segments_within(record, rows)};
  for (Segment& segment : result.segments) {
    segment.begin -= rows.begin;
    segment.end -= rows.begin;
  }
  return result;
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
