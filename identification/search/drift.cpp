#include "identification/search/drift.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identification/numerics/decompositions.hpp"
#include "identification/samples/verdict.hpp"
#include "identification/search/candidates.hpp"
#include "identification/search/folds.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/initial_state.hpp"
#include "identification/statistics/autoregression.hpp"

namespace reident::identification {
namespace {

constexpr int least_half_periods = 8, most_half_periods = 64;
constexpr Index rows_of_half_period = 20;  // at least
constexpr double most_of_it = 1.0 / 3;

/// What is slow in rows: the cosines over their time of no more than so many half periods.
class SlowPart {
 public:
  SlowPart(const Record& record, int half_periods) : cosines_(record.rows(), 1 + half_periods) {
    const double first = double(record.segments.front().first_tick);
    const double ticks = double(record.segments.back().end_tick()) - first;
    for (const Segment& segment : record.segments)
      for (Index row = segment.begin; row < segment.end; ++row) {
        const double phase =
            std::numbers::pi * (double(segment.tick_of(row)) - first + 0.5) / ticks;
        for (int k = 0; k <= half_periods; ++k) cosines_(row, k) = std::cos(k * phase);
      }
  }

  Matrix without(const Matrix& channels) const {
    return channels - cosines_ * solve_pivoted_qr(cosines_, channels);
  }

  /// Returns the share of each channel's variance that is slow; not a number where it is constant.
  Vector shares(const Matrix& channels) const {
    const Matrix moving = channels.rowwise() - channels.colwise().mean();
    return 1 - (without(channels).colwise().squaredNorm().array() /
                moving.colwise().squaredNorm().array())
                   .transpose();
  }

 private:
  Matrix cosines_;  // N x (1 + half periods)
};

/// Mean over outputs of the logarithm of the mean square of what the errors' own past does not
/// foretell.
double log_unforetold(const Matrix& errors, const std::vector<RowRange>& segments) {
  double sum = 0;
  for (Index q = 0; q < errors.cols(); ++q) {
    const Vector own = errors.col(q), past = burg_coefficients(own, segments);
    const Innovations left = innovations_of(own, past, segments);
    sum += std::log(left.squares / double(left.rows));
  }
  return sum / double(errors.cols());
}

/// Gives the outputs of a model other units: each is to be so many of what it was.
StateSpaceModel with_outputs_times(StateSpaceModel model, const Vector& factors) {
  model.C = factors.asDiagonal() * model.C;
  model.D = factors.asDiagonal() * model.D;
  model.y0 = factors.asDiagonal() * model.y0;
  if (model.K.size() > 0) model.K *= factors.cwiseInverse().asDiagonal();
  return model;
}

/// What a model leaves, in deviations of the outputs: root mean square on rows held out, and
/// log_unforetold() on all.
struct Errors {
  double held_out;
  double log_unforetold;

  bool are_less_than(const Errors& other) const {
    constexpr double worthwhile = 0.2;  // a tenth less
    const double gain = other.log_unforetold - log_unforetold;
    return gain > worthwhile && gain > 2 * std::log(held_out / other.held_out);
  }
};

/// The rows of one identification, with outputs of deviation 1.
class DriftingRows {
 public:
  DriftingRows(const Record& record, RowRange rows, const IdentifyOptions& options)
      : options_(options),
        record_{record.period_s, record.u.middleRows(rows.begin, rows.size()),
                record.y.middleRows(rows.begin, rows.size()), segments_from(record, rows)},
        fitted_{0, rows.size() - options.tune_rows} {
    const Matrix moving = record_.y.rowwise() - record_.y.colwise().mean();
    deviations_ = moving.colwise().norm().transpose() / std::sqrt(double(rows.size()));
    deviations_ = (deviations_.array() > 0).select(deviations_, 1);
    record_.y *= deviations_.cwiseInverse().asDiagonal();
    folds_ = options.tune_rows == 0 ? folds_of(fitted_.size(), options.tune_share)
                                    : std::vector<Fold>{{fitted_, {fitted_.end, rows.size()}}};
  }

