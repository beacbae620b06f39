// Recipes beside each other, by what their models err on rows held out (METHOD.md, section 7,
// "Rules"). Private to this folder. Nothing here throws.
#pragma once

#include <cstddef>
#include <vector>

#include "identification/search/folds.hpp"
#include "identification/search/recipe.hpp"

namespace reident::identification {

/// Errors are equal up to this ratio, and below this one, in deviations of the output.
inline constexpr double equal_errors = 1.002;
inline constexpr double no_error = 1e-6;

/// A recipe and what became of it on each fold.
struct Candidate {
  std::size_t place = 0;  // of its A and C among those of the first stage
  Recipe recipe;
  double error = 0;                         // mean over the folds
  std::vector<HeldOutError> fold_errors{};  // with the operating point that was taken

  /// Returns the logarithm of the error, mean over outputs and folds: a share of a small error
  /// counts as much as that of a large one.
  double log_error() const;
};

/// Takes the operating point that the folds speak for. False where a fold had no stable model.
bool take_errors(Candidate& candidate, const std::vector<HeldOutErrors>& errors);

/// Best first: equal errors before others, the lowest order of these, then the smallest error.
void rank(std::vector<Candidate>& candidates);

/// Returns the best of each order, then the second of each, and so on: the first stage ranks by
/// little of the rows, and candidates of one order that stand beside each other are often the same
/// model.
std::vector<Candidate> by_turns(const std::vector<Candidate>& ranked);

}  // namespace reident::identification
