// Which models are worth identifying from the rows, best first (METHOD.md, section 7). Private to
// this folder. Nothing here throws but what the caller's `for_each` throws.
#pragma once

#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "identification/samples/verdict.hpp"
#include "identification/search/model_search.hpp"
#include "identification/search/prepared_rows.hpp"

namespace reident::identification {

/// Recipes, best first, at least one.
struct RecipeChoice {
  /// Errors are infinite where nothing was to be chosen.
  std::vector<ScoredRecipe> ranked;
  /// A recipe with a larger error than this does not explain the outputs.
  double acceptable_error = std::numeric_limits<double>::infinity();
  double work_spent = 0;  // of the budget
};

/// Chooses among what the options leave open, with a warning for each limit that the rows set.
/// Requires rows that are prepared. Returns a verdict where the rows do not feed or excite any
/// model, and where no model explains the rows that it was not fitted to.
/// Where the options fix order and horizon and leave nothing open, or the rows are too few to hold
/// some of them out, nothing is scored and the recipe is what the options say.
std::variant<RecipeChoice, Verdict> choose_recipes(PreparedRows& rows,
                                                   std::vector<std::string>& warnings);

}  // namespace reident::identification
