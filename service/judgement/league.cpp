#include "service/judgement/league.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "identification/statistics/betting.hpp"
#include "service/judgement/regimes.hpp"

namespace reident {
namespace {

using identification::dependence;
using identification::Index;
using identification::log_wealth;
using identification::lower_mean;
using identification::ScoreSeries;
using identification::Vector;
using storage::Block;
using storage::BlockScore;
using storage::Time;
using Code = ReasonCode;

/// Mean error of a run over the last cycle, by output, with the block at `index` the last.
std::vector<double> cycle_mean(const League& league, const Member& member, std::size_t index) {
  std::vector<double> mean(league.blocks[index].output_mean.size(), 0);
  double rows = 0;
  for (std::size_t i = index + 1; i-- > 0 && index - i < blocks_of_cycle;) {
    const BlockScore* score = find(member, league.blocks[i].range.begin);
    if (!score || !counts(league.blocks[i])) continue;
    const auto weight = static_cast<double>(score->rows);
    for (std::size_t q = 0; q < mean.size(); ++q) mean[q] += weight * score->mean[q];
    rows += weight;
  }
  for (double& value : mean) value /= rows;
  return mean;
}

struct Pair {
  std::vector<Time> begins;
  std::vector<double> scores;
  std::vector<int> regimes;
  Sums member, champion;
};

ScoreSeries series(const std::vector<double>& scores, double assumed) {
  return {Eigen::Map<const Vector>(scores.data(), std::ssize(scores)), largest_score,
          blocks_of_cycle, assumed};
}

/// Dependence of the scores of the two members with the longest records from `since` on: what is
/// assumed of versions whose records are short. 0 where there are no two.
double usual_dependence(const League& league, Time since) {
  std::vector<const Member*> members;
  for (const Member& member : league.challengers) members.push_back(&member);
  if (league.champion) members.push_back(&*league.champion);
  if (members.size() < 2) return 0;
  std::ranges::partial_sort(members, members.begin() + 2, std::greater<>(),
                            [](const Member* member) { return member->scores.size(); });
  Scores scores;
  for (const Block& block : league.blocks) {
    if (!counts(block) || block.range.begin < since) continue;
    const BlockScore* one = find(*members[0], block.range.begin);
    const BlockScore* other = find(*members[1], block.range.begin);
    if (one && other) scores.add(squares_of(*one, *other));
  }
  return dependence(series(scores.values(), 0));
}

/// The score of an error that is less by the margin.
double margin_of(const EquipmentConfig& limits) {
  const double rest = 1 - limits.margin_percent / 100;
  return (1 - rest * rest) / (1 + rest * rest);
}

double error_probability(const EquipmentConfig& limits) {
  return 1 - limits.confidence_percent / 100;
}

/// Versions that were identified wholly behind the last change, or from the champion's window on,
/// come first: the k-th of them has a share 1 / (k (k + 1)) of three quarters of the error
/// probability. Of the rest the k-th has such a share of the last quarter, the newest first.
double log_threshold(const League& league, const Member& member, Time since,
                     const EquipmentConfig& limits) {
  constexpr double share_behind = 0.75;
  const bool is_behind = member.window.begin >= since;
  double k = 0;
  for (const storage::TimeRange& window : league.admitted)
    k += is_behind ? window.begin >= since && window.end <= member.window.end
                   : window.begin < since && window.end >= member.window.end;
  return std::log(std::max(1.0, k) * (k + 1) / error_probability(limits) /
                  (is_behind ? share_behind : 1 - share_behind));
}

/// Calls `use` with each block from `since` on that both have a score of: its place and the scores.
template <typename Use>
void for_each_common(const League& league, const Member& member, Time since, const Use& use) {
  if (member.scores.empty()) return;
  const Time first = std::max(since, member.scores.front().begin);
  const auto begin = std::ranges::lower_bound(league.blocks, first, {},
                                              [](const Block& block) { return block.range.begin; });
  for (auto block = begin; block != league.blocks.end(); ++block) {
    if (!counts(*block)) continue;
    const BlockScore* own = find(member, block->range.begin);
    const BlockScore* other = find(*league.champion, block->range.begin);
    if (own && other) use(static_cast<std::size_t>(block - league.blocks.begin()), *own, *other);
  }
}

Pair pair_of(const League& league, const std::vector<int>& regimes, const Member& member,
             Time since) {
  Pair pair;
  Scores scores;
  for_each_common(league, member, since,
                  [&](std::size_t i, const BlockScore& own, const BlockScore& other) {
                    const Block& block = league.blocks[i];
                    pair.begins.push_back(block.range.begin);
                    scores.add(squares_of(own, other));
                    pair.regimes.push_back(regimes[i]);
                    pair.member.add(block, own.square);
                    pair.champion.add(block, other.square);
                  });
  pair.scores = scores.values();
  return pair;
}

/// Scores with the champion's mean error over each last cycle taken from its error.
std::vector<double> scores_without_offset(const League& league, const Member& member, Time since) {
  Scores scores;
  for_each_common(league, member, since,
                  [&](std::size_t i, const BlockScore& own, const BlockScore& other) {
                    const std::vector<double> offset = cycle_mean(league, *league.champion, i);
                    scores.add(squares_of(own, other, &offset));
                  });
  return scores.values();
}

/// Share of the champion's blocks from `since` on that are in regimes which the member has not met.
double uncovered_share(const League& league, const std::vector<int>& regimes, const Member& member,
                       Time since) {
  std::map<int, std::pair<double, bool>> by_regime;  // champion's blocks; met by the member
  double all = 0;
  for (std::size_t i = 0; i < league.blocks.size(); ++i) {
    if (regimes[i] < 0) continue;
    auto& [served, met] = by_regime[regimes[i]];
    const Time begin = league.blocks[i].range.begin;
    if (begin >= since && find(*league.champion, begin)) ++served, ++all;
    met = met || begin >= member.window.begin;
  }
  double uncovered = 0;
  for (const auto& [regime, of] : by_regime)
    if (!of.second) uncovered += of.first;
  return all > 0 ? uncovered / all : 0;
}

bool worse_in_a_regime(const Pair& pair, double assumed, const EquipmentConfig& limits) {
  std::map<int, std::vector<double>> losses;
  for (std::size_t i = 0; i < pair.scores.size(); ++i)
    losses[pair.regimes[i]].push_back(-pair.scores[i]);
  const double threshold = std::log(static_cast<double>(losses.size()) / error_probability(limits));
  return std::any_of(losses.begin(), losses.end(), [&](const auto& of_regime) {
    const ScoreSeries loss = series(of_regime.second, assumed);
    return lower_mean(loss, dependence(loss), threshold) > margin_of(limits);
  });
}

/// R4, on the record.
std::optional<Reason> inadmissible(const Finding& finding, const EquipmentConfig& limits) {
  if (!std::isfinite(finding.mrse_percent)) return because<Code::not_finite>();
  if (finding.mrse_percent > limits.max_mrse_percent)
    return because<Code::error_above_limit>(finding.mrse_percent, limits.max_mrse_percent);
  if (!(finding.fit_percent > 0)) return because<Code::not_better_than_mean>(finding.fit_percent);
  return std::nullopt;
}

/// A record compared with a rival whose mean squared errors are known, by output; on a block where
/// they are empty they are not.
struct AgainstRival {
  Scores scores;
  Sums own, rival;

