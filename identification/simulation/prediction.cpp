#include "identification/simulation/prediction.hpp"

#include <cassert>
#include <utility>

namespace reident::identification {

Predictor::Predictor(const StateSpaceModel& model, const Record& record, RowRange run,
                     Matrix y_free)
    : A_(model.A), C_(model.C), y_free_(std::move(y_free)), d_(model.order(), run.size()) {
  assert(model.K.rows() == model.order() && model.K.cols() == model.outputs());
  assert(y_free_.rows() == run.size() && y_free_.cols() == model.outputs());
  const Matrix F = model.A - model.K * model.C;
  const Matrix Ke = model.K * (record.y.middleRows(run.begin, run.size()) - y_free_).transpose();
  for (const Segment& segment : segments_within(record, run)) {
    segments_.push_back({segment.begin - run.begin, segment.end - run.begin});
    const auto [begin, end] = segments_.back();
    d_.col(begin).setZero();
    for (Index k = begin; k + 1 < end; ++k) {
      d_.col(k + 1) = Ke.col(k);
      d_.col(k + 1).noalias() += F * d_.col(k);
    }
  }
}

Matrix Predictor::outputs(Index steps) const {
  assert(steps >= 1);
  Matrix gain = C_;
  for (Index step = 1; step < steps; ++step) gain = (gain * A_).eval();
  Matrix y_hat = y_free_;
  for (const RowRange& segment : segments_) {
    const Index count = segment.size() - (steps - 1);
    if (count > 0)
      y_hat.middleRows(segment.end - count, count) +=
          (gain * d_.middleCols(segment.begin, count)).transpose();
  }
  return y_hat;
}

}  // namespace reident::identification