  /// Returns the model that takes the place of `with`, which may have followed drifts; absent
  /// where none does.
  std::optional<Identified> without_drift(const Identified& with,
                                          const Identification& identify_from) const {
    Matrix left = residuals(with_outputs_times(with.model, deviations_.cwiseInverse()));
    Errors least{*with.held_out_error, log_unforetold(left, ranges())};
    double work = with.search_work;
    std::optional<Identified> best;
    const int most =
        static_cast<int>(std::min<Index>(most_half_periods, fitted_.size() / rows_of_half_period));
    for (int half_periods = least_half_periods; half_periods <= most; half_periods *= 2) {
      const SlowPart slow(record_, half_periods);
      if (!(slow.shares(left).array() > most_of_it).any()) break;
      Record less = record_;
      less.u = slow.without(record_.u);
      less.y = slow.without(record_.y);
      IdentifyResult other = identify_from(less, less.all(), options_, nullptr);
      auto* found = std::get_if<Identified>(&other);
      if (!found) break;
      work += found->search_work;
      found->held_out_error = place(*found);
      left = residuals(found->model);
      const Errors errors{*found->held_out_error, log_unforetold(left, ranges())};
      if (!errors.are_less_than(least)) break;
      least = errors;
      found->recipe.drift_half_periods = half_periods;
      best = std::move(*found);
    }
    if (!best) return std::nullopt;
    best->search_work = work;
    best->warnings.push_back(sentence_on(*best));
    best->model = with_outputs_times(std::move(best->model), deviations_);
    if (best->gain_uncertainty)
      *best->gain_uncertainty = deviations_.asDiagonal() * *best->gain_uncertainty;
    return best;
  }

 private:
  std::vector<RowRange> ranges() const { return ranges_from(record_, record_.all()); }
  Matrix residuals(const StateSpaceModel& model) const {
    return record_.y - free_run(model, record_, record_.all());
  }

  /// Gives the model the operating point of the last half of the rows: what drifts is nearest to
  /// that. Returns what it errs on rows held out.
  double place(Identified& found) const {
    StateSpaceModel& model = found.model;
    const auto u = record_.u.middleRows(fitted_.begin, fitted_.size());
    const auto y = record_.y.middleRows(fitted_.begin, fitted_.size());
    model.u0 = u.colwise().mean().transpose();
    model.y0 = y.colwise().mean().transpose();
    found.input_min = u.colwise().minCoeff().transpose();
    found.input_max = u.colwise().maxCoeff().transpose();
    found.recipe.operating_point = OperatingPoint::recent;
    double error = 0;
    for (const Fold& fold : folds_)
      error += quick_held_out_errors(model, record_, fold).recent.rms / double(folds_.size());
    model.y0 += recent_operating_point(y - free_run(model, record_, fitted_), true);
    found.x0 =
        estimate_initial_state(model, record_, segments_within(record_, fitted_), state_rows);
    return error;
  }

  std::string sentence_on(const Identified& found) const {
    const int half_periods = found.recipe.drift_half_periods;
    const Vector shares = SlowPart(record_, half_periods).shares(residuals(found.model));
    std::string outputs;
    for (Index q = 0; q < shares.size(); ++q)
      if (shares(q) > most_of_it)
        outputs += (outputs.empty() ? "" : ", ") + channel_name("output", q, options_.output_names);
    const double ticks =
        double(record_.segments.back().end_tick() - record_.segments.front().first_tick);
    const double seconds = 2 * ticks * record_.period_s / half_periods;
    return (outputs.empty() ? "the outputs" : outputs) +
           " moved slowly by more than the model explains: it is identified from what moves faster "
           "than in " +
           four_digits(seconds) +
           " s, and its operating point is that of the last half of the rows; choose a longer "
           "window, or add the telemetry of what drives the drift";
  }

  const IdentifyOptions& options_;
  Record record_;  // the tuning rows are its last
  RowRange fitted_;
  Vector deviations_;  // p
  std::vector<Fold> folds_;
};

}  // namespace

IdentifyResult identify_despite_drift(const Record& record, RowRange rows,
                                      const IdentifyOptions& options, LagSums* kept,
                                      const Identification& identify_from) {
  IdentifyResult result = identify_from(record, rows, options, kept);
  auto* found = std::get_if<Identified>(&result);
  const bool was_chosen = found && !options.order && found->held_out_error.value_or(0) > no_error;
  if (was_chosen && record.u.cols() > 0)
    if (auto other = DriftingRows(record, rows, options).without_drift(*found, identify_from))
      *found = *std::move(other);
  return result;
}

}  // namespace reident::identification
