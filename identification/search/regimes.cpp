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

IdentifyResult identify_from_inputs(const Record& record, const IdentifyOptions& options,
                                    const Places& places, LagSums* kept,
                                    const Identification& identify_from) {
  const bool is_all = std::ssize(places) == record.u.cols();
  Record narrow = record;
  narrow.u = record.u(Eigen::all, places);
  IdentifyOptions own = options;
  own.regime_inputs = 0;
  own.input_names = selected(options.input_names, places);
  own.input_delays = selected(options.input_delays, places);
  return identify_from(narrow, own, is_all ? kept : nullptr);
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
  Vector u0 = u.colwise().mean();
  u0(places) = model.u0;
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
  constexpr double worthwhile = 0.99;
  const Index m = record.u.cols() - options.regime_inputs;
  assert(m > 0);
  const Places plain = first_places(m), wide = independent_inputs(record, rows, m);
  IdentifyResult without = identify_from_inputs(record, options, plain, nullptr, identify_from);
  auto* base = std::get_if<Identified>(&without);
  RegimeChoice choice;
  if (base) choice.error_without = base->held_out_error;
  if (wide.size() > plain.size()) {
    IdentifyResult with = identify_from_inputs(record, options, wide, kept, identify_from);
    auto* rich = std::get_if<Identified>(&with);
    if (rich) choice.error_with = rich->held_out_error;
    const bool is_better = rich && (!base || !choice.error_with || !choice.error_without ||
                                    *choice.error_with < worthwhile * *choice.error_without);
    if (rich && base) rich->search_work += base->search_work;
    if (is_better) {
      choice.are_used = true;
      rich->regimes = choice;
      widen(*rich, wide, record, rows);
      return with;
    }
    if (rich) base->search_work = rich->search_work;
  }
  if (!base) return without;
  base->regimes = choice;
  widen(*base, plain, record, rows);
  return without;
}

}  // namespace reident::identification
