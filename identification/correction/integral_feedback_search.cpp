#include "identification/correction/integral_feedback_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identification/correction/pole_placement_search.hpp"
#include "identification/numerics/decompositions.hpp"
#include "identification/simulation/free_run.hpp"

namespace reident::identification {
namespace {

constexpr double full_rank = 1e-8;
constexpr Index first_rows = 1000;
constexpr Index most_tuned_rows = 5000;
constexpr std::ptrdiff_t runs_on_all_rows = 12;
constexpr int loop_scales_per_decade = 10;
constexpr int shortest_tau = -2;  // powers of two
constexpr int longest_tau = 6;

Verdict no_gain(std::string reason) {
  return {VerdictCode::no_gain, std::move(reason)};
}

/// Why constant inputs cannot hold each output apart from the others.
std::optional<Verdict> obstacle(const StateSpaceModel& model, const Vector& error_limit) {
  const Index m = model.inputs(), p = model.outputs();
  if (p > m)
    return no_gain("integral feedback needs an input for each output, and there are " +
                   std::to_string(p) + " outputs and " + std::to_string(m) + " inputs");
  if (!(error_limit.minCoeff() > 0))
    return no_gain("an output did not move in the identification rows, so that nothing follows it");
  const std::optional<Matrix> gain = static_gain(model);
  if (!gain) return no_gain("a pole of the model is too near to 1 for a second integrator");
  const Index n = model.order();
  const Matrix settled = solve_full_lu(Matrix::Identity(n, n) - model.A, model.B);
  const Vector parts =
      (model.C.cwiseAbs() * settled.cwiseAbs() + model.D.cwiseAbs()).rowwise().norm();
  const Vector sizes = gain->rowwise().norm();
  for (Index q = 0; q < p; ++q)
    if (!(sizes(q) > full_rank * parts(q)))
      return no_gain("constant inputs leave output " + std::to_string(q + 1) +
                     " where it is (a zero at z = 1), so that they cannot correct it");
  const Matrix rows = sizes.cwiseInverse().asDiagonal() * *gain;
  const Vector singular = singular_values(rows);
  if (!(singular(p - 1) > full_rank * singular(0)))
    return no_gain(
        "constant inputs move the outputs together alone (a zero at z = 1), so that they cannot "
        "correct each of them");
  return std::nullopt;
}

/// What inputs that are as large as their columns of B do to each output within a sample or two: an
/// integrator in these units is not lost against the states.
Vector output_sizes(const StateSpaceModel& model) {
  Vector inputs = model.B.colwise().norm();
  inputs = (inputs.array() > 0).select(inputs, 1);
  return (model.C.rowwise().squaredNorm() +
          (model.D * inputs.cwiseInverse().asDiagonal()).rowwise().squaredNorm())
      .cwiseSqrt();
}

}  // namespace

std::variant<TrackingPlacement, Verdict> place_tracking_poles(const StateSpaceModel& model,
                                                              const Poles& wanted,
                                                              const Vector& error_limit) {
  const Index n = model.order(), m = model.inputs(), p = model.outputs();
  assert(is_well_formed(model) && is_stable(model.A) && error_limit.size() == p);
  if (auto verdict = obstacle(model, error_limit)) return *verdict;

  // Without feedback the loop is closed_loop() of no gain.
  const Vector inverse = output_sizes(model).cwiseInverse();
  StateSpaceModel scaled = model;
  scaled.C = inverse.asDiagonal() * model.C;
  scaled.D = inverse.asDiagonal() * model.D;
  Matrix drive = Matrix::Zero(n + 2 * p, m);
  drive.topRows(n) = scaled.B;
  drive.middleRows(n, p) = -scaled.D;
  const Matrix open =
      closed_loop(scaled, {Matrix::Zero(m, n), Matrix::Zero(m, 2 * p), error_limit});
  auto placed = place_poles(open, drive, wanted);
  if (auto* verdict = std::get_if<Verdict>(&placed)) return *verdict;
  auto& placement = std::get<PolePlacement>(placed);
  TrackingPlacement result{
      {placement.gain.leftCols(n), placement.gain.rightCols(2 * p), error_limit},
      std::move(placement.uncontrollable)};
  for (Index integrator : {Index{0}, p})
    result.gain.integral.middleCols(integrator, p) *= inverse.asDiagonal();
  if (!is_stabilising(model, result.gain))
    return no_gain("the loop that the gain closes is not stable");
  return result;
}

namespace {

std::vector<TrackingSearch> every_placement(const StateSpaceModel& model,
                                            const Vector& error_limit) {
  const Poles poles = poles_of(model.A);
  const std::size_t further = 2 * static_cast<std::size_t>(model.outputs());
  std::vector<TrackingSearch> found;
  for (int step = -loop_scales_per_decade; step <= loop_scales_per_decade; ++step)
    for (int power = shortest_tau; power <= longest_tau; ++power) {
      const double scale = std::pow(10, double(step) / loop_scales_per_decade);
      const double tau = std::exp2(power);
      Poles wanted = scaled_poles(poles, scale);
      wanted.resize(wanted.size() + further, std::exp(-1 / tau));
      const auto placed = place_tracking_poles(model, wanted, error_limit);
      const auto* placement = std::get_if<TrackingPlacement>(&placed);
      if (!placement) continue;
      TrackingSearch& one = found.emplace_back();
      one.gain = placement->gain;
      one.scale = scale;
      one.tau_samples = tau;
      one.uncontrollable = placement->uncontrollable;
    }
  return found;
}

/// The one of the consecutive ranges of `first_rows` in which the outputs move most: at rest all
/// placements err alike.
RowRange liveliest(const Record& record, RowRange rows, const Vector& error_limit) {
  RowRange best{rows.begin, std::min(rows.end, rows.begin + first_rows)};
  double most = -1;
  for (Index begin = rows.begin; begin + first_rows <= rows.end; begin += first_rows) {
    const Matrix y =
        record.y.middleRows(begin, first_rows) * error_limit.cwiseInverse().asDiagonal();
    const double movement = (y.rowwise() - y.colwise().mean()).squaredNorm();
    if (movement > most) best = {begin, begin + first_rows};
    most = std::max(most, movement);
  }
  return best;
}

/// Scores the placements on a few rows by the loop without its limits.
void score_quickly(const StateSpaceModel& model, const Record& record, RowRange rows,
                   std::vector<TrackingSearch>& placements) {
  const Matrix y = record.y.middleRows(rows.begin, rows.size());
  const std::vector<Segment> segments = segments_within(record, rows);
  Matrix free_errors = y;
  for (const Segment& segment : segments)
    free_errors.middleRows(segment.begin - rows.begin, segment.size()) -=
        free_run(model, record, {segment.begin, segment.end});
  for (TrackingSearch& one : placements) {
    Matrix y_hat = y;
    for (const Segment& segment : segments) {
      const Index begin = segment.begin - rows.begin;
      y_hat.middleRows(begin, segment.size()) -=
          tracked_errors(model, one.gain, free_errors.middleRows(begin, segment.size()));
    }
    one.tracking = score(y, y_hat);
  }
}

void score_tracking(const StateSpaceModel& model, const Record& record, RowRange rows,
                    TrackingSearch& one) {
  one.tracking = score(record.y.middleRows(rows.begin, rows.size()),
                       tracked_run(model, one.gain, record, rows));
}

}  // namespace

std::variant<TrackingSearch, Verdict> search_tracking(const StateSpaceModel& model,
                                                      const Record& record, RowRange identify,
                                                      RowRange tune) {
  assert(0 <= identify.begin && identify.begin < identify.end);
  assert(identify.end <= record.rows() && tune.begin < tune.end);
  assert(0 <= tune.begin && tune.end <= record.rows());
  const auto identified = record.y.middleRows(identify.begin, identify.size()).colwise();
  const Vector error_limit = (identified.maxCoeff() - identified.minCoeff()).transpose();
  if (auto verdict = obstacle(model, error_limit)) return *verdict;

  const RowRange rows{tune.begin, std::min(tune.end, tune.begin + most_tuned_rows)};
  const RowRange few = liveliest(record, rows, error_limit);
  std::vector<TrackingSearch> tried = every_placement(model, error_limit);
  const auto by_error = [](const TrackingSearch& a, const TrackingSearch& b) {
    return a.tracking.mrse() < b.tracking.mrse();
  };
  score_quickly(model, record, few, tried);
  const auto kept = std::min(std::ssize(tried), runs_on_all_rows);
  std::partial_sort(tried.begin(), tried.begin() + kept, tried.end(), by_error);
  tried.resize(static_cast<std::size_t>(kept));
  for (TrackingSearch& one : tried) score_tracking(model, record, rows, one);
  const auto best = std::min_element(tried.begin(), tried.end(), by_error);

  const Matrix y = record.y.middleRows(rows.begin, rows.size());
  const Score free = score(y, free_run(model, record, rows));
  if (best == tried.end() || !(best->tracking.mrse() < worthwhile * free.mrse()))
    return no_gain("no placement of the poles follows the output closer than the free run does");
  best->free_run = free;
  return *best;
}

}  // namespace reident::identification
