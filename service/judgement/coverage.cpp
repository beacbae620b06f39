#include "service/judgement/coverage.hpp"

#include <algorithm>
#include <cmath>

namespace reident {

using storage::Block;
using storage::Time;

std::map<int, ServedRegime> served_regimes(const League& league, const std::vector<int>& regimes,
                                           const Member& member, Time since) {
  std::map<int, ServedRegime> served;
  for (std::size_t i = 0; i < league.blocks.size(); ++i) {
    if (regimes[i] < 0) continue;
    ServedRegime& regime = served[regimes[i]];
    const storage::TimeRange& range = league.blocks[i].range;
    if (range.begin >= since) regime.blocks.push_back(i);
    const bool ran_before = range.begin < member.window.begin && find(member.scores, range.begin);
    regime.is_met = regime.is_met || ran_before ||
                    range.end - blocks_of_cycle * (range.end - range.begin) >= member.window.begin;
  }
  return served;
}

double uncovered_share(const std::map<int, ServedRegime>& served) {
  double all = 0, uncovered = 0;
  for (const auto& [number, regime] : served) {
    const auto blocks = static_cast<double>(regime.blocks.size());
    all += blocks;
    if (!regime.is_met) uncovered += blocks;
  }
  return all > 0 ? uncovered / all : 0;
}

std::vector<Time> earlier_blocks(const League& league, const std::map<int, ServedRegime>& served,
                                 const Member& member) {
  std::vector<Time> begins;
  for (const auto& [number, regime] : served) {
    if (regime.is_met) continue;
    int left = cycles_before * blocks_of_cycle;
    for (auto i = regime.blocks.rbegin(); i != regime.blocks.rend() && left > 0; ++i) {
      const storage::TimeRange& range = league.blocks[*i].range;
      if (range.end > member.window.begin) continue;
      begins.push_back(range.begin);
      --left;
    }
  }
  std::ranges::sort(begins);
  return begins;
}

double served_error_ratio(const League& league, const std::map<int, ServedRegime>& served,
                          const Member& member) {
  double log_ratio = 0, time = 0;
  for (const auto& [number, regime] : served) {
    Sums own, champion;
    for (const std::size_t i : regime.blocks) {
      const Block& block = league.blocks[i];
      const BlockScore* one = find(member.scores, block.range.begin);
      const BlockScore* other = find(league.champion->scores, block.range.begin);
      if (!one || !other) continue;
      const Squares squares = squares_of(*one, *other);
      own.add(block, squares.one);
      champion.add(block, squares.other);
    }
    if (own.rows == 0) continue;
    const auto share = static_cast<double>(regime.blocks.size());
    log_ratio += share * (own.error / champion.error).sqrt().log().mean();
    time += share;
  }
  return time > 0 ? std::exp(log_ratio / time) : 1;
}

}  // namespace reident
