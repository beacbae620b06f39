// The last change of the equipment, in the champion's record: its errors have grown for good.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "identification/statistics/error_growth.hpp"
#include "service/judgement/scores.hpp"
#include "service/windows/block_reader.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident {

struct Change {
  storage::Time since = 0;           // begin of the first block that it may lie in
  storage::Time found = 0;           // end of the block with which it was found
  storage::Time before = INT64_MIN;  // `since` of the change before it
};

/// Finds growth of a run's errors in one of the operating regimes: another regime may be harder for
/// a model, and is no change of the equipment, unless the model fails there beside a constant at
/// the outputs' mean so far. In another mode of operation it may even fail: a mode is what inputs
/// say that the configuration names for this. A block whose outputs are as small as their sensors'
/// noise says nothing.
class ChangeFinder {
 public:
  /// Takes in the next block that counts, which is of `regime` and of `mode`. Behind a change the
  /// errors are judged anew.
  void add(const storage::Block& block, const storage::BlockScore& score, int regime, int mode);
  const std::optional<Change>& last() const { return last_; }

 private:
  struct Errors {
    identification::ErrorGrowth growth{blocks_of_cycle};
    std::vector<storage::Time> begins{};  // of the blocks since they were calm

    /// Begin of the growth that is found with the block, if any is.
    std::optional<storage::Time> add(const storage::Block& block, const storage::BlockScore& score);
  };
  struct AllErrors {
    Errors errors;
    std::optional<storage::Time> since;  // begin of their growth, once it is found
    Sums sums;  // since they were calm, or since the model was last found of use
  };
  void begin_anew(storage::Time since, storage::Time found);

  std::map<int, Errors> regimes_;
  std::map<int, AllErrors> modes_;  // each of whichever regime
  Sums so_far_;                     // since the last change
  std::optional<Change> last_;
};

}  // namespace reident
