#include "service/judgement/league_rule.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <fmt/format.h>

#include "service/judgement/coverage.hpp"
#include "service/judgement/gate.hpp"

namespace reident {
namespace {

using identification::Bet;
using storage::BlockScore;
using storage::Time;
using Code = ReasonCode;

double less_by_margin(double mrse_percent, const EquipmentConfig& limits) {
  return mrse_percent * (1 - limits.margin_percent / 100);
}

/// What a member's errors and the bet on it say, before any condition is looked at.
Finding finding_of(const Member& member, const Sums& own, const Bet& bet) {
  Finding finding;
  finding.version = member.version;
  finding.blocks = own.blocks;
  finding.mrse_percent = own.mrse_percent();
  finding.fit_percent = own.fit_percent();
  const auto recent = std::min<std::ptrdiff_t>(bet.scores().size(), 2 * blocks_of_cycle);
  if (recent == 0) return finding;
  finding.dependence = bet.dependence();
  finding.log_wealth = bet.log_wealth();
  finding.mean_score = bet.scores().mean();
  finding.recent_score = bet.scores().tail(recent).mean();
  return finding;
}

/// The past of the inputs' sensor at `place` is the champion's record before the last change; where
/// that is short, its first cycles. Blocks that do not have its effect say nothing of it.
const SensorPast& past_of(const Standard& standard, std::size_t place) {
  if (const auto known = standard.pasts.find(place); known != standard.pasts.end())
    return known->second;
  PhasedScores scores;
  for_each_score(standard.league, *standard.league.champion, INT64_MIN, 0,
                 [&](std::size_t, const auto& block, const BlockScore& score) {
                   if (bias_effect_in(score, place, standard.league.biases.size()) &&
                       (block.range.begin < standard.since || scores.size() < reference_blocks))
                     scores.emplace_back(phase_of(block), &score);
                 });
  return standard.pasts.emplace(place, SensorPast(place, standard.league.biases.size(), scores))
      .first->second;
}

bool worse_in_a_regime(const Standard& standard, const Comparison& compared) {
  std::map<int, std::vector<double>> losses;
  for (std::size_t i = 0; i < compared.blocks.size(); ++i)
    losses[standard.regimes[compared.blocks[i]]].push_back(-compared.scores.values()[i]);
  const double threshold =
      std::log(static_cast<double>(losses.size()) / error_probability(standard.limits));
  const double rest = less_by_margin(1, standard.limits),
               least = (1 - rest * rest) / (1 + rest * rest);
  return std::any_of(losses.begin(), losses.end(), [&](const auto& of_regime) {
    return bet_on(of_regime.second, standard.assumed).lower_mean(threshold) > least;
  });
}

/// The least that one challenger errs before the last change and since, together [MRSE in percent].
double least_on_both_sides(const Standard& standard) {
  double least = INFINITY;
  for (const Member& member : standard.league.challengers) {
    const auto error_in = [&](storage::TimeRange range) {
      const auto served = served_regimes(standard.league, standard.regimes, member, range);
      const double error = served_errors(standard.league, served, member, false).first;
      return error > 0 && uncovered_share(served) == 0 ? error : INFINITY;
    };
    least = std::min(
        least, error_in({INT64_MIN, standard.changed}) + error_in({standard.changed, INT64_MAX}));
  }
  return least;
}

/// R2. Uncovered blocks count as if they were lost entirely.
std::optional<Reason> unproved_somewhere(const Standard& standard, const Member& member,
                                         const Comparison& compared, Finding& finding) {
  const auto& [league, limits, since, changed, assumed, regimes, pasts, on_both_sides] = standard;
  const std::int64_t champion = league.champion->version;
  const auto served = served_regimes(league, regimes, member, {changed, INT64_MAX});
  const double uncovered = finding.uncovered_share = uncovered_share(served);
  if (finding.lower_score * (1 - uncovered) < largest_score * uncovered)
    return because<Code::not_covered>(champion, 100 * uncovered);
  if (worse_in_a_regime(standard, compared)) return because<Code::worse_in_regime>(champion);
  // A regime from before the window is in no bet: yet the errors as a whole may be larger.
  const auto [own, of_champion] = finding.over_regimes_mrse_percent =
      served_errors(league, served, member, true);
  if (!(own < of_champion)) return because<Code::worse_over_regimes>(champion, own, of_champion);
  // What the change did is as much from either side of it, and no one model misses it on both.
  auto& [before, change] = finding.before_change_mrse_percent = served_errors(
      league, served_regimes(league, regimes, member, {INT64_MIN, changed}), member, false);
  if (!on_both_sides) on_both_sides = least_on_both_sides(standard);
  change = std::min(std::max(change, finding.champion_mrse_percent), *on_both_sides);
  if (most * before > change) return because<Code::worse_before_change>(before, champion, change);
  return std::nullopt;
}

/// R3. What is left without an offset has to be enough, whichever sensor's it is. The version that
/// the champion replaced has learnt nothing from what it is compared on, but the champion may have
/// learnt a bias that ended.
std::optional<Reason> may_be_bias(const Standard& standard, const Member& member,
                                  const Comparison& compared, Finding& finding) {
  const League& league = standard.league;
  if (standard.limits.bias == BiasPolicy::approve || league.unbound.empty() ||
      member.version == league.replaced)
    return std::nullopt;
  std::map<std::string, std::pair<double, double>> suspects;  // error without the offset, offset
  finding.wealth_without_offset = finding.log_wealth;
  finding.mrse_without_offset = finding.champion_mrse_percent;
  const auto look_at = [&](const std::string& sensor, OffsetFit offset) {
    std::vector<const BlockScore*> scores;  // the champion's
    for (const std::size_t i : compared.blocks) {
      scores.push_back(find(*league.champion, league.blocks[i].range.begin));
      offset.add(phase_of(league.blocks[i]), *scores.back());
    }
    if (offset.offset() == 0) return;
    Comparison rest;
    for (std::size_t k = 0; k < scores.size(); ++k)
      rest.add(compared.blocks[k], league.blocks[compared.blocks[k]],
               *find(member, scores[k]->begin), *scores[k], offset.rest(*scores[k]));
    const double wealth = bet_on(rest.scores.values(), standard.assumed).log_wealth(),
                 error = rest.other.mrse_percent();
    if (!leaves_enough(finding, wealth, error))
      suspects[sensor] = std::min(suspects.try_emplace(sensor, INFINITY, 0).first->second,
                                  {error, offset.offset()});
    finding.wealth_without_offset = std::min(finding.wealth_without_offset, wealth);
    finding.mrse_without_offset = std::min(finding.mrse_without_offset, error);
  };
  for (std::size_t q = 0; q < league.outputs.size(); ++q)
    if (std::ranges::count(league.unbound, league.outputs[q]))
      look_at(league.outputs[q], OffsetFit(q));
  for (std::size_t place = 0; place < league.biases.size(); ++place)
    if (const auto& [sensor, direction, size] = league.biases[place];
        std::ranges::count(league.unbound, sensor))
      look_at(sensor, OffsetFit(past_of(standard, place), direction));
  if (suspects.empty()) return std::nullopt;
  std::string named;
  for (const auto& [sensor, best] : suspects)
    named += fmt::format("{}{} ({:.3g} too {})", named.empty() ? "" : ", ", sensor,
                         std::abs(best.second), best.second < 0 ? "low" : "high");
  return because<Code::bias_unverified>(league.champion->version, named);
}

/// R5.
std::optional<Reason> too_soon(const Standard& standard, const Member& member) {
  const Duration since = member.window.end - standard.league.champion->window.end;
  if (since <= 0 || since >= standard.limits.min_interval) return std::nullopt;
  return because<Code::too_soon>(since, standard.league.champion->version,
                                 standard.limits.min_interval);
}

}  // namespace

bool leaves_enough(const Finding& finding, double log_wealth, double mrse) {
  return log_wealth > finding.log_threshold &&
         std::max(mrse / finding.champion_mrse_percent, most) * mrse > finding.mrse_percent;
}

Bet bet_on(const std::vector<double>& scores, double assumed) {
  return Bet({Eigen::Map<const identification::Vector>(scores.data(), std::ssize(scores)),
              largest_score, blocks_of_cycle, assumed});
}

double error_probability(const EquipmentConfig& limits) {
  return 1 - limits.confidence_percent / 100;
}

double log_threshold(const League& league, const Member& member, Time since,
                     const EquipmentConfig& limits) {
  constexpr double share_behind = 0.75, share_others = (1 - share_behind) * share_behind;
  const double all = error_probability(limits);
  if (member.version == league.replaced) return -std::log(all * (1 - share_behind - share_others));
  const bool is_behind = member.window.begin >= since;
  double k = 0;
  for (const storage::TimeRange& window : league.admitted)
    k += is_behind ? window.begin >= since && window.end <= member.window.end
                   : window.begin < since && window.end >= member.window.end;
  return std::log(std::max(1.0, k) * (k + 1) / all / (is_behind ? share_behind : share_others));
}

Finding judge_first(const League& league, const Member& member, const EquipmentConfig& limits) {
  Sums own;
  Comparison simulator;
  for_each_score(league, member, INT64_MIN, 0,
                 [&](std::size_t i, const auto& block, const BlockScore& score) {
                   own.add(block, score.square);
                   simulator.add(i, block, score, score, block.baseline_square);
                 });
  Finding finding = finding_of(member, own, bet_on(simulator.scores.values(), 0));
  finding.baseline_mrse_percent = simulator.other.mrse_percent();
  finding.recent_score = -finding.mrse_percent;
  const bool is_known = !simulator.blocks.empty();
  if (is_known) finding.log_threshold = log_threshold(league, member, INT64_MIN, limits);
  finding.obstacle = [&]() -> std::optional<Reason> {
    if (finding.blocks < blocks_of_cycle)
      return because<Code::too_few_blocks>(finding.blocks, std::int64_t{blocks_of_cycle});
    if (auto reason = inadmissible(finding.mrse_percent, finding.fit_percent, limits))
      return reason;
    const double error = is_known ? simulator.one.mrse_percent() : finding.mrse_percent;
    const double rival =
        is_known ? finding.baseline_mrse_percent : limits.baseline_mrse_percent.value_or(INFINITY);
    if (is_known
            ? finding.log_wealth > finding.log_threshold && error < less_by_margin(rival, limits)
            : error < rival)
      return std::nullopt;
    return because<Code::not_better_than_simulator>(error, rival);
  }();
  return finding;
}

Finding judge_against_champion(const Standard& standard, const Member& member,
                               const Comparison& compared) {
  const EquipmentConfig& limits = standard.limits;
  const std::int64_t champion = standard.league.champion->version;
  const Bet bet = bet_on(compared.scores.values(), standard.assumed);
  Finding finding = finding_of(member, compared.one, bet);
  finding.changed = standard.changed;
  finding.log_threshold = log_threshold(standard.league, member, standard.since, limits);
  finding.champion_mrse_percent = compared.other.mrse_percent();
  finding.obstacle = [&]() -> std::optional<Reason> {
    if (compared.blocks.empty()) return because<Code::not_compared>(champion);
    if (auto reason = inadmissible(finding.mrse_percent, finding.fit_percent, limits))
      return reason;
    if (!(finding.log_wealth > finding.log_threshold))
      return because<Code::not_better>(champion, finding.mrse_percent,
                                       finding.champion_mrse_percent, finding.blocks,
                                       finding.log_wealth, finding.log_threshold);
    if (!(finding.mrse_percent < less_by_margin(finding.champion_mrse_percent, limits)))
      return because<Code::within_margin>(champion, limits.margin_percent, finding.mrse_percent,
                                          finding.champion_mrse_percent, finding.blocks);
    finding.lower_score = bet.lower_mean(finding.log_threshold);
    if (auto reason = unproved_somewhere(standard, member, compared, finding)) return reason;
    if (auto reason = may_be_bias(standard, member, compared, finding)) return reason;
    return too_soon(standard, member);
  }();
  return finding;
}

}  // namespace reident
