#include "identification/search/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

namespace reident::identification {

double Candidate::log_error() const {
  double sum = 0;
  for (const HeldOutError& error : fold_errors) sum += error.log_rms;
  return sum / double(fold_errors.size());
}

bool take_errors(Candidate& candidate, const std::vector<HeldOutErrors>& errors) {
  constexpr double worthwhile_recency = 0.95;
  double whole = 0, recent = 0;
  for (const HeldOutErrors& of_fold : errors) {
    whole += of_fold.whole.rms / double(errors.size());
    recent += of_fold.recent.rms / double(errors.size());
  }
  if (!std::isfinite(whole)) return false;
  const bool is_recent = recent < worthwhile_recency * whole;
  candidate.recipe.operating_point = is_recent ? OperatingPoint::recent : OperatingPoint::whole;
  candidate.error = is_recent ? recent : whole;
  candidate.fold_errors.clear();
  for (const HeldOutErrors& of_fold : errors)
    candidate.fold_errors.push_back(is_recent ? of_fold.recent : of_fold.whole);
  return true;
}

void rank(std::vector<Candidate>& candidates) {
  double best = std::numeric_limits<double>::infinity();
  for (const Candidate& candidate : candidates) best = std::min(best, candidate.error);
  const auto key = [best](const Candidate& candidate) {
    const bool equal = candidate.error <= std::max(equal_errors * best, no_error);
    return std::tuple(!equal, equal ? candidate.recipe.order : 0, candidate.error);
  };
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&key](const auto& a, const auto& b) { return key(a) < key(b); });
}

std::vector<Candidate> by_turns(const std::vector<Candidate>& ranked) {
  std::map<int, int> of_order;
  std::vector<std::pair<int, std::size_t>> turns;
  for (std::size_t i = 0; i < ranked.size(); ++i)
    turns.emplace_back(of_order[ranked[i].recipe.order]++, i);
  std::sort(turns.begin(), turns.end());
  std::vector<Candidate> result;
  for (const auto& [turn, place] : turns) result.push_back(ranked[place]);
  return result;
}

}  // namespace reident::identification
