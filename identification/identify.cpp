#include "identification/identify.hpp"

#include <algorithm>
#include <cmath>

#include "identification/choice.hpp"
#include "identification/hankel.hpp"
#include "identification/normalise.hpp"
#include "identification/response.hpp"
#include "identification/subspace.hpp"

namespace reident::identification {
namespace {

constexpr int default_horizons[] = {6, 10, 15, 20, 30};

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

/// Where the first non-finite value stands, if there is one.
std::optional<Verdict> non_finite_values(const Record& record, RowRange rows) {
  const auto look = [rows](const Matrix& channels, const char* kind) -> std::optional<Verdict> {
    for (Index c = 0; c < channels.cols(); ++c)
      for (Index r = rows.begin; r < rows.end; ++r)
        if (!std::isfinite(channels(r, c)))
          return Verdict{VerdictCode::non_finite, std::string(kind) + " " + std::to_string(c + 1) +
                                                      " is not finite in row " + std::to_string(r) +
                                                      "; mark such samples as invalid"};
    return std::nullopt;
  };
  if (auto verdict = look(record.u, "input")) return verdict;
  return look(record.y, "output");
}

/// Columns of H that determine its factor with some margin.
bool enough(const std::vector<Segment>& segments, Index block_rows, Index width) {
  return hankel_columns(segments, block_rows) >= 1 + block_rows * width;
}

/// Horizons that the segments can feed, ascending; the preferred ones that leave at least half of
/// the columns that the shortest one has.
std::vector<int> feasible_horizons(const std::vector<Segment>& segments, Index width,
                                   const IdentifyOptions& options) {
  const int least = std::max(2, options.order.value_or(options.min_order) + 1);
  if (options.horizon) {
    if (enough(segments, 2 * *options.horizon, width)) return {*options.horizon};
    return {};
  }
  if (!enough(segments, 2 * least, width)) return {};
  int longest = least;
  while (longest < 30 && enough(segments, 2 * (longest + 1), width) &&
         2 * hankel_columns(segments, 2 * (longest + 1)) >= hankel_columns(segments, 2 * least))
    ++longest;
  std::vector<int> horizons;
  for (const int horizon : default_horizons)
    if (horizon >= least && horizon <= longest) horizons.push_back(horizon);
  if (horizons.empty()) horizons.push_back(longest);
  return horizons;
}

/// Splits the rows so that the last `tune_share` of them is held out.
std::pair<RowRange, RowRange> split(Index rows, double tune_share) {
  const Index tune = std::max<Index>(1, static_cast<Index>(std::lround(double(rows) * tune_share)));
  return {{0, rows - tune}, {rows - tune, rows}};
}

class Identification {
 public:
  Identification(const Record& record, RowRange rows, const IdentifyOptions& options)
      : record_(record), rows_(rows), options_(options) {}

  IdentifyResult run() {
    if (auto verdict = non_finite_values(record_, rows_)) return *verdict;
    phase("choose");
    const auto [fit, tune] = split(rows_.size(), options_.tune_share);
    const Index width = record_.u.cols() + record_.y.cols();
    const RowRange fit_rows{rows_.begin, rows_.begin + fit.end};
    SearchSpace space;
    space.horizons = feasible_horizons(segments_within(record_, fit_rows), width, options_);
    if (space.horizons.empty()) return too_few(width);
    const Normalisation scaling = normalisation_of(record_, fit_rows);
    if (scaling.outputs.empty())
      return Verdict{
          VerdictCode::constant_outputs,
          "no output moves in the identification rows; choose a window in which it does"};
    if (scaling.inputs.empty() && record_.u.cols() > 0)
      return Verdict{
          VerdictCode::constant_inputs,
          "no input moves in the identification rows; choose a window in which one does"};
    space.weightings = {Weighting::n4sid, Weighting::moesp, Weighting::cva};
    if (options_.weighting) space.weightings = {*options_.weighting};
    space.min_order = options_.order.value_or(options_.min_order);
    space.max_order = options_.order.value_or(options_.max_order);
    const Record work = normalised(record_, rows_, scaling);
    const std::vector<ScoredRecipe> ranked = ranked_recipes(work, fit, tune, space);
    if (ranked.empty())
      return Verdict{VerdictCode::unstable, "no stable model of any order was found"};
    const double constant = work.y.middleRows(tune.begin, tune.size()).colwise().norm().mean() /
                            std::sqrt(double(tune.size()));
    if (ranked.front().error >= constant)
      return Verdict{VerdictCode::no_better_than_mean,
                     "the best model's error on held-out rows, " + text(ranked.front().error) +
                         ", is not below the constant model's, " + text(constant)};
    phase("identify");
    for (const ScoredRecipe& candidate : ranked)
      if (auto identified = realise(candidate.recipe)) return *identified;
    return Verdict{VerdictCode::unstable,
                   "no recipe gave a stable model on all identification rows"};
  }

