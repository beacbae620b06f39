#include "identification/search/delay_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "identification/fit/output_error_fit.hpp"
#include "identification/numerics/decompositions.hpp"
#include "identification/search/delays.hpp"
#include "identification/search/folds.hpp"
#include "identification/search/mode_elimination.hpp"
#include "identification/search/model_search.hpp"
#include "identification/search/parsimony.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/statistics/correlation.hpp"
#include "identification/statistics/quantiles.hpp"

namespace reident::identification {
namespace {

using Delays = std::vector<int>;

constexpr Index most_scanned = 1500, most_fitted = 4096, least_rows = 300;  // looked at
constexpr int steps = 10, last_steps = 5;                                   // of a refinement
constexpr double share_of_budget = 1.0 / 6;
/// Twice the logarithm of the odds against a delay before the rows have been looked at.
constexpr double odds_against = 10;

/// The channels, each less its mean and over its deviation.
Record standardised(Record record) {
  for (Matrix* channels : {&record.u, &record.y}) {
    channels->rowwise() -= Eigen::RowVectorXd(channels->colwise().mean());
    for (Index c = 0; c < channels->cols(); ++c)
      if (const double norm = channels->col(c).norm(); norm > 0)
        channels->col(c) *= std::sqrt(double(record.rows())) / norm;
  }
  return record;
}

/// What one state makes of an input that was at rest before.
Vector one_state_response(const Vector& u, double pole) {
  Vector x(u.size());
  x(0) = u(0);
  for (Index t = 1; t < u.size(); ++t) x(t) = pole * x(t - 1) + (1 - pole) * u(t - 1);
  return x;
}

/// 1, pole, pole^2, ...: what an initial state leaves.
Vector decay(Index rows, double pole) {
  Vector x(rows);
  x(0) = 1;
  for (Index t = 1; t < rows; ++t) x(t) = pole * x(t - 1);
  return x;
}

/// The delays with which one state for each input explains most of the outputs of a record without
/// holes, each input in turn beside the others. They are too long where the equipment has more
/// states.
Delays delays_of_one_state(const Record& record, int most) {
  const Matrix& u = record.u;
  const Index m = u.cols(), rows = record.rows() - most;
  const Matrix y = record.y.bottomRows(rows);
  Matrix responses = Matrix::Zero(rows, m);
  Delays delays(static_cast<std::size_t>(m), 0);
  const auto take_best = [&](Index input) {
    double least_left = std::numeric_limits<double>::infinity();
    for (double time_constant = 1; 2 * time_constant < double(rows); time_constant *= 2) {
      const double pole = 1 - 1 / time_constant;
      Matrix beside(rows, 1 + m);
      beside << Vector::Ones(rows), responses;
      beside.col(1 + input) = decay(rows, pole);
      const Matrix basis = orthonormal_basis(beside);
      const Matrix others_left = y - basis * (basis.transpose() * y);
      const Vector response = one_state_response(u.col(input), pole);
      for (int delay = 0; delay <= most; ++delay) {
        const auto delayed_response = response.segment(most - delay, rows);
        const double square = delayed_response.squaredNorm();
        const double own = square - (basis.transpose() * delayed_response).squaredNorm();
        if (!(own > 1e-6 * square)) continue;
        const double left = others_left.squaredNorm() -
                            (others_left.transpose() * delayed_response).squaredNorm() / own;
        if (!(left < least_left)) continue;
        least_left = left;
        responses.col(input) = delayed_response;
        delays[static_cast<std::size_t>(input)] = delay;
      }
    }
  };
  for (int pass = 0; pass < (m > 1 ? 2 : 1); ++pass)
    for (Index input = 0; input < m; ++input) take_best(input);
  return delays;
}

/// The rows, standardised, with whatever delays of at most `most`: of each run of segments without
/// so many.
struct Rows {
  const Record& record;
  RowRange range;
  int most;

  Record with(const Delays& delays) const {
    return standardised(delayed(record, range, delays, most));
  }
};

/// A fit to the rows with these delays; D is zero but in a static gain, and where a model without
/// delays has it.
struct DelayedFit {
  Delays delays;
  Response fit;
  bool direct = false;

