// The operating regimes of an equipment, and what a challenger's record says of them.
#pragma once

#include <map>
#include <vector>

#include "service/judgement/league.hpp"

namespace reident {

struct ServedRegime {
  std::vector<std::size_t> blocks;  // places in the league
  bool is_met = false;              // the member ran on a block of it
};

/// Those of the blocks that begin in `range`, by the number of the regime; `regimes` has those of
/// all the league's blocks.
std::map<int, ServedRegime> served_regimes(const League& league, const std::vector<int>& regimes,
                                           const Member& member, storage::TimeRange range);

/// Share of the blocks that are in regimes which the member has not met.
double uncovered_share(const std::map<int, ServedRegime>& served);

/// Begins of the blocks before the member's record, ascending, on which it has to run: the last
/// `cycles_before` of each regime of which the record has no whole cycle, from before the change of
/// the equipment and since.
std::vector<storage::Time> earlier_blocks(const League& league, const std::vector<int>& regimes,
                                          const Member& member, storage::Time changed);

/// Errors of the member and of the champion over the regimes in which both ran, each with its share
/// of the time [MRSE in percent]; 0 where there are none. Where they are `bounded`, on no block is
/// one larger than the outputs are in the member's window: one in which no model is of use, such as
/// a fault's, decides for its time alone. Requires a champion.
std::pair<double, double> served_errors(const League& league,
                                        const std::map<int, ServedRegime>& served,
                                        const Member& member, bool bounded);

}  // namespace reident
