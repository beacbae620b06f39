#include "identification/screening/answers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/gram.hpp"
#include "identification/screening/order_statistics.hpp"

namespace reident::identification {
namespace {

// A row is predicted from so many rows, its own among those of the other channels. An excursion
// shows from two rows before it, in an input that it answers itself, to four behind. All of these
// are as far apart as an excursion lasts.
constexpr Index predicting_rows = 3;
constexpr Index rows_before = 2, rows_behind = 4;
constexpr std::size_t window_rows = 1 + rows_before + rows_behind;
constexpr Index most_fitted = 4000, most_elsewhere = 1000, least_elsewhere = 50;
constexpr double ridge = 1e-9;
constexpr std::size_t most_draws = 1000, least_draws = 200, most_drawn = 64'000;
constexpr double clearly = 1.5;
constexpr Index longest_lag = 60;       // rows of a dead time
constexpr double expected_share = 0.5;  // of an excursion's height
constexpr double surely = 6;            // standard errors

using Errors = std::array<double, window_rows>;

double squared(const Errors& errors) {
  double sum = 0;
  for (const double one : errors) sum += one * one;
  return sum;
}

void add(double factor, const Errors& errors, Errors& sum) {
  for (std::size_t i = 0; i < window_rows; ++i) sum[i] += factor * errors[i];
}

/// Predicts the rows of a channel by least squares of the rows without excursions.
class Predictions {
 public:
  /// Each channel stands for so many rows later as its lag says; that of `self` is 0.
  Predictions(const Witnesses& witnesses, const std::vector<Excursion>& excursions,
              const std::vector<Index>& lags);

  /// Whether there are rows to predict from and to compare with.
  bool are_possible() const {
    return fitted_ > 2 * weights_.size() && std::ssize(elsewhere_) >= least_elsewhere;
  }
  void predict(std::size_t channel);
  /// Whether the channel that is predicted surely depends on the one of the excursions: one that is
  /// quiet otherwise does not show what an excursion of it does.
  bool know_excursions() const { return know_excursions_; }
  /// Errors around an excursion, without it or with it; absent next to an end of the segment.
  std::optional<Errors> errors_around(const Plateau& excursion, bool without);
  /// How far the channel of the excursions is predicted to stand out as one does; 0 next to the
  /// begin of the segment. Requires that this channel is the one that is predicted.
  double expected_height(const Plateau& excursion);
  /// Errors in places that have no excursion nearby.
  std::vector<Errors> errors_elsewhere();

 private:
  struct Term {
    const double* values;
    double mean, factor;
    Index lag;
  };

  void sum_up(const std::vector<Excursion>& excursions);
  Errors errors_at(Index row);
  void describe(Index row, double* result) const;
  /// Rows before the one that they predict.
  Index rows_needed() const { return longest_lag_ + step_ * (predicting_rows - 1); }
  RowRange rows_around(Index row) const {
    return {row - step_ * rows_before - rows_needed(), row + step_ * rows_behind + 1};
  }