  Index used() const {
    return std::count_if(delays.begin(), delays.end(), [](int delay) { return delay > 0; });
  }
  Index states() const { return fit.model.order() + used(); }
  /// Those of the model, and the delays.
  Index parameters() const {
    const StateSpaceModel& model = fit.model;
    return parameters_of(model.order(), model.inputs(), model.outputs(), direct, 1) + used();
  }
};

/// Looks for the delays with which models of one order err least on the rows they are fitted to.
class Descent {
 public:
  Descent(const Rows& rows, int order, const Delays& start) : rows_(rows), order_(order) {
    improves(Delays(start.size(), 0));
    improves(start);
    // Where an input has a rhythm, a shift by half of it looks like a delay, too.
    for (std::size_t i = 0; i < start.size(); ++i) improves(with(i, 0));
    for (int step = std::max(1, rows.most / 8); step >= 1; step /= 2)
      for (std::size_t i = 0; i < start.size(); ++i)
        for (const int move : {-step, step})
          while (improves(with(i, best_.delays[i] + move))) {
          }
  }

  /// Return the fit with these delays, and the one without any.
  const DelayedFit& best() const { return best_; }
  const DelayedFit& undelayed() const { return undelayed_; }

 private:
  Delays with(std::size_t input, int delay) const {
    Delays delays = best_.delays;
    delays[input] = delay;
    return delays;
  }

  /// Fits from two starts, of which one is the best fit so far. Takes a fit that is better.
  bool improves(const Delays& delays) {
    const bool is_first = best_.delays.empty();
    const auto [least, longest] = std::minmax_element(delays.begin(), delays.end());
    if (*least < 0 || *longest > rows_.most || delays == best_.delays) return false;
    const Record record = rows_.with(delays);
    const Index p = record.y.cols();
    const auto fit = [&](const Matrix& A, const Matrix& C) {
      return order_ == 0 ? fit_response(A, C, true, record, record.all(), Accuracy::fast)
                         : refine_response(A, C, false, record, record.all(), steps);
    };
    const Matrix start = Vector::LinSpaced(order_, 0.95, order_ == 1 ? 0.95 : 0.3).asDiagonal();
    Response found = fit(start, Matrix::Ones(p, order_));
    if (!is_first && order_ > 0)
      if (Response other = fit(best_.fit.model.A, best_.fit.model.C); other.error < found.error)
        found = std::move(other);
    DelayedFit delayed_fit{delays, std::move(found), order_ == 0};
    const auto is_better_than = [&](const DelayedFit& other) {
      return is_first || delayed_fit.fit.error < other.fit.error;
    };
    if (delayed_fit.used() == 0 && is_better_than(undelayed_)) undelayed_ = delayed_fit;
    if (!is_better_than(best_)) return false;
    best_ = std::move(delayed_fit);
    return true;
  }

