// Which delays of the inputs the rows show (METHOD.md, section 6, "Delays"). Private to this
// folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/search/identify.hpp"

namespace reident::identification {

/// A pole below may stand in place of a row of delay.
inline constexpr double pole_near_zero = 0.2;

/// Returns the delays with that of one input longer by a row, for each input, and of all.
std::vector<std::vector<int>> longer_by_a_row(const std::vector<int>& delays);

/// How far delays are looked for, in rows: up to `most`, and on to `limit` as long as the rows show
/// one at the end of what has been looked at.
struct DelayRange {
  int most;
  int limit;
};

/// Returns delays in rows, one for each input, in the range and at most a third of the longest
/// run of segments (longest_run(), delays.hpp): those of the simplest model that nothing refutes,
/// of the model `without` delays, where there is one, and of models of few states with delays and
/// without. All are zero where it has none. Spends a sixth of the search budget for each of its two
/// steps.
std::vector<int> delays_shown(const Record& record, RowRange rows, DelayRange range,
                              const Identified* without, const IdentifyOptions& options);

/// Whether a model with delays stands beside one without, on the rows held out that both have: that
/// of fewer states, a delay counted as one, unless it errs more (errs_more(), parsimony.hpp).
/// Spends no more than another sixth of the budget.
bool held_out_rows_agree(const Identified& with, const Identified& without, const Record& record,
                         RowRange rows, const IdentifyOptions& options);

}  // namespace reident::identification
