// The last change of the equipment, in the champion's record: its errors have grown for good.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "identification/statistics/change_detection.hpp"
#include "service/windows/block_reader.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident {

struct Change {
  storage::Time since = 0;  // begin of the first block that it may lie in
  storage::Time found = 0;  // end of the block with which it was found
};

/// Finds growth of the logarithms of a run's errors, each beside those of its phase of the cycle.
class ChangeFinder {
 public:
  /// Takes in the next block that counts. Errors are measured against those of the first cycles,
  /// and behind a change against those of the first cycles behind it.
  void add(const storage::Block& block, const storage::BlockScore& score);
  const std::optional<Change>& last() const { return last_; }

 private:
  struct Entry {
    std::size_t phase;
    double log_error;
  };
  void measure_reference();
  double scaled(const Entry& entry) const;

  std::vector<Entry> reference_;
  std::array<double, blocks_of_cycle> means_{};  // by phase
  double scale_ = 1;
  std::optional<identification::ChangeDetector> detector_;
  std::optional<storage::Time> calm_until_;
  std::optional<Change> last_;
};

}  // namespace reident