  void add(const Block& block, const BlockScore& score, const std::vector<double>& square) {
    if (square.empty()) return;
    BlockScore other = score;
    other.square = square;
    scores.add(squares_of(score, other));
    own.add(block, score.square);
    rival.add(block, square);
  }
};

/// A first version has to be good on telemetry of a whole cycle, and the simulator's own model is
/// its champion.
Finding judge_first(const League& league, const Member& member, const EquipmentConfig& limits) {
  Finding finding;
  finding.version = member.version;
  Sums own;
  AgainstRival simulator;
  for (const Block& block : league.blocks) {
    const BlockScore* score = counts(block) ? find(member, block.range.begin) : nullptr;
    if (!score) continue;
    ++finding.blocks;
    own.add(block, score->square);
    simulator.add(block, *score, block.baseline_square);
  }
  finding.mrse_percent = own.mrse_percent();
  finding.fit_percent = own.fit_percent();
  finding.baseline_mrse_percent = simulator.rival.mrse_percent();
  finding.recent_score = finding.log_wealth = -finding.mrse_percent;
  const ScoreSeries scores = series(simulator.scores.values(), 0);
  if (scores.scores.size() > 0) {
    finding.dependence = dependence(scores);
    finding.log_wealth = log_wealth(scores, finding.dependence, 0);
    finding.log_threshold = log_threshold(league, member, INT64_MIN, limits);
    finding.mean_score = scores.scores.mean();
  }
  finding.obstacle = [&]() -> std::optional<Reason> {
    if (finding.blocks < blocks_of_cycle)
      return because<Code::too_few_blocks>(finding.blocks, std::int64_t{blocks_of_cycle});
    if (auto reason = inadmissible(finding, limits)) return reason;
    const bool is_known = scores.scores.size() > 0;
    const double error = is_known ? simulator.own.mrse_percent() : finding.mrse_percent;
    const double rival =
        is_known ? finding.baseline_mrse_percent : limits.baseline_mrse_percent.value_or(INFINITY);
    const bool is_better = is_known ? finding.log_wealth > finding.log_threshold &&
                                          finding.mean_score > margin_of(limits)
                                    : error < rival;
    if (!is_better) return because<Code::not_better_than_simulator>(error, rival);
    return std::nullopt;
  }();
  return finding;
}

/// Where and by what a league is judged.
struct Standard {
  const League& league;
  const EquipmentConfig& limits;
  Time since;                // records count from here on
  std::vector<int> regimes;  // of the blocks
  double assumed;            // dependence of scores
};

/// R2. Uncovered blocks count as if they were lost entirely.
std::optional<Reason> unproved_somewhere(const Standard& standard, const Member& member,
                                         const Pair& pair, Finding& finding) {
  const std::int64_t champion = standard.league.champion->version;
  finding.uncovered_share =
      uncovered_share(standard.league, standard.regimes, member, standard.since);
  if (finding.lower_score * (1 - finding.uncovered_share) < largest_score * finding.uncovered_share)
    return because<Code::not_covered>(champion, 100 * finding.uncovered_share);
  if (worse_in_a_regime(pair, standard.assumed, standard.limits))
    return because<Code::worse_in_regime>(champion);
  return std::nullopt;
}

/// R3.
std::optional<Reason> may_be_bias(const Standard& standard, const Member& member,
                                  Finding& finding) {
  const std::vector<std::string>& unbound = standard.league.unbound;
  if (standard.limits.bias == BiasPolicy::approve || unbound.empty()) return std::nullopt;
  const std::vector<double> scores = scores_without_offset(standard.league, member, standard.since);
  const ScoreSeries without = series(scores, standard.assumed);
  finding.mean_without_offset = without.scores.mean();
  finding.wealth_without_offset = log_wealth(without, dependence(without), 0);
  if (finding.wealth_without_offset > finding.log_threshold &&
      finding.mean_without_offset > margin_of(standard.limits))
    return std::nullopt;
  std::string sensors;
  for (const std::string& name : unbound) sensors += (sensors.empty() ? "" : ", ") + name;
  return because<Code::bias_unverified>(standard.league.champion->version, sensors);
}

/// R5.
std::optional<Reason> too_soon(const Standard& standard, const Member& member) {
  const Member& champion = *standard.league.champion;
  const Duration since = member.window.end - champion.window.end;
  if (since <= 0 || since >= standard.limits.min_interval) return std::nullopt;
  return because<Code::too_soon>(since, champion.version, standard.limits.min_interval);
}

Finding judge_against_champion(const Standard& standard, const Member& member) {
  const EquipmentConfig& limits = standard.limits;
  const std::int64_t champion = standard.league.champion->version;
  Finding finding;
  finding.version = member.version;
  const Pair pair = pair_of(standard.league, standard.regimes, member, standard.since);
  finding.blocks = std::ssize(pair.scores);
  finding.log_threshold = log_threshold(standard.league, member, standard.since, limits);
  const auto not_better = [&] {
    return because<Code::not_better>(champion, finding.mrse_percent, finding.champion_mrse_percent,
                                     finding.blocks, finding.log_wealth, finding.log_threshold);
  };
  if (pair.scores.empty()) {
    finding.obstacle = not_better();
    return finding;
  }
  const ScoreSeries scores = series(pair.scores, standard.assumed);
  finding.dependence = dependence(scores);
  finding.log_wealth = log_wealth(scores, finding.dependence, 0);
  finding.mean_score = scores.scores.mean();
  finding.mrse_percent = pair.member.mrse_percent();
  finding.fit_percent = pair.member.fit_percent();
  finding.champion_mrse_percent = pair.champion.mrse_percent();
  const Index recent = std::min<Index>(scores.scores.size(), 2 * blocks_of_cycle);
  finding.recent_score = scores.scores.tail(recent).mean();
  finding.obstacle = [&]() -> std::optional<Reason> {
    if (auto reason = inadmissible(finding, limits)) return reason;
    if (!(finding.log_wealth > finding.log_threshold)) return not_better();
    if (!(finding.mean_score > margin_of(limits)))
      return because<Code::within_margin>(champion, limits.margin_percent, finding.mrse_percent,
                                          finding.champion_mrse_percent, finding.blocks);
    finding.lower_score = lower_mean(scores, finding.dependence, finding.log_threshold);
    if (auto reason = unproved_somewhere(standard, member, pair, finding)) return reason;
    if (auto reason = may_be_bias(standard, member, finding)) return reason;
    return too_soon(standard, member);
  }();
  return finding;
}

/// Records count from the last change on, or from the champion's window.
Time counted_since(const League& league) {
  const auto change = change_of(league);
  return change ? change->since : league.champion->window.begin;
}

}  // namespace

std::vector<Finding> judge(const League& league, const EquipmentConfig& limits) {
  std::vector<Finding> findings;
  if (!league.champion) {
    for (const Member& member : league.challengers)
      findings.push_back(judge_first(league, member, limits));
    return findings;
  }
  const Time since = counted_since(league);
  const Standard standard{league, limits, since, regimes_of(league.blocks),
                          usual_dependence(league, since)};
  for (const Member& member : league.challengers)
    findings.push_back(judge_against_champion(standard, member));
  return findings;
}

std::optional<Finding> successor(const std::vector<Finding>& findings) {
  std::optional<Finding> best;
  for (const Finding& finding : findings)
    if (!finding.obstacle && (!best || finding.recent_score > best->recent_score)) best = finding;
  return best;
}

Finding weakest(const std::vector<Finding>& findings) {
  return *std::ranges::min_element(findings, {}, &Finding::log_wealth);
}

std::vector<ComparedBlock> compared_blocks(const League& league, const Member& challenger,
                                           const EquipmentConfig& limits) {
  const Time since = counted_since(league);
  const Pair pair = pair_of(league, regimes_of(league.blocks), challenger, since);
  const double assumed = usual_dependence(league, since);
  const double threshold = log_threshold(league, challenger, since, limits);
  std::vector<ComparedBlock> blocks;
  std::vector<double> scores;
  for (std::size_t i = 0; i < pair.scores.size(); ++i) {
    scores.push_back(pair.scores[i]);
    const ScoreSeries found = series(scores, assumed);
    blocks.push_back({pair.begins[i], pair.scores[i], found.scores.mean(),
                      lower_mean(found, dependence(found), threshold)});
  }
  return blocks;
}

std::optional<Reason> failure_of(const League& league, const EquipmentConfig& limits) {
  if (!league.champion) return std::nullopt;
  const Time since = counted_since(league);
  std::vector<std::pair<const Block*, const BlockScore*>> record;
  std::vector<double> mean;
  double rows = 0;
  for (const Block& block : league.blocks) {
    if (!counts(block) || block.range.begin < since) continue;
    const BlockScore* score = find(*league.champion, block.range.begin);
    if (!score) continue;
    record.push_back({&block, score});
    mean.resize(block.output_mean.size(), 0);
    const auto weight = static_cast<double>(block.rows);
    for (std::size_t q = 0; q < mean.size(); ++q) mean[q] += weight * block.output_mean[q];
    rows += weight;
  }
  for (double& value : mean) value /= rows;
  const auto fails_against =
      [&](const char* name,
          const std::function<std::vector<double>(const Block&)>& square) -> std::optional<Reason> {
    AgainstRival compared;
    for (const auto& [block, score] : record) compared.add(*block, *score, square(*block));
    ScoreSeries losses = series(compared.scores.values(), 0);
    losses.scores = -losses.scores;
    if (!(log_wealth(losses, dependence(losses), 0) > -std::log(error_probability(limits))))
      return std::nullopt;
    return because<Code::champion_failed>(league.champion->version, compared.own.mrse_percent(),
                                          losses.scores.size(), name,
                                          compared.rival.mrse_percent());
  };
  if (auto reason = fails_against("a constant at the mean", [&](const Block& block) {
        std::vector<double> square = block.output_square;
        for (std::size_t q = 0; q < square.size(); ++q)
          square[q] += mean[q] * (mean[q] - 2 * block.output_mean[q]);
        return square;
      }))
    return reason;
  return fails_against("the simulator's own model",
                       [](const Block& block) { return block.baseline_square; });
}

}  // namespace reident
