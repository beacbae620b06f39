// The conditions R1 to R5 on one challenger, from the records (service/DESIGN.md, "Gate"). Private
// to judgement.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "identification/statistics/betting.hpp"
#include "service/config/config.hpp"
#include "service/judgement/league.hpp"
#include "service/judgement/offset.hpp"
#include "service/judgement/scores.hpp"

namespace reident {

/// Calls `use` with each block from `since` on that counts and that the member has a score of, from
/// the one at place `first` on: its place, itself, the score.
template <typename Use>
void for_each_score(const League& league, const Member& member, storage::Time since,
                    std::size_t first, const Use& use) {
  for (std::size_t i = first; i < league.blocks.size(); ++i) {
    const storage::Block& block = league.blocks[i];
    if (!counts(block) || block.range.begin < since) continue;
    if (const storage::BlockScore* score = find(member, block.range.begin)) use(i, block, *score);
  }
}

/// A bet on the scores of blocks, whose dependence is at least `assumed`.
identification::Bet bet_on(const std::vector<double>& scores, double assumed);

/// What the configured confidence leaves, from 0 to 1.
double error_probability(const EquipmentConfig& limits);

/// Logarithm of the wealth that a member's bet has to reach. Versions that were identified wholly
/// behind the last change, or from the champion's window on, come first: the k-th of them has a
/// share 1 / (k (k + 1)) of three quarters of the error probability. Of the others the k-th has
/// such a share of three quarters of the rest, the newest first; what is left has the one that the
/// champion replaced.
double log_threshold(const League& league, const Member& member, storage::Time since,
                     const EquipmentConfig& limits);

/// Where and by what a league is judged.
struct Standard {
  const League& league;
  const EquipmentConfig& limits;
  storage::Time since;    // records count from here on
  storage::Time changed;  // the equipment is as it is from here on
  double assumed;         // dependence of scores
  const std::vector<int>& regimes;
  // What was asked for, by members in turn.
  mutable std::map<std::size_t, SensorPast> pasts{};  // by the places of their biases
  mutable std::optional<double> on_both_sides{};      // least_on_both_sides()
};

/// A first version has to be good on telemetry of a whole cycle, and the simulator's own model is
/// its champion.
Finding judge_first(const League& league, const Member& member, const EquipmentConfig& limits);

/// Requires a champion, which `compared` compares the member with.
Finding judge_against_champion(const Standard& standard, const Member& member,
                               const Comparison& compared);

}  // namespace reident
