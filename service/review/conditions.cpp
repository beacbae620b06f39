#include "service/review/conditions.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "service/model/glossary.hpp"

namespace reident {
namespace {

using Code = ReasonCode;

/// Place of the condition that an obstacle belongs to; that of none behind all.
std::size_t place_of(std::string_view obstacle) {
  constexpr std::array places = {std::pair{Code::not_finite, 0},
                                 std::pair{Code::error_above_limit, 0},
                                 std::pair{Code::not_better_than_mean, 0},
                                 std::pair{Code::not_better, 1},
                                 std::pair{Code::within_margin, 2},
                                 std::pair{Code::not_covered, 3},
                                 std::pair{Code::worse_in_regime, 4},
                                 std::pair{Code::bias_unverified, 5},
                                 std::pair{Code::too_soon, 6},
                                 std::pair{Code::held, 6},
                                 std::pair{Code::waits_for_operator, 6}};
  const auto* found = std::find_if(places.begin(), places.end(), [obstacle](const auto& place) {
    return name(place.first) == obstacle;
  });
  return found == places.end() ? places.size() : static_cast<std::size_t>(found->second);
}

}  // namespace

std::vector<Condition> conditions_of(const Finding& finding, std::string_view obstacle,
                                     const EquipmentConfig& limits) {
  const double rest = 1 - limits.margin_percent / 100;
  std::vector<Condition> conditions = {
      {"R4",
       fmt::format("MRSE at most {:g} %, fit above 0 %", limits.max_mrse_percent),
       fmt::format("{:.3g} %, {:.1f} %", finding.mrse_percent, finding.fit_percent),
       {}},
      {"R1",
       fmt::format("log of the evidence above {:.2f}", finding.log_threshold),
       fmt::format("{:.2f} on {} blocks", finding.log_wealth, finding.blocks),
       {}},
      {"R1",
       fmt::format("mean score above {:.3f} ({:g} % less error)",
                   (1 - rest * rest) / (1 + rest * rest), limits.margin_percent),
       fmt::format("{:.3f}; MRSE {:.3g} % against {:.3g} %", finding.mean_score,
                   finding.mrse_percent, finding.champion_mrse_percent),
       {}},
      {"R2",
       "sure gain outweighs regimes that it has not met",
       fmt::format("at least {:.3f}; {:.1f} % not met", finding.lower_score,
                   100 * finding.uncovered_share),
       {}},
      {"R2", "worse in no regime, with confidence", "", {}},
      {"R3",
       fmt::format("without the champion's offset, above {:.2f} too", finding.log_threshold),
       limits.bias == BiasPolicy::approve ? "not asked for: bias = \"approve\""
                                          : fmt::format("{:.2f}", finding.wealth_without_offset),
       {}},
      {"R5", "policy: interval, hold, approval", "", {}}};
  const std::size_t place = place_of(obstacle);
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    if (i <= place) conditions[i].holds = i < place;
    if (i > place) conditions[i].found.clear();
  }
  if (place == 6)
    if (const auto* entry = explanation_of(obstacle)) conditions[6].found = entry->words;
  // Asked, it holds with more than the threshold alone (Judge).
  Condition& bias = conditions[5];
  if (bias.holds == true && limits.bias == BiasPolicy::wait &&
      finding.wealth_without_offset <= finding.log_threshold)
    bias.found = "not asked: relations bind the sensors";
  return conditions;
}

}  // namespace reident