  const Channel& channel_;  // of the excursions
  std::size_t self_;
  Vector bridged_;
  std::vector<Term> terms_;
  Index longest_lag_ = 0, step_ = 1, fitted_ = 0;
  std::vector<Index> elsewhere_;
  Matrix gram_;
  Vector weights_, described_;
  bool know_excursions_ = false;
};

Predictions::Predictions(const Witnesses& witnesses, const std::vector<Excursion>& excursions,
                         const std::vector<Index>& lags)
    : channel_(witnesses.channels[witnesses.self]),
      self_(witnesses.self),
      bridged_(channel_.values),
      longest_lag_(*std::max_element(lags.begin(), lags.end())) {
  std::vector<double> sizes;
  for (const Excursion& one : excursions) {
    sizes.push_back(double(one.plateau.size()));
    bridge(bridged_, one.plateau);
  }
  step_ = static_cast<Index>(quantile(sizes, 0.5));
  for (const Channel& channel : witnesses.channels) {
    const Vector& values = terms_.size() == self_ ? bridged_ : channel.values;
    const double mean = values.mean(), square = (values.array() - mean).square().mean();
    terms_.push_back(
        {values.data(), mean, square > 0 ? 1 / std::sqrt(square) : 0, lags[terms_.size()]});
  }
  weights_.resize(predicting_rows * std::ssize(terms_) + 1);
  described_.resize(weights_.size());
  sum_up(excursions);
}

void Predictions::sum_up(const std::vector<Excursion>& excursions) {
  std::vector<Index> before(static_cast<std::size_t>(bridged_.size()) + 1);  // rows of excursions
  for (const Excursion& one : excursions)
    std::fill(before.begin() + one.plateau.begin + 1, before.begin() + one.plateau.end + 1, 1);
  for (std::size_t row = 1; row < before.size(); ++row) before[row] += before[row - 1];
  const auto is_clear = [&](const Segment& segment, RowRange rows) {
    return rows.begin >= segment.begin && rows.end <= segment.end &&
           before[static_cast<std::size_t>(rows.begin)] ==
               before[static_cast<std::size_t>(rows.end)];
  };
  const Index every = 1 + bridged_.size() / most_fitted;
  const Index every_elsewhere = 1 + bridged_.size() / most_elsewhere;
  std::vector<Index> fitted;
  for (const Segment& segment : *channel_.segments) {
    for (Index row = segment.begin; row < segment.end; row += every)
      if (row - rows_needed() >= segment.begin &&
          is_clear(segment, {row - step_ * (predicting_rows - 1), row + 1}))
        fitted.push_back(row);
    for (Index row = segment.begin; row < segment.end; row += every_elsewhere)
      if (is_clear(segment, rows_around(row))) elsewhere_.push_back(row);
  }
  fitted_ = std::ssize(fitted);
  Matrix described(weights_.size(), fitted_);
  for (Index i = 0; i < fitted_; ++i)
    describe(fitted[static_cast<std::size_t>(i)], described.col(i).data());
  gram_ = lower_gram(described).selfadjointView<Eigen::Lower>();
  gram_.diagonal().array() += ridge * double(fitted_);
}

void Predictions::predict(std::size_t channel) {
  const Index target = predicting_rows * static_cast<Index>(channel);
  std::vector<Index> others;
  for (Index i = 0; i < weights_.size(); ++i)
    if (i != target) others.push_back(i);
  const std::array<Index, 1> one{target};
  weights_(others) = -solve_ldlt_on_right(gram_(one, others), gram_(others, others)).row(0);
  weights_(target) = 1;
  // The coefficients of the channel of the excursions, and what these are uncertain by.
  Matrix units = Matrix::Zero(predicting_rows, std::ssize(others));
  const Index own = predicting_rows * static_cast<Index>(self_);
  units.middleCols(own - (own > target ? 1 : 0), predicting_rows).setIdentity();
  const Matrix inverse = solve_ldlt_on_right(units, gram_(others, others)) * units.transpose();
  const double variance = weights_.dot(gram_ * weights_) / double(fitted_);
  know_excursions_ = (weights_.segment(own, predicting_rows).array().square() >
                      std::pow(surely, 2) * variance * inverse.diagonal().array())
                         .any();
}

std::optional<Errors> Predictions::errors_around(const Plateau& excursion, bool without) {
  const RowRange around = rows_around(excursion.begin);
  const Segment& segment = (*channel_.segments)[excursion.segment];
  if (around.begin < segment.begin || around.end > segment.end) return std::nullopt;
  terms_[self_].values = without ? bridged_.data() : channel_.values.data();
  return errors_at(excursion.begin);
}

double Predictions::expected_height(const Plateau& excursion) {
  const Index row = excursion.begin;
  if (row - rows_needed() < (*channel_.segments)[excursion.segment].begin) return 0;
  terms_[self_].values = bridged_.data();
  describe(row, described_.data());
  return -weights_.dot(described_) / terms_[self_].factor;
}

std::vector<Errors> Predictions::errors_elsewhere() {
  terms_[self_].values = bridged_.data();
  std::vector<Errors> errors;
  errors.reserve(elsewhere_.size());
  for (const Index row : elsewhere_) errors.push_back(errors_at(row));
  return errors;
}

Errors Predictions::errors_at(Index row) {
  Errors errors;
  for (std::size_t i = 0; i < window_rows; ++i) {
    describe(row + step_ * (static_cast<Index>(i) - rows_before), described_.data());
    errors[i] = weights_.dot(described_);
  }
  return errors;
}

void Predictions::describe(Index row, double* result) const {
  for (const Term& one : terms_)
    for (Index back = 0; back < predicting_rows; ++back)
      *result++ = (one.values[row - one.lag - step_ * back] - one.mean) * one.factor;
  *result = 1;
}

/// After how many rows each channel is followed most by the one of the excursions, from row to row;
/// at most `longest_lag`.
std::vector<Index> lags_of(const Witnesses& witnesses, const Vector& bridged) {
  std::vector<Index> lags;
  const Index every = 1 + bridged.size() / most_fitted;
  for (const Channel& channel : witnesses.channels) {
    Index lag = 0;
    double most = 0;
    const bool is_self = lags.size() == witnesses.self;
    for (Index behind = 0; !is_self && behind <= longest_lag; ++behind) {
      double sum = 0;
      for (const Segment& segment : *channel.segments)
        for (Index row = segment.begin + longest_lag + 1; row < segment.end; row += every)
          sum += (bridged(row) - bridged(row - 1)) *
                 (channel.values(row - behind) - channel.values(row - behind - 1));
      if (std::abs(sum) > most) most = std::abs(sum), lag = behind;
    }
    lags.push_back(lag);
  }
  return lags;
}

/// The largest square of sums that are weighted by these heights, of errors in places at chance.
double largest_sum(const std::vector<double>& heights, const std::vector<Errors>& elsewhere) {
  std::minstd_rand random;
  double largest = 0;
  const std::size_t draws = std::clamp(most_drawn / (heights.size() + 1), least_draws, most_draws);
  for (std::size_t draw = 0; draw < draws; ++draw) {
    Errors sum{};
    for (const double height : heights) add(height, elsewhere[random() % elsewhere.size()], sum);
    largest = std::max(largest, squared(sum));
  }
  return largest;
}

}  // namespace

std::vector<Excursion> unanswered(const Witnesses& witnesses, std::vector<Excursion> excursions) {
  if (excursions.empty()) return excursions;
  Predictions predictions(witnesses, excursions, std::vector<Index>(witnesses.channels.size(), 0));
  if (!predictions.are_possible()) return excursions;
  for (std::size_t c = 0; c < witnesses.channels.size(); ++c) {
    if (c == witnesses.self || !(witnesses.channels[c].range() > 0)) continue;
    predictions.predict(c);
    const std::vector<Errors> elsewhere = predictions.errors_elsewhere();
    double largest = 0;
    for (const Errors& errors : elsewhere) largest = std::max(largest, squared(errors));
    std::vector<double> heights;
    Errors sum{}, sum_with{};
    std::erase_if(excursions, [&](const Excursion& one) {
      if (!witnesses.saw(c, one.plateau)) return false;
      const auto errors = predictions.errors_around(one.plateau, true);
      if (!errors) return false;
      // With the excursion it has to err less, or else a fault nearby may be what makes it err.
      const auto with = predictions.errors_around(one.plateau, false);
      if (squared(*errors) > clearly * std::max(largest, squared(*with))) return true;
      add(one.height, *errors, sum);
      add(one.height, *with, sum_with);
      heights.push_back(one.height);
      return false;
    });
    const bool errs_more_with =
        predictions.know_excursions() && squared(sum_with) > clearly * squared(sum);
    if (squared(sum) > clearly * largest_sum(heights, elsewhere) && !errs_more_with)
      std::erase_if(excursions,
                    [&](const Excursion& one) { return witnesses.saw(c, one.plateau); });
  }
  return excursions;
}

std::vector<Excursion> unexpected(const Witnesses& witnesses, std::vector<Excursion> excursions) {
  if (excursions.empty()) return excursions;
  Vector bridged = witnesses.channels[witnesses.self].values;
  for (const Excursion& one : excursions) bridge(bridged, one.plateau);
  Predictions predictions(witnesses, excursions, lags_of(witnesses, bridged));
  if (!predictions.are_possible()) return excursions;
  predictions.predict(witnesses.self);
  std::erase_if(excursions, [&](const Excursion& one) {
    const double share = predictions.expected_height(one.plateau) / one.height;
    return share > expected_share && share < 1 / expected_share;
  });
  return excursions;
}

}  // namespace reident::identification
