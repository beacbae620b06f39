#include "service/windows/member_run.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "identification/numerics/decompositions.hpp"
#include "identification/simulation/hole_bridging.hpp"
#include "identification/simulation/initial_state.hpp"
#include "identification/simulation/segment_run.hpp"
#include "identification/simulation/square_changes.hpp"
#include "identification/statistics/sensor_noise.hpp"

namespace reident {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Segment;
using identification::Vector;

Vector vector_of(const std::vector<double>& values) {
  return Eigen::Map<const Vector>(values.data(), std::ssize(values));
}

class Run {
 public:
  Run(const identification::StateSpaceModel& model, const identification::Record& record,
      const storage::RunState& before)
      : model_(model),
        record_(record),
        x_(vector_of(before.x)),
        tick_(before.tick),
        square_errors_(before.square_errors.empty() ? Vector(Vector::Zero(model.outputs()))
                                                    : vector_of(before.square_errors)),
        rows_(before.rows) {}

  Matrix over(const Segment& segment) {
    if (tick_ != segment.first_tick) x_ = state_at(segment);
    Matrix outputs(segment.size(), model_.outputs());
    x_ = run_segment(model_, record_, segment, std::move(x_), outputs, 0);
    tick_ = segment.end_tick();
    square_errors_ += (record_.y.middleRows(segment.begin, segment.size()) - outputs)
                          .colwise()
                          .squaredNorm()
                          .transpose();
    rows_ += segment.size();
    return outputs;
  }

  storage::RunState state() const {
    return {list(x_), tick_, list(square_errors_), static_cast<std::int64_t>(rows_)};
  }

 private:
  Vector state_at(const Segment& segment) const {
    const auto before = segments_within(record_, {0, segment.begin});
    if (rows_ > 0 && !before.empty() && tick_ == before.back().end_tick())
      if (auto bridged = state_after_hole(model_, record_, before.back(), segment, x_,
                                          {identification::square_changes(record_),
                                           square_errors_ / static_cast<double>(rows_)}))
        return *std::move(bridged);
    return estimate_initial_state(model_, record_,
                                  segments_within(record_, {segment.begin, record_.rows()}),
                                  identification::state_rows);
  }

  const identification::StateSpaceModel& model_;
  const identification::Record& record_;
  Vector x_;
  std::optional<std::int64_t> tick_;
  Vector square_errors_;
  Index rows_;
};

/// Returns for each output the mean square of what the bias's change of the inputs does to it, and
/// the mean product of that and the error, over the rows of `errors`: the last ones of the bias's.
/// Before the first row, and in holes, the change is what it is on the average. `model` has no
/// offsets.
std::vector<double> squares_and_products(const identification::StateSpaceModel& model,
                                         const identification::Record& bias, const Matrix& errors,
                                         const std::vector<double>& mean_errors) {
  const Index n = model.order();
  const Vector usual = bias.u.colwise().mean().transpose();
  const Vector steady =
      identification::solve_full_lu(Matrix::Identity(n, n) - model.A, Vector(model.B * usual));
  const Vector spread = (bias.u.colwise().maxCoeff() - bias.u.colwise().minCoeff()).transpose();
  std::vector<double> result;
  if (spread.norm() <= 1e-11 * usual.norm()) {
    const Vector effect = model.C * steady + model.D * usual;
    for (Index q = 0; q < effect.size(); ++q)
      result.insert(result.end(),
                    {effect(q) * effect(q), effect(q) * mean_errors[static_cast<std::size_t>(q)]});
    return result;
  }
  Matrix effect(bias.rows(), model.outputs());
  for (const Segment& segment : bias.segments)
    run_segment(model, bias, segment, steady, effect, segment.begin);
  const Index rows = errors.rows();
  for (Index q = 0; q < effect.cols(); ++q) {
    const auto last = effect.col(q).tail(rows);
    for (const double sum : {last.squaredNorm(), last.dot(errors.col(q))})
      result.push_back(sum / static_cast<double>(rows));
  }
  return result;
}

}  // namespace

storage::BlockScore score_block(const EquipmentModel& model, std::int64_t number,
                                const BlockSamples& samples, const storage::RunState& before) {
  storage::BlockScore score;
  score.version = number;
  score.begin = samples.block.range.begin;
  score.rows = samples.block.rows;
  score.state = before;
  if (score.rows == 0) return score;
  const identification::Record& record = samples.record;
  const Index first = samples.first_row, rows = record.rows() - first;
  Run run(model.dynamics, record, before);
  Matrix outputs(rows, record.y.cols());
  std::vector<identification::RowRange> segments;
  for (const Segment& segment : segments_within(record, {first, record.rows()})) {
    outputs.middleRows(segment.begin - first, segment.size()) = run.over(segment);
    segments.push_back({segment.begin - first, segment.end - first});
  }
  const Matrix y = record.y.bottomRows(rows), errors = y - outputs;
  score.mean = list(errors.colwise().mean().transpose());
  score.square = list(errors.cwiseAbs2().colwise().mean().transpose());
  score.noise = list(identification::noise_squares(y, outputs, segments));
  identification::StateSpaceModel changes = model.dynamics;
  changes.u0.setZero();
  changes.y0.setZero();
  for (const identification::Record& bias : samples.bias_effects) {
    score.bias_effects.push_back(bias.y.bottomRows(rows).mean());
    const auto numbers = squares_and_products(changes, bias, errors, score.mean);
    score.bias_effects.insert(score.bias_effects.end(), numbers.begin(), numbers.end());
  }
  score.state = run.state();
  return score;
}

const double* bias_effect_in(const storage::BlockScore& score, std::size_t place,
                             std::size_t biases) {
  const std::size_t numbers = 1 + 2 * score.square.size();
  return score.bias_effects.size() == biases * numbers ? &score.bias_effects[place * numbers]
                                                       : nullptr;
}

}  // namespace reident
