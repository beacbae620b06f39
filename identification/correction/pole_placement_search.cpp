#include "identification/correction/pole_placement_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>
#include <vector>

#include "identification/numerics/decompositions.hpp"
#include "identification/simulation/free_run.hpp"

namespace reident::identification {
namespace {

constexpr double gone_at_once = 1e-8;
constexpr Index most_rows = 20000;  // of either part
constexpr int scales_per_decade = 20;
constexpr int coarse_step = 4;  // of scales

StateSpaceModel with_feedback(const StateSpaceModel& model, const Matrix& F) {
  StateSpaceModel result = model;
  result.A -= model.B * F;
  result.C -= model.D * F;
  result.K.resize(0, 0);
  return result;
}

/// N with the least change S^-1 (N - I) for which `fed_back` N has the static gain `wanted`.
std::optional<Matrix> input_gain(const Matrix& wanted, const StateSpaceModel& fed_back,
                                 const Vector& S) {
  const std::optional<Matrix> gain = static_gain(fed_back);
  if (!gain) return std::nullopt;
  const Matrix change =
      S.asDiagonal() * solve_least_norm(*gain * S.asDiagonal(), Matrix(wanted - *gain));
  if ((*gain * change - (wanted - *gain)).norm() > 1e-8 * wanted.norm()) return std::nullopt;
  return Matrix::Identity(S.size(), S.size()) + change;
}

class Search {
 public:
  Search(const StateSpaceModel& model, const Record& record, RowRange identify, RowRange tune)
      : model_(model),
        record_(record),
        identify_{std::max(identify.begin, identify.end - most_rows), identify.end},
        tune_{tune.begin, std::min(tune.end, tune.begin + most_rows)},
        poles_(poles_of(model.A)),
        static_gain_(static_gain(model)) {
    const auto u = record.u.middleRows(identify_.begin, identify_.size());
    deviations_ = ((u.rowwise() - u.colwise().mean()).colwise().norm()).transpose() /
                  std::sqrt(double(identify_.size()));
    const Matrix y_hat = run(model);
    mean_residual_ = mean_residual(y_hat);
    plain_ = score(y_hat);
  }

  CorrectionSearch result(const ForEach& for_each) {
    CorrectionSearch search{plain_, {}};
    if (model_.order() == 0 || model_.inputs() == 0) return search;
    std::vector<int> coarse, fine;
    for (int step = -scales_per_decade; step <= scales_per_decade; step += coarse_step)
      coarse.push_back(step);
    const int best = try_scales(coarse, for_each, search.best);
    if (!search.best) return search;
    for (int step = best - coarse_step + 1; step < best + coarse_step; ++step)
      if (step != best && std::abs(step) <= scales_per_decade) fine.push_back(step);
    try_scales(fine, for_each, search.best);
    search.best->error = score(run(search.best->model));  // its initial state follows y0
    if (!(search.best->error.mrse() < worthwhile * plain_.mrse())) search.best.reset();
    return search;
  }

 private:
  /// Takes the best of the scales 10^(step / scales_per_decade) where it is better than `best`. Its
  /// step, if any.
  int try_scales(const std::vector<int>& steps, const ForEach& for_each,
                 std::optional<Correction>& best) const {
    std::vector<std::optional<Correction>> of_steps(steps.size());
    for_each(steps.size(), [&](std::size_t i) {
      try_scale(std::pow(10, double(steps[i]) / scales_per_decade), of_steps[i]);
    });
    int taken = 0;
    for (std::size_t i = 0; i < steps.size(); ++i)
      if (of_steps[i] && (!best || of_steps[i]->error.mrse() < best->error.mrse())) {
        best = std::move(of_steps[i]);
        taken = steps[i];
      }
    return taken;
  }

  void try_scale(double scale, std::optional<Correction>& best) const;

  /// Keeps the operating point and takes the correction where it is the best so far.
  void consider(Correction correction, std::optional<Correction>& best) const {
    correction.model.y0 = model_.y0;
    Matrix y_hat = run(correction.model);
    const Vector shift = mean_residual(y_hat) - mean_residual_;
    correction.model.y0 += shift;
    y_hat.rowwise() += shift.transpose();
    correction.error = score(y_hat);
    const double error = correction.error.mrse();
    if (std::isfinite(error) && (!best || error < best->error.mrse())) best = std::move(correction);
  }

  Matrix run(const StateSpaceModel& model) const {
    return free_run(model, record_, {identify_.begin, tune_.end});
  }

  Vector mean_residual(const Matrix& y_hat) const {
    return (record_.y.middleRows(identify_.begin, identify_.size()) -
            y_hat.topRows(identify_.size()))
        .colwise()
        .mean()
        .transpose();
  }

  Score score(const Matrix& y_hat) const {
    return identification::score(record_.y.middleRows(tune_.begin, tune_.size()),
                                 y_hat.bottomRows(tune_.size()));
  }

  const StateSpaceModel& model_;
  const Record& record_;
  RowRange identify_, tune_;
  Poles poles_;
  std::optional<Matrix> static_gain_;
  Vector deviations_, mean_residual_;
  Score plain_;
};

void Search::try_scale(double scale, std::optional<Correction>& best) const {
  auto placed = place_poles(model_.A, model_.B, scaled_poles(poles_, scale));
  auto* placement = std::get_if<PolePlacement>(&placed);
  if (!placement) return;
  const StateSpaceModel fed_back = with_feedback(model_, placement->gain);
  if (!is_stable(fed_back.A)) return;
  Correction correction;
  correction.model = fed_back;
  correction.scale = scale;
  correction.gain = placement->gain;
  correction.input_gain.setIdentity(model_.inputs(), model_.inputs());
  correction.uncontrollable = placement->uncontrollable;
  consider(correction, best);
  const std::optional<Matrix> N =
      static_gain_ ? input_gain(*static_gain_, fed_back, deviations_) : std::nullopt;
  if (!N) return;
  correction.keeps_static_gain = true;
  correction.input_gain = *N;
  correction.model.B = model_.B * *N;
  correction.model.D = model_.D * *N;
  consider(correction, best);
}

}  // namespace

std::complex<double> scaled_pole(std::complex<double> pole, double scale) {
  const double modulus = std::abs(pole);
  if (modulus < gone_at_once) return pole;
  const double scaled = std::pow(modulus, scale);
  if (pole.imag() == 0) return std::copysign(scaled, pole.real());
  const double angle = std::arg(pole), turned = scale * angle;
  return std::polar(scaled, std::abs(turned) < std::numbers::pi ? turned : angle);
}

Poles scaled_poles(const Poles& poles, double scale) {
  Poles scaled;
  for (const auto& pole : poles) scaled.push_back(scaled_pole(pole, scale));
  return scaled;
}

CorrectionSearch search_correction(const StateSpaceModel& model, const Record& record,
                                   RowRange identify, RowRange tune, const ForEach& for_each) {
  assert(is_well_formed(model) && is_stable(model.A));
  assert(0 <= identify.begin && identify.begin < identify.end);
  assert(identify.end <= tune.begin && tune.begin < tune.end && tune.end <= record.rows());
  return Search(model, record, identify, tune).result(for_each);
}

}  // namespace reident::identification
