#include "identification/search/regimes.hpp"

#include <cassert>
#include <numeric>
#include <vector>

#include "identification/numerics/decompositions.hpp"

namespace reident::identification {
namespace {

using Places = std::vector<Index>;

Places first_places(Index count) {
  Places places(static_cast<std::size_t>(count));
  std::iota(places.begin(), places.end(), Index{0});
  return places;
}

/// The first `m` inputs, and those behind them that are no constant and do not follow from others:
/// a regime that the rows do not meet, or an input that does not move in it.
Places independent_inputs(const Record& record, RowRange rows, Index m) {
  constexpr double least_share = 1e-6;  // of a column's variance
  Places places = first_places(m);
  Matrix u = record.u.middleRows(rows.begin, rows.size());
  u.rowwise() -= Eigen::RowVectorXd(u.colwise().mean());
  for (Index i = m; i < u.cols(); ++i) {
    const Vector column = u.col(i);
    const Matrix others = u(Eigen::all, places);
    const Vector products = others.transpose() * column;
    const Vector rest = column - others * solve_least_norm(others.transpose() * others, products);
    if (rest.squaredNorm() > least_share * column.squaredNorm()) places.push_back(i);
  }
  return places;
}

template <typename T>
std::vector<T> selected(const std::vector<T>& all, const Places& places) {
  std::vector<T> chosen;
  for (const Index place : places)
    if (static_cast<std::size_t>(place) < all.size())
      chosen.push_back(all[static_cast<std::size_t>(place)]);
  return chosen;
}

IdentifyResult identify_from_inputs(const Record& record, RowRange rows,
                                    const IdentifyOptions& options, const Places& places,
                                    LagSums* kept, const Identification& identify_from) {
  const bool is_all = std::ssize(places) == record.u.cols();
  Record narrow = record;
  narrow.u = record.u(Eigen::all, places);
  IdentifyOptions own = options;
  own.regime_inputs = 0;
  own.input_names = selected(options.input_names, places);
  own.input_delays = selected(options.input_delays, places);
  return identify_from(narrow, rows, own, is_all ? kept : nullptr);
}

/// A model with the inputs of the record, of which it has those at `places`.
void widen(Identified& identified, const Places& places, const Record& record, RowRange rows) {
  const auto widened = [&](const Matrix& narrow) {
    Matrix wide = Matrix::Zero(narrow.rows(), record.u.cols());
    wide(Eigen::all, places) = narrow;
    return wide;
  };
  StateSpaceModel& model = identified.model;
  const auto u = record.u.middleRows(rows.begin, rows.size());
  model.B = widened(model.B);
  model.D = widened(model.D);
  if (identified.gain_uncertainty)
    identified.gain_uncertainty = widened(*identified.gain_uncertainty);
  Vector u0 = u.colwise().mean();
  for (std::size_t i = 0; i < places.size(); ++i) u0(places[i]) = model.u0(Index(i));
  model.u0 = u0;
  identified.input_min = u.colwise().minCoeff();
  identified.input_max = u.colwise().maxCoeff();
  if (!identified.input_delays.empty()) {
    std::vector<int> delays(static_cast<std::size_t>(record.u.cols()), 0);
    for (std::size_t i = 0; i < places.size(); ++i)
      delays[static_cast<std::size_t>(places[i])] = identified.input_delays[i];
    identified.input_delays = std::move(delays);
  }
}

}  // namespace

IdentifyResult identify_with_regimes(const Record& record, RowRange rows,
                                     const IdentifyOptions& options, LagSums* kept,
                                     const Identification& identify_from) {
  constexpr double worthwhile = 0.95;
  const Index m = record.u.cols() - options.regime_inputs;
  assert(m > 0);
  const Places plain = first_places(m), wide = independent_inputs(record, rows, m);
  RegimeChoice choice;
  double work = 0;
  const auto with = [&](const Places& places, const IdentifyOptions& own) {
    return identify_from_inputs(record, rows, own, places, kept, identify_from);
  };
  const auto error_of = [&work](const IdentifyResult& result) -> std::optional<double> {
    const auto* found = std::get_if<Identified>(&result);
    if (found) work += found->search_work;
    return found ? found->held_out_error : std::nullopt;
  };
  // Rows for choices alone may all be of one regime: folds are of all rows.
  IdentifyOptions in_folds = options;
  in_folds.tune_rows = 0;
  std::optional<IdentifyResult> result;
  if (wide.size() > plain.size()) {
    IdentifyResult rich = with(wide, in_folds), poor = with(plain, in_folds);
    choice.error_with = error_of(rich);
    choice.error_without = error_of(poor);
    choice.are_used =
        std::holds_alternative<Identified>(rich) &&
        (std::holds_alternative<Verdict>(poor) || !choice.error_with || !choice.error_without ||
         *choice.error_with < worthwhile * *choice.error_without);
    if (options.tune_rows == 0) {  // these are the models
      IdentifyResult& chosen = choice.are_used ? rich : poor;
      if (const auto* found = std::get_if<Identified>(&chosen)) work -= found->search_work;
      result = std::move(chosen);
    }
  }
  const Places& places = choice.are_used ? wide : plain;
  if (!result) result = with(places, options);
  if (auto* found = std::get_if<Identified>(&*result)) {
    found->regimes = choice;
    found->search_work += work;
    widen(*found, places, record, rows);
  }
  return *std::move(result);
}

}  // namespace reident::identification
