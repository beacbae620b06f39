// The search over order, horizon and weighting, scored on rows that no candidate has seen.
#pragma once

#include <vector>

#include "identification/identify.hpp"
#include "identification/record.hpp"

namespace reident::identification {

/// What is chosen: with it and the rows, the model follows.
struct Recipe {
  int order = 0;
  int horizon = 0;
  Weighting weighting = Weighting::n4sid;
  bool operator==(const Recipe&) const = default;
};

struct ScoredRecipe {
  Recipe recipe;
  double error = 0;  // mean over outputs of the free run's root mean square error, normalised
};

/// The recipes to try on `rows` rows in `segments`, under the options.
struct SearchSpace {
  std::vector<int> horizons;  // ascending
  std::vector<Weighting> weightings;
  int min_order = 1;
  int max_order = 1;
};

/// Fits every recipe on `fit` and scores its free run on `tune`, the rows that follow. Returns the
/// stable ones, best first: within 1 % of the smallest error the lower order wins, then the lower
/// error.
std::vector<ScoredRecipe> ranked_recipes(const Record& normalised, RowRange fit, RowRange tune,
                                         const SearchSpace& space);

}  // namespace reident::identification