  const Rows& rows_;
  int order_;
  DelayedFit best_, undelayed_;
};

/// A model fitted again to the rows, its modes and delays as they are.
DelayedFit fitted_again(const Identified& identified, const Rows& rows) {
  Delays delays = identified.input_delays;
  const StateSpaceModel model = without_delay_states(identified.model, delays);
  delays.resize(static_cast<std::size_t>(model.inputs()), 0);
  const Record in_units = delayed(rows.record, rows.range, delays, rows.most);
  Vector deviations = (in_units.y.rowwise() - in_units.y.colwise().mean()).colwise().norm();
  deviations = (deviations.array() > 0).select(deviations, 1);
  const Matrix C = deviations.cwiseInverse().asDiagonal() * model.C;
  const Record record = standardised(in_units);
  const bool direct = identified.recipe.direct;
  return {delays, fit_response(model.A, C, direct, record, record.all(), Accuracy::fast), direct};
}

/// The fit with D.
DelayedFit with_direct(const DelayedFit& fit, const Rows& rows) {
  const Record record = rows.with(fit.delays);
  const auto& [A, C] = std::tie(fit.fit.model.A, fit.fit.model.C);
  return {fit.delays, refine_response(A, C, true, record, record.all(), steps), true};
}

/// Fits with one mode less, which is near 0, and delays that are longer by a row in its place.
void add_delays_for_poles(std::vector<DelayedFit>& fits, const Rows& rows) {
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const Dynamics dynamics{fits[i].fit.model.A, fits[i].fit.model.C};
    const Index order = dynamics.A.rows();
    if (order == 0 || eigenvalues(dynamics.A).cwiseAbs().minCoeff() > pole_near_zero) continue;
    for (const Delays& delays : longer_by_a_row(fits[i].delays)) {
      const bool is_known = std::any_of(fits.begin(), fits.end(), [&](const DelayedFit& one) {
        return one.delays == delays && one.fit.model.order() == order - 1;
      });
      if (is_known || *std::max_element(delays.begin(), delays.end()) > rows.most) continue;
      const Record record = rows.with(delays);
      const auto fewer = fewer_modes(dynamics, order == 1, record, record.all(), order - 1);
      if (fewer.empty()) continue;
      const auto& [A, C] = fewer.front().dynamics;
      fits.push_back({delays,
                      order == 1 ? fit_response(A, C, true, record, record.all(), Accuracy::fast)
                                 : refine_response(A, C, false, record, record.all(), steps),
                      order == 1});
    }
  }
}

/// What the fits leave of the outputs: log S, S the sum of squares of the errors, which are made
/// white as those of the closest fit are.
std::vector<double> log_squares(const std::vector<DelayedFit>& fits, const Rows& rows) {
  constexpr double rounding = 1e-6;
  const DelayedFit& closest = *std::min_element(
      fits.begin(), fits.end(),
      [](const DelayedFit& a, const DelayedFit& b) { return a.fit.error < b.fit.error; });
  const Record of_closest = rows.with(closest.delays);
  const auto colours = colours_of(closest.fit, of_closest, of_closest.all());
  std::vector<double> result;
  for (const DelayedFit& one : fits) {
    const Record record = rows.with(one.delays);
    const int most = one.fit.model.order() == 0 ? 0 : last_steps;
    const double error =
        refine_whitened(one.fit, one.direct, record, record.all(), most, colours).error;
    result.push_back(2 * std::log(std::isfinite(error) ? error + rounding : 1 / rounding));
  }
  return result;
}

/// The fit with the fewest parameters that the likelihood ratio does not refute against one with
/// more, and the best of as many.
const DelayedFit& simplest(const std::vector<DelayedFit>& fits, const Rows& rows) {
  const double values = double(rows.with(fits.front().delays).y.size());
  std::vector<double> left = log_squares(fits, rows);
  for (std::size_t i = 0; i < fits.size(); ++i)
    left[i] += odds_against * double(fits[i].used()) / values;
  std::vector<std::size_t> places(fits.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  std::sort(places.begin(), places.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(fits[a].parameters(), left[a]) < std::tuple(fits[b].parameters(), left[b]);
  });
  const auto is_refuted = [&](std::size_t simple, std::size_t rich) {
    const Index extra = fits[rich].parameters() - fits[simple].parameters();
    const double freedom = values - double(fits[rich].parameters());
    return extra > 0 &&
           freedom * (left[simple] - left[rich]) > chi_squared_quantile(0.9999, double(extra));
  };
  return fits[*std::find_if(places.begin(), places.end(), [&](std::size_t simple) {
    return std::none_of(places.begin(), places.end(),
                        [&](std::size_t rich) { return is_refuted(simple, rich); });
  })];
}

/// Rows of the first look that the budget, in multiply-adds, lasts for.
Index affordable_scan(int most, Index m, Index p, double budget) {
  constexpr double passes = 2, time_constants = 11;
  const double of_row = passes * time_constants * double(m * (most + 1) * (m + p + 2));
  return std::min(most_scanned, static_cast<Index>(budget / of_row));
}

/// The delays of one state for each input, of the last ticks that the budget lasts for.
Delays first_look(const Record& record, const std::vector<Segment>& run, int most, double budget) {
  const Index count = affordable_scan(most, record.u.cols(), record.y.cols(), budget) + most;
  return delays_of_one_state(last_ticks(record, run, count), most);
}

/// Rows that the budget lasts for with descents of these orders.
Index rows_for(const std::vector<int>& orders, Index m, Index p, double budget) {
  const double usual_fits = double(2 + 9 * m);
  double of_row = 0;
  for (const int order : orders) {
    Recipe recipe;
    recipe.order = order;
    recipe.refinement_steps = order == 0 ? 0 : 4;  // usual ones
    of_row += usual_fits * work_of_regression(recipe, m, p);
  }
  return static_cast<Index>(budget / of_row);
}

/// Orders of descents, ascending: those that the budget lasts for.
std::vector<int> affordable_orders(Index m, Index p, const IdentifyOptions& options,
                                   double budget) {
  if (options.order) return {*options.order};
  std::vector<int> orders;
  for (const int order : {0, 1, 2, 3, 4}) {
    if (order == 0 && !options.direct_feedthrough.value_or(true)) continue;
    if (order > options.max_order) break;
    orders.push_back(order);
    if (rows_for(orders, m, p, budget) >= least_rows) continue;
    orders.pop_back();
    break;
  }
  return orders;
}

/// The errors on each fold of the rows, the modes and delays as they are.
std::vector<HeldOutError> held_out(const DelayedFit& fit, OperatingPoint point,
                                   const std::vector<Fold>& folds, const Rows& rows) {
  const Record record = rows.with(fit.delays);
  std::vector<HeldOutError> result;
  for (const Fold& fold : folds) {
    const Response of_fold = fit_response(fit.fit.model.A, fit.fit.model.C, fit.direct, record,
                                          fold.fit, Accuracy::fast);
    const HeldOutErrors errors = held_out_errors(of_fold, record, fold);
    result.push_back(point == OperatingPoint::recent ? errors.recent : errors.whole);
  }
  return result;
}

/// The rows that count as one in the errors of a fit.
double rows_as_one(const DelayedFit& fit, const Rows& rows) {
  const Record record = rows.with(fit.delays);
  const Matrix y_hat = free_run(fit.fit.model, record, record.all(), fit.fit.x0);
  return most_correlated_rows(record.y - y_hat, ranges_from(record, record.all()));
}

}  // namespace