 private:
  void phase(std::string_view name) const {
    if (options_.on_phase) options_.on_phase(name);
  }

  Verdict too_few(Index width) const {
    const Index s =
        options_.horizon.value_or(std::max(2, options_.order.value_or(options_.min_order) + 1));
    const Index fit = 2 * s * (width + 1);
    const auto needed = static_cast<Index>(std::ceil(double(fit) / (1 - options_.tune_share))) + 1;
    return {VerdictCode::too_few_samples,
            std::to_string(rows_.size()) + " rows in " +
                std::to_string(segments_within(record_, rows_).size()) +
                " segments are too few; at least " + std::to_string(needed) +
                " rows without a gap are needed"};
  }

  std::optional<Identified> realise(const Recipe& recipe) const {
    const Normalisation scaling = normalisation_of(record_, rows_);
    const Record work = normalised(record_, rows_, scaling);
    const HankelFactor factor = compress(work, work.all(), 2 * recipe.horizon);
    const auto [gamma, singular_values] =
        Projection(factor, recipe.horizon).observability(recipe.weighting);
    const AC ac = shift_invariant(gamma, factor.outputs, recipe.order);
    if (!ac.A.allFinite()) return std::nullopt;
    Identified result;
    result.spectral_radius = spectral_radius({ac.A, {}, {}, {}, {}, {}, {}, 1});
    if (!(result.spectral_radius < 1)) return std::nullopt;
    const Response response = fit_response(ac.A, ac.C, work, work.all(), Accuracy::exact);
    result.model = in_units(response.model, scaling);
    if (!is_well_formed(result.model)) return std::nullopt;
    result.x0 = response.x0;
    result.horizon = recipe.horizon;
    result.weighting = recipe.weighting;
    result.singular_values = singular_values;
    const auto u = record_.u.middleRows(rows_.begin, rows_.size());
    result.input_min = u.colwise().minCoeff().transpose();
    result.input_max = u.colwise().maxCoeff().transpose();
    const auto [fit, tune] = split(rows_.size(), options_.tune_share);
    result.tune = score_free_run(result.model, record_, rows_,
                                 {rows_.begin + tune.begin, rows_.begin + tune.end}, result.x0);
    return result;
  }

  const Record& record_;
  RowRange rows_;
  const IdentifyOptions& options_;
};

}  // namespace

std::string_view name(Weighting weighting) {
  switch (weighting) {
    case Weighting::n4sid:
      return "n4sid";
    case Weighting::moesp:
      return "moesp";
    case Weighting::cva:
      return "cva";
  }
  return "unknown";
}

std::vector<std::string> mistakes(const IdentifyOptions& options) {
  std::vector<std::string> found;
  if (options.order && *options.order < 1) found.push_back("the order must be at least 1");
  if (options.min_order < 1) found.push_back("the smallest order must be at least 1");
  if (options.max_order < options.min_order)
    found.push_back("the largest order must not be below the smallest");
  if (options.horizon && *options.horizon < 2) found.push_back("the horizon must be at least 2");
  if (!(options.tune_share > 0 && options.tune_share <= 0.9))
    found.push_back("the tuning share must be above 0 and at most 0.9");
  return found;
}

IdentifyResult identify(const Record& record, RowRange rows, const IdentifyOptions& options) {
  eigen_assert(mistakes(options).empty() && record.y.cols() >= 1);
  eigen_assert(rows.begin >= 0 && rows.begin <= rows.end && rows.end <= record.rows());
  return Identification(record, rows, options).run();
}

}  // namespace reident::identification
