#include "identification/search/prepared_rows.hpp"

#include <algorithm>
#include <utility>

#include "identification/search/finite_check.hpp"
#include "identification/search/horizons.hpp"
#include "identification/subspace/excitation.hpp"

namespace reident::identification {

PreparedRows::PreparedRows(const Record& record, RowRange rows, const IdentifyOptions& options,
                           LagSums& sums, bool keep)
    : record_(record),
      fitted_{rows.begin, rows.end - options.tune_rows},
      tune_{rows.end - options.tune_rows, rows.end},
      options_(options),
      lag_sums_(sums),
      keep_(keep) {}

std::string PreparedRows::input_name(Index input) const {
  return channel_name("input", input, options_.input_names);
}

std::optional<Verdict> PreparedRows::prepare(std::vector<std::string>& warnings) {
  if (fitted_.size() < 4) return too_few_samples(record_.u.cols(), record_.y.cols());
  segments_ = segments_from(record_, fitted_);
  sums_ = sums_of({0, fitted_.size()});
  if (!all_finite(sums_))
    if (auto verdict = non_finite_values(record_, fitted_, options_)) return verdict;
  normalisation_ = normalisation_of(sums_, record_.u.cols());
  warn_of_constants(normalisation_.inputs, record_.u.cols(), "input", warnings);
  warn_of_constants(normalisation_.outputs, record_.y.cols(), "output", warnings);
  if (normalisation_.outputs.empty())
    return Verdict{VerdictCode::constant_outputs,
                   "no output moves in the rows to identify from; choose a window in which the "
                   "equipment does something"};
  if (normalisation_.inputs.empty() && record_.u.cols() > 0)
    return Verdict{VerdictCode::constant_inputs,
                   "no input moves in the rows to identify from; choose a window in which the "
                   "equipment is driven"};
  leave_out_redundant_inputs(warnings);
  return std::nullopt;
}

RangeSums PreparedRows::sums_of(RowRange part) {
  const std::vector<Segment> parts =
      segments_within(record_, {fitted_.begin + part.begin, fitted_.begin + part.end});
  if (parts.empty()) return {};
  const TickRange ticks{parts.front().first_tick, parts.back().end_tick()};
  return keep_ ? lag_sums_.keep_over(ticks, record_) : lag_sums_.over(ticks, record_);
}

void PreparedRows::warn_of_constants(const std::vector<Index>& moving, Index channels,
                                     const char* kind, std::vector<std::string>& warnings) const {
  for (Index c = 0; c < channels; ++c)
    if (!std::binary_search(moving.begin(), moving.end(), c))
      warnings.push_back(
          channel_name(kind, c, kind[0] == 'i' ? options_.input_names : options_.output_names) +
          " is constant in the rows to identify from: the "
          "model does not say how " +
          (kind[0] == 'i' ? "it acts" : "it moves"));
}

void PreparedRows::leave_out_redundant_inputs(std::vector<std::string>& warnings) {
  if (are_independent(input_correlation(sums_, normalisation_))) return;
  const std::vector<RedundantInput> redundant =
      redundant_inputs(normalised().u.topRows(fitted_.size()));
  if (redundant.empty()) return;
  std::vector<Index>& inputs = normalisation_.inputs;
  const std::vector<Index> before = inputs;
  for (auto found = redundant.rbegin(); found != redundant.rend(); ++found) {
    std::string others;
    for (const Index other : found->explained_by)
      others += (others.empty() ? "" : ", ") + input_name(before[static_cast<std::size_t>(other)]);
    warnings.push_back(input_name(before[static_cast<std::size_t>(found->input)]) +
                       " is a linear combination of " + others +
                       " at every row and is left out of the model");
    inputs.erase(inputs.begin() + found->input);
  }
  normalised_.reset();
}

std::vector<Fold> PreparedRows::folds() const {
  const Index fitted = fitted_.size();
  if (tune_.size() == 0) return folds_of(fitted, options_.tune_share);
  return {{{0, fitted}, {fitted, fitted + tune_.size()}}};
}

Index PreparedRows::rows_needed(int horizon, Index width) const {
  const Index fit = 2 * Index{horizon} * (width + 1);
  Index needed = fit;
  if (tune_.size() == 0)
    while (folds_of(needed, options_.tune_share)[2].fit.size() < fit) ++needed;
  return needed;
}

Verdict PreparedRows::too_few_samples(Index m, Index p) const {
  const auto counted = [](Index count, const char* what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
  };
  const int least = options_.horizon.value_or(least_horizon(options_));
  const int lowest = options_.order.value_or(std::max(1, options_.min_order));
  std::string reason =
      counted(fitted_.size(), "row") + " to identify from in " +
      counted(static_cast<Index>(segments_within(record_, fitted_).size()), "segment") +
      " are too few for " + counted(m, "input") + " and " + counted(p, "output") + ": order " +
      std::to_string(lowest) + " takes at least " + std::to_string(rows_needed(least, m + p)) +
      " rows without a gap (horizon " + std::to_string(least) + ")";
  const int usual = horizon_of_order(options_.max_order, p);
  if (!options_.order && !options_.horizon && usual > least)
    reason += ", all up to " + std::to_string(options_.max_order) + " take " +
              std::to_string(rows_needed(usual, m + p));
  return {VerdictCode::too_few_samples, reason + "; choose more rows or fewer channels"};
}

const Record& PreparedRows::normalised() {
  if (!normalised_)
    normalised_ = identification::normalised(record_, {fitted_.begin, tune_.end}, normalisation_);
  return *normalised_;
}

const HankelFactor& PreparedRows::factor(int horizon) {
  const auto found = factors_.find(horizon);
  if (found != factors_.end()) return found->second;
  auto made = factor_of_sums(sums_, normalisation_, horizon);
  if (!made) made = factor_of_rows(normalised(), segments_, horizon);
  return factors_.emplace(horizon, std::move(*made)).first->second;
}

}  // namespace reident::identification
