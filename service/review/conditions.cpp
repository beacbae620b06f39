#include "service/review/conditions.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include <fmt/format.h>

#include "service/model/glossary.hpp"
#include "service/support/time_text.hpp"

namespace reident {
namespace {

using Code = ReasonCode;

/// The conditions in the order in which they are asked; `none` is behind all.
enum Place : std::size_t { at_window, evidence, margin, coverage, regimes, bias, policy, none };

Place place_of(std::string_view obstacle) {
  constexpr std::array places = {std::pair{Code::not_finite, at_window},
                                 std::pair{Code::error_above_limit, at_window},
                                 std::pair{Code::not_better_than_mean, at_window},
                                 std::pair{Code::not_compared, at_window},
                                 std::pair{Code::not_better, evidence},
                                 std::pair{Code::within_margin, margin},
                                 std::pair{Code::not_covered, coverage},
                                 std::pair{Code::worse_in_regime, regimes},
                                 std::pair{Code::worse_over_regimes, regimes},
                                 std::pair{Code::worse_before_change, regimes},
                                 std::pair{Code::bias_unverified, bias},
                                 std::pair{Code::too_soon, policy},
                                 std::pair{Code::held, policy},
                                 std::pair{Code::waits_for_operator, policy}};
  const auto* found = std::find_if(places.begin(), places.end(), [obstacle](const auto& place) {
    return name(place.first) == obstacle;
  });
  return found == places.end() ? none : found->second;
}

/// Whether the offset of a sensor was looked at; older decisions know the evidence alone.
bool is_offset_known(const Finding& finding) {
  return finding.mrse_without_offset > 0 || finding.wealth_without_offset > finding.log_threshold;
}

/// Whether an offset explains too much (R3).
bool is_offset(const Finding& finding) {
  const double error = finding.mrse_without_offset;
  return error > 0 && !leaves_enough(finding, finding.wealth_without_offset, error);
}

std::string offset(const Finding& finding) {
  std::string text = fmt::format("{:.2f}", finding.wealth_without_offset);
  if (finding.mrse_without_offset > 0)  // older decisions do not have it
    text += fmt::format("; champion's MRSE {:.3g} %", finding.mrse_without_offset);
  return text;
}

/// Older decisions do not have all of it.
std::string over_regimes(const Finding& finding) {
  const auto [own, champion] = finding.over_regimes_mrse_percent;
  std::string text = champion > 0 ? fmt::format("{:.3g} % against {:.3g} %", own, champion) : "";
  if (champion > 0 && finding.changed != INT64_MIN)
    text += " since the change of " + time_text(finding.changed);
  const auto [before, change] = finding.before_change_mrse_percent;
  if (before > 0)
    text += fmt::format("; before the change {:.3g} %, explained by it {:.3g} %", before, change);
  return text;
}

}  // namespace

std::vector<Condition> conditions_of(const Finding& finding, std::string_view obstacle,
                                     const EquipmentConfig& limits) {
  std::vector<Condition> conditions = {
      {"R4",
       fmt::format("MRSE at most {:g} %, fit above 0 %", limits.max_mrse_percent),
       finding.blocks > 0
           ? fmt::format("{:.3g} %, {:.1f} %", finding.mrse_percent, finding.fit_percent)
           : "no block yet",
       {}},
      {"R1",
       fmt::format("log of the evidence above {:.2f}", finding.log_threshold),
       fmt::format("{:.2f} on {} blocks", finding.log_wealth, finding.blocks),
       {}},
      {"R1",
       fmt::format("MRSE less by {:g} %", limits.margin_percent),
       fmt::format("{:.3g} % against {:.3g} %", finding.mrse_percent,
                   finding.champion_mrse_percent),
       {}},
      {"R2",
       "sure gain outweighs regimes that it has not met",
       fmt::format("at least {:.3f}; {:.1f} % not met", finding.lower_score,
                   100 * finding.uncovered_share),
       {}},
      {"R2",
       "worse in no regime, with confidence; less error over all; before the last change at most "
       "twice what this explains",
       over_regimes(finding),
       {}},
      {"R3",
       fmt::format("without the champion's offset, above {:.2f} too, and half of the gain or twice "
                   "its error",
                   finding.log_threshold),
       limits.bias == BiasPolicy::approve ? "not asked for: bias = \"approve\"" : offset(finding),
       {}},
      {"R5", "policy: interval, hold, approval", "", {}}};
  Place place = place_of(obstacle);
  // One that waited for an operator has left a full league.
  if (place == none && obstacle == name(Code::league_full) && is_offset(finding)) place = bias;
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    if (i <= place) conditions[i].holds = i < place;
    if (i > place) conditions[i].found.clear();
  }
  if (place == policy)
    if (const auto* entry = explanation_of(obstacle)) conditions[policy].found = entry->words;
  if (place > bias && limits.bias == BiasPolicy::wait && !is_offset_known(finding))
    conditions[bias].found = "not asked: relations bind the sensors, or it ran before";
  return conditions;
}

}  // namespace reident
