// 95 % bounds of what the suite counts.
#pragma once

#include <functional>
#include <utility>
#include <vector>

namespace reident::trust {

/// Upper end of the exact one-sided 95 % interval (Clopper and Pearson) for the probability of
/// which `count` of `all` are instances; 1 where all is 0.
double upper_bound(int count, int all);

/// The 95 % percentile interval of a figure of some scenarios: `figure` gets the places of
/// scenarios, below `scenarios`, drawn with replacement as often as there are scenarios (Efron
/// 1979). What happens within a scenario is not independent; scenarios are. Always the same for
/// equal arguments.
std::pair<double, double> interval(
    std::size_t scenarios, const std::function<double(const std::vector<std::size_t>&)>& figure);

}  // namespace reident::trust
