#include "identification/statistics/diagnostics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "identification/numerics/decompositions.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/prediction.hpp"

namespace reident::identification {
namespace {

constexpr Index lags = 25;
constexpr Index prediction_steps[] = {1, 2, 5, 10, 20, 50, 100};

/// The scored part of the record, rows counted from its first.
struct Scored {
  Matrix y;
  std::vector<Series> inputs;
  std::vector<RowRange> segments;
  Index longest_segment = 0;
};

Scored scored_part(const Record& record, RowRange rows) {
  Scored part;
  part.y = record.y.middleRows(rows.begin, rows.size());
  for (const Segment& segment : segments_within(record, rows)) {
    part.segments.push_back({segment.begin - rows.begin, segment.end - rows.begin});
    part.longest_segment = std::max(part.longest_segment, segment.size());
  }
  for (Index j = 0; j < record.u.cols(); ++j)
    part.inputs.emplace_back(record.u.col(j).segment(rows.begin, rows.size()), part.segments);
  return part;
}

std::vector<Series> residuals_of(const Scored& part, const Matrix& y_hat) {
  std::vector<Series> residuals;
  for (Index q = 0; q < y_hat.cols(); ++q)
    residuals.emplace_back(part.y.col(q) - y_hat.col(q), part.segments);
  return residuals;
}

std::vector<Whiteness> whiteness_of(std::vector<Series>& residuals) {
  std::vector<Whiteness> result;
  for (Series& residual : residuals) {
    const Correlogram correlogram = autocorrelogram(residual, lags);
    result.push_back({summary(correlogram), portmanteau(residual, correlogram)});
  }
  return result;
}

std::vector<InputCorrelation> input_correlations(std::vector<Series>& inputs,
                                                 std::vector<Series>& residuals) {
  std::vector<InputCorrelation> result;
  for (std::size_t q = 0; q < residuals.size(); ++q)
    for (std::size_t j = 0; j < inputs.size(); ++j)
      result.push_back({static_cast<Index>(j), static_cast<Index>(q),
                        summary(cross_correlogram(inputs[j], residuals[q], lags))});
  return result;
}

/// Without what is linear in the inputs; absent where nothing else is there.
std::optional<Series> without_linear(const Vector& bend, const std::vector<const Series*>& inputs) {
  constexpr double least_share = 1e-3;
  Matrix u(bend.size(), std::ssize(inputs));
  for (Index j = 0; j < u.cols(); ++j) u.col(j) = inputs[static_cast<std::size_t>(j)]->centred();
  const Vector moves = bend.array() - bend.mean();
  const Vector left = moves - u * solve_least_norm(u, moves);
  if (!(left.squaredNorm() > least_share * moves.squaredNorm())) return std::nullopt;
  return Series(left, inputs.front()->segments());
}

}  // namespace

std::vector<Bend> bends(const Record& record, RowRange scored, const Matrix& y_hat) {
  const Scored part = scored_part(record, scored);
  std::vector<Series> residuals = residuals_of(part, y_hat);
  std::vector<Bend> result(residuals.size());
  const auto look_at = [&](std::size_t j, std::size_t k, const Vector& bend) {
    std::vector<const Series*> inputs{&part.inputs[j]};
    if (k != j) inputs.push_back(&part.inputs[k]);
    auto series = without_linear(bend, inputs);
    for (std::size_t q = 0; series && q < residuals.size(); ++q)
      if (const auto found = summary(cross_correlogram(*series, residuals[q], lags));
          found.lag >= 0 && std::abs(found.largest) > std::abs(result[q].correlation.largest))
        result[q] = {static_cast<Index>(j), static_cast<Index>(k), found};
  };
  const std::size_t inputs = part.inputs.size();
  for (std::size_t j = 0; j < inputs; ++j) {
    const Vector& u = part.inputs[j].centred();
    look_at(j, j, u.cwiseAbs2());
    look_at(j, j, u.cwiseProduct(u.cwiseAbs()));
    for (std::size_t k = j + 1; k < inputs && inputs <= most_products; ++k)
      look_at(j, k, u.cwiseProduct(part.inputs[k].centred()));
  }
  return result;
}

Diagnostics diagnose(const StateSpaceModel& model, const Record& record, RowRange run,
                     RowRange scored, const std::optional<Vector>& x0) {
  assert(scored.size() > 0 && run.begin <= scored.begin && scored.end <= run.end);
  Scored part = scored_part(record, scored);
  const auto in_part = [run, scored](const Matrix& y_hat) -> Matrix {
    return y_hat.middleRows(scored.begin - run.begin, scored.size());
  };
  const Matrix y_run = free_run(model, record, run, x0);
  const Matrix y_free = in_part(y_run);

  Diagnostics result;
  result.rows = scored.size();
  result.predicted = model.K.size() > 0;
  std::vector<Series> free_residuals = residuals_of(part, y_free);
  result.free_run_inputs = input_correlations(part.inputs, free_residuals);
  if (result.predicted) {
    const Predictor predictor(model, record, run, y_run);
    for (const Index steps : prediction_steps) {
      if (steps > 1 && steps >= part.longest_segment) break;
      const Matrix y_hat = in_part(predictor.outputs(steps));
      result.predictions.push_back({steps, score(part.y, y_hat)});
      if (steps > 1) continue;
      std::vector<Series> residuals = residuals_of(part, y_hat);
      result.whiteness = whiteness_of(residuals);
      result.prediction_inputs = input_correlations(part.inputs, residuals);
    }
  } else {
    result.whiteness = whiteness_of(free_residuals);
  }
  result.free_run = score(part.y, y_free);
  result.interval = error_interval(part.y, y_free, part.segments);
  result.spread = error_spread(part.y, y_free);
  return result;
}

}  // namespace reident::identification
