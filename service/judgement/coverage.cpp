#include "service/judgement/coverage.hpp"

#include <algorithm>

namespace reident {

using storage::Block;
using storage::Time;
using storage::TimeRange;

std::map<int, ServedRegime> served_regimes(const League& league, const std::vector<int>& regimes,
                                           const Member& member, TimeRange range) {
  std::map<int, ServedRegime> served;
  for (std::size_t i = 0; i < league.blocks.size(); ++i) {
    if (regimes[i] < 0) continue;
    ServedRegime& regime = served[regimes[i]];
    const Time begin = league.blocks[i].range.begin;
    if (begin >= range.begin && begin < range.end) regime.blocks.push_back(i);
    regime.is_met = regime.is_met || find(member.scores, begin);
  }
  return served;
}

double uncovered_share(const std::map<int, ServedRegime>& served) {
  double met = 0, uncovered = 0;
  for (const auto& [number, regime] : served)
    (regime.is_met ? met : uncovered) += static_cast<double>(regime.blocks.size());
  return uncovered > 0 ? uncovered / (met + uncovered) : 0;
}

std::vector<Time> earlier_blocks(const League& league, const std::vector<int>& regimes,
                                 const Member& member, Time changed) {
  std::vector<Time> begins;
  for (const TimeRange range : {TimeRange{INT64_MIN, changed}, TimeRange{changed, INT64_MAX}})
    for (const auto& [number, regime] : served_regimes(league, regimes, member, range)) {
      const auto& blocks = regime.blocks;
      const auto record = std::ranges::lower_bound(
          blocks, member.record, {}, [&](std::size_t i) { return league.blocks[i].range.begin; });
      if (blocks.end() - record >= blocks_of_cycle) continue;
      const auto count =
          std::min<std::ptrdiff_t>(record - blocks.begin(), cycles_before * blocks_of_cycle);
      for (auto i = record - count; i != record; ++i)
        begins.push_back(league.blocks[*i].range.begin);
    }
  std::ranges::sort(begins);
  return begins;
}

std::pair<double, double> served_errors(const League& league,
                                        const std::map<int, ServedRegime>& served,
                                        const Member& member, bool bounded) {
  Sums usual;
  for (const Block& block : league.blocks)
    if (bounded && counts(block) && block.range.begin >= member.window.begin &&
        block.range.end <= member.window.end)
      usual.add(block, block.output_square);
  std::vector<double> square;
  const auto add = [&](Sums& sums, const Member& of, const Block& block, double weight) {
    square = find(of.scores, block.range.begin)->square;
    for (std::size_t q = 0; usual.rows > 0 && q < square.size(); ++q)
      square[q] = std::min(square[q], usual.error(std::ptrdiff_t(q)) / usual.rows);
    sums.add(block, square, weight);
  };
  Sums own, champion;
  for (const auto& [number, regime] : served) {
    std::vector<std::size_t> both;
    for (const std::size_t i : regime.blocks)
      if (const Time begin = league.blocks[i].range.begin;
          find(member.scores, begin) && find(league.champion->scores, begin))
        both.push_back(i);
    const double weight = static_cast<double>(regime.blocks.size()) / double(both.size());
    for (const std::size_t i : both) {
      add(own, member, league.blocks[i], weight);
      add(champion, *league.champion, league.blocks[i], weight);
    }
  }
  return {own.mrse_percent(), champion.mrse_percent()};
}

}  // namespace reident