std::vector<std::vector<int>> longer_by_a_row(const std::vector<int>& delays) {
  std::vector<Delays> longer;
  for (std::size_t input = 0; input < delays.size(); ++input) {
    longer.push_back(delays);
    ++longer.back()[input];
  }
  if (delays.size() > 1) {
    longer.push_back(delays);
    for (int& delay : longer.back()) ++delay;
  }
  return longer;
}

std::vector<int> delays_shown(const Record& record, RowRange rows, DelayRange range,
                              const Identified* without, const IdentifyOptions& options) {
  const Index m = record.u.cols(), p = record.y.cols();
  const Delays none(static_cast<std::size_t>(m), 0);
  const double budget = share_of_budget * options.search_budget;
  const Index end = rows.end - options.tune_rows;
  const std::vector<Segment> run =
      longest_run(record, {std::max(rows.begin, end - most_fitted), end});
  if (run.empty()) return none;
  const auto ticks = run.back().end_tick() - run.front().first_tick;
  const int limit = static_cast<int>(std::min<std::int64_t>(range.limit, ticks / 3));
  int most = std::min(range.most, limit);
  Delays start = first_look(record, run, most, budget);
  // The best of a range that lies at its end is not the best there is.
  while (most < limit && std::ranges::find(start, most) != start.end()) {
    most = std::min(2 * most, limit);
    start = first_look(record, run, most, budget);
  }
  if (start == none) return none;

  const std::vector<int> orders = affordable_orders(m, p, options, budget);
  if (orders.empty()) return none;
  const Index count = std::clamp(rows_for(orders, m, p, budget), least_rows, most_fitted);
  const Index last = run.back().end;
  const RowRange around{std::max(rows.begin, last - count - most), last};
  const Rows fitted{record, around, most};
  std::vector<DelayedFit> fits;
  for (const int order : orders) {
    const Descent descent(fitted, order, start);
    fits.push_back(descent.undelayed());
    if (descent.best().used() == 0) continue;
    fits.push_back(descent.best());
    if (order > 0 && options.direct_feedthrough.value_or(true))
      fits.push_back(with_direct(descent.best(), fitted));
  }
  if (without) fits.push_back(fitted_again(*without, fitted));
  add_delays_for_poles(fits, fitted);
  return simplest(fits, fitted).delays;
}

bool held_out_rows_agree(const Identified& with, const Identified& without, const Record& record,
                         RowRange rows, const IdentifyOptions& options) {
  constexpr double fits_of_a_row = 8;
  Recipe larger;
  larger.order = std::max(with.recipe.order, without.recipe.order);
  const Index affordable = affordable_rows(larger, record.u.cols(), record.y.cols(),
                                           share_of_budget * options.search_budget / fits_of_a_row);
  rows.end -= options.tune_rows;
  rows.begin = std::max(rows.begin, rows.end - affordable);
  const int longest = *std::max_element(with.input_delays.begin(), with.input_delays.end());
  const Rows shared{record, rows, longest};
  const Index count = delayed(record, rows, with.input_delays, longest).rows();
  if (count < 3) return false;
  const DelayedFit delayed = fitted_again(with, shared), plain = fitted_again(without, shared);
  const bool is_simpler = delayed.states() <= plain.states();
  const DelayedFit &simple = is_simpler ? delayed : plain, &rich = is_simpler ? plain : delayed;
  const std::vector<Fold> folds = folds_of(count, options.tune_share);
  const OperatingPoint point = without.recipe.operating_point;
  const double together = rows_as_one(rich, shared);
  const bool rich_errs_less = errs_more(
      held_out(simple, point, folds, shared), held_out(rich, point, folds, shared),
      std::max<Index>(1, rich.parameters() - simple.parameters()),
      double(folds.front().fit.size()) / together, double(folds.front().tune.size()) / together);
  return is_simpler != rich_errs_less;
}

}  // namespace reident::identification
